#include "client/viewer/panels/organism_panel.h"

#include "client/viewer/drawing/ink.h"
#include "client/viewer/drawing/widgets.h"
#include "client/viewer/panels/brain_diagram.h"
#include "client/viewer/world/freezer.h"
#include "client/viewer/world/status_text.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <span>
#include <vector>

namespace evod::viewer {

namespace {

/// Draws a gene as a bar whose ends are the least and the greatest value in the generation. A line across the bar marks
/// the mean.
void build_gene(const std::string& name, float value, const Population::Range& range, float pixel) {
    const float height = 12 * pixel;
    ImGui::TextUnformatted(name.c_str());
    const std::string text = print("%.1f", double{value});
    ImGui::SameLine(ImGui::GetContentRegionAvail().x - ImGui::CalcTextSize(text.c_str()).x);
    ImGui::TextUnformatted(text.c_str());
    const float width = ImGui::GetContentRegionAvail().x;
    const ImVec2 corner = ImGui::GetCursorScreenPos();
    const auto across = [&](float of) {
        const float share = range.max > range.min ? (of - range.min) / (range.max - range.min) : 0.5f;
        return corner.x + std::clamp(share, 0.f, 1.f) * width;
    };
    ImDrawList& list = *ImGui::GetWindowDrawList();
    list.AddRectFilled(corner, {corner.x + width, corner.y + height}, ink(palette::background));
    list.AddRectFilled(corner, {across(value), corner.y + height}, ink(palette::organism));
    list.AddLine({across(range.mean), corner.y - 2 * pixel}, {across(range.mean), corner.y + height + 2 * pixel},
                 ink(palette::wall), 2 * pixel);
    ImGui::Dummy({width, height});
    widgets::explain(print("Range in this generation: %.1f to %.1f, mean %.1f", double{range.min}, double{range.max},
                           double{range.mean}));
}

} // namespace

std::string shown_parents(const evod::v1::OrganismInfo& info, OrganismHistory::Origin origin) {
    if (info.has_placed_tick()) {
        return "No parents: placed by a user after tick " + with_separators(info.placed_tick()) + " of the generation";
    }
    if (info.parents().empty()) {
        return "No parents: founder of generation 1, or loaded from a file";
    }
    const std::string generation = with_separators(info.generation() - 1);
    if (info.parents_size() == 1 || info.parents(0) == info.parents(1)) {
        const char* why = origin == OrganismHistory::Origin::Elite      ? ": this organism belongs to the elite"
                          : origin == OrganismHistory::Origin::Survivor ? ": this organism is a survivor"
                          : origin == OrganismHistory::Origin::Child    ? ", which was both parents"
                                                                        : "";
        return print("One parent: %u (generation %s)%s", info.parents(0), generation.c_str(), why);
    }
    return print("Parents: %u and %u (generation %s)", info.parents(0), info.parents(1), generation.c_str());
}

std::string shown_fate(const OrganismHistory& history) {
    if (!history.info()) {
        return "";
    }
    const evod::v1::OrganismInfo& info = *history.info();
    if (!info.alive()) {
        if (info.cause_of_death() == evod::v1::CAUSE_OF_DEATH_REMOVED) {
            return print("removed by a user after %.1f s", info.lived_s());
        }
        return print("died of %s after %.1f s",
                     info.cause_of_death() == evod::v1::CAUSE_OF_DEATH_POISONED ? "poison" : "hunger", info.lived_s());
    }
    return history.ended() ? print("alive when last seen after %.1f s; its generation has ended", info.lived_s())
                           : print("alive for %.1f s, health %.1f", info.lived_s(), info.health());
}

std::string shown_choice(const evod::v1::OrganismInfo& info) {
    const std::string place = print(" at (%.0f, %.0f)", info.target_x_px(), info.target_y_px());
    switch (info.choice()) {
    case evod::v1::CHOICE_WANDER:
        return "about to wander";
    case evod::v1::CHOICE_SEEK:
        return "about to seek food" + place;
    case evod::v1::CHOICE_FLEE:
        return "about to flee from poison" + place;
    case evod::v1::CHOICE_STEER:
        return "steered by its network";
    default:
        return "";
    }
}

std::string shown_children(const std::vector<OrganismHistory::Child>& children) {
    constexpr std::size_t shown_max = 40;
    std::string text;
    for (std::size_t i = 0; i < std::min(children.size(), shown_max); ++i) {
        const OrganismHistory::Child& child = children[i];
        text += (i == 0 ? "" : ", ") + std::to_string(child.id) +
                (child.other_parent ? " (with " + std::to_string(*child.other_parent) + ")"
                 : child.same_genes ? " (unchanged)"
                                    : " (single parent)");
    }
    if (children.size() > shown_max) {
        text += " and " + with_separators(children.size() - shown_max) + " more";
    }
    return text.empty() ? "none" : text;
}

void OrganismPanel::build_freeze(Context& context, const OrganismHistory& history) {
    if (widgets::button("Freeze")) {
        const std::string name = context.world.feed.name() + "-g" + std::to_string(history.generation()) + "-o" +
                                 std::to_string(history.id());
        const auto& genes = history.info()->genes();
        const auto saved =
            context.freezer->save(name, {context.world.feed.gene_names(), {{genes.begin(), genes.end()}}});
        context.world.server.notice(saved ? "Stored the organism in the freezer as " + *saved : saved.error().what);
    }
    widgets::explain("Stores the organism's genes in the panel Freezer (F10), to place it in any world later.");
}

void OrganismPanel::build(Context& context) {
    const OrganismHistory* history = context.island_view.organism_history();
    if (history == nullptr) {
        build_choice(context);
        return;
    }
    ImGui::Text("Organism %u of generation %s", history->id(), with_separators(history->generation()).c_str());
    if (context.world.replay.is_own()) {
        if (widgets::button("Back to live")) {
            context.world.replay.return_to_present();
            return;
        }
        widgets::explain("Returns to the live world (P).");
    }
    if (!history->info()) {
        ImGui::TextDisabled("…");
        return;
    }
    build_life(context, *history);
    ImGui::Separator();
    build_parents(context, *history);
    ImGui::Separator();
    build_genes(context, *history);
    ImGui::Separator();
    build_offspring(*history);
}

/// Builds the panel while no organism is selected.
void OrganismPanel::build_choice(Context& context) {
    widgets::small_text("Click an organism to inspect it: its genes, its parents and its offspring.", palette::text);
    const codec::ReceivedSnapshot* snapshot = context.world.feed.snapshot();
    if (snapshot == nullptr || snapshot->entities->organisms.id.empty()) {
        return;
    }
    const codec::Entities& organisms = snapshot->entities->organisms;
    ImGui::Separator();
    widgets::small_text("The healthiest organisms now:", palette::text);
    WorldFeed& feed = context.world.feed;
    for (const std::size_t index : feed.healthiest(feed.island(), HealthRanking::ranked_count)) {
        const std::string label = "Organism " + std::to_string(organisms.id[index]) + ", health " +
                                  three_digits(double{organisms.health(index)});
        if (ImGui::Button((label + "###" + std::to_string(organisms.id[index])).c_str(),
                          {-1, 26 * context.gui.scale()})) {
            context.world.feed.select(organisms.id[index]);
        }
        widgets::mark("Organism " + std::to_string(organisms.id[index]));
    }
}

/// Builds the network of an organism. Returns false if it has none.
bool OrganismPanel::build_brain_of(const Context& context, const evod::v1::OrganismInfo& info) {
    const GeneRange weights = genes_of(context.island_view.gene_groups(), evod::v1::GENE_GROUP_BRAIN);
    const std::span genes{info.genes().data(), static_cast<std::size_t>(info.genes_size())};
    if (!info.has_brain() || weights.first + weights.count > genes.size()) {
        return false;
    }
    build_brain(info.brain(), genes.subspan(weights.first, weights.count), context.gui);
    return true;
}

void OrganismPanel::build_life(Context& context, const OrganismHistory& history) {
    const evod::v1::OrganismInfo& info = *history.info();
    widgets::small_text(shown_fate(history), palette::text);
    if (!history.dead() && !history.ended()) {
        if (!build_brain_of(context, info)) {
            widgets::small_text(shown_choice(info), palette::text);
        }
        bool following = context.island_view.following();
        if (widgets::checkbox("keep it centred (L)", following)) {
            context.island_view.toggle_following(context.world);
        }
    }
    build_freeze(context, history);
    ImGui::Text("eaten: %u food, %u poison", info.food_eaten(), info.poison_eaten());
    ImGui::Text("radius %.1f px, mass %.2f kg", info.radius_px(), info.mass_kg());
}

void OrganismPanel::build_parents(Context& context, const OrganismHistory& history) {
    const evod::v1::OrganismInfo& info = *history.info();
    std::vector<std::uint32_t> parents(info.parents().begin(), info.parents().end());
    if (parents.size() == 2 && parents[0] == parents[1]) {
        parents.pop_back();
    }
    for (const std::uint32_t parent : parents) {
        build_parent(context, history, parent);
    }
    widgets::small_text(shown_parents(info, history.origin()), palette::text);
}

void OrganismPanel::build_parent(Context& context, const OrganismHistory& history, std::uint32_t parent) {
    const evod::v1::OrganismInfo& info = *history.info();
    const OrganismHistory::Parent* known = history.parent(parent);
    // Only the breeding contains whether the parent is a copy of an organism of another island.
    ImGui::BeginDisabled(known == nullptr && context.island_view.awaits_parents());
    if (widgets::button(("Go to parent " + std::to_string(parent)).c_str())) {
        OrganismPlace place{info.island(), history.generation() - 1, parent};
        if (known != nullptr && known->migrant) {
            place.island = known->migrant->island();
            place.id = known->migrant->organism();
        }
        context.island_view.go_to(context.world, place);
    }
    ImGui::EndDisabled();
    widgets::explain("Shows the parent alive, in a replay of its generation. P returns to the live world.");
}

void OrganismPanel::build_genes(Context& context, const OrganismHistory& history) {
    const evod::v1::OrganismInfo& info = *history.info();
    const auto& names = context.island_view.gene_names();
    const GeneRange weights = genes_of(context.island_view.gene_groups(), evod::v1::GENE_GROUP_BRAIN);
    for (std::size_t gene = 0; gene < names.size() && gene < static_cast<std::size_t>(info.genes_size()); ++gene) {
        if (weights.contains(gene)) {
            continue; // the diagram of the network shows them
        }
        const float value = info.genes(static_cast<int>(gene));
        if (gene < history.ranges().size()) {
            build_gene(names[gene], value, history.ranges()[gene], context.gui.scale());
        } else {
            ImGui::Text("%s %.1f", names[gene].c_str(), double{value});
        }
    }
    if (history.ranges().empty() && !context.island_view.problem().empty()) {
        widgets::small_text(context.island_view.problem() + ".", palette::text);
    }
}

void OrganismPanel::build_offspring(const OrganismHistory& history) {
    if (history.children()) {
        widgets::small_text(print("Offspring in generation %s: %s", with_separators(history.generation() + 1).c_str(),
                                  shown_children(*history.children()).c_str()),
                            palette::text);
    } else if (!history.ended()) {
        ImGui::TextDisabled("Offspring appear when the next generation starts");
    } else if (!history.waits_for_children()) {
        ImGui::TextDisabled("Offspring unknown: the world ran too fast to be observed");
    }
}

} // namespace evod::viewer
