#include "client/viewer/panels/organism_panel.h"

#include "client/viewer/drawing/ink.h"
#include "client/viewer/drawing/widgets.h"
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

std::string shown_fate(const SelectedOrganism& organism) {
    if (!organism.info()) {
        return "";
    }
    const evod::v1::OrganismInfo& info = *organism.info();
    if (!info.alive()) {
        if (info.cause_of_death() == evod::v1::CAUSE_OF_DEATH_REMOVED) {
            return print("removed by a user after %.1f s", info.lived_s());
        }
        if (info.cause_of_death() == evod::v1::CAUSE_OF_DEATH_EATEN) {
            return print("eaten by a predator after %.1f s", info.lived_s());
        }
        return print("died of %s after %.1f s",
                     info.cause_of_death() == evod::v1::CAUSE_OF_DEATH_POISONED ? "poison"
                     : info.cause_of_death() == evod::v1::CAUSE_OF_DEATH_OLD    ? "old age"
                                                                                : "hunger",
                     info.lived_s());
    }
    return organism.ended() ? print("alive when last seen after %.1f s; its generation has ended", info.lived_s())
                            : print("alive for %.1f s, health %.1f", info.lived_s(), info.health());
}

std::string shown_choice(const evod::v1::OrganismInfo& info) {
    const std::string place = print(" at (%.0f, %.0f)", info.target_x_px(), info.target_y_px());
    switch (info.choice()) {
    case evod::v1::CHOICE_WANDER:
        return "about to wander";
    case evod::v1::CHOICE_SEEK:
        return (info.species() == evod::v1::SPECIES_PREDATOR ? "about to hunt prey" : "about to seek food") + place;
    case evod::v1::CHOICE_FLEE:
        return (info.flees_predator() ? "about to flee from the predator" : "about to flee from poison") + place;
    case evod::v1::CHOICE_STEER:
        return "steered by its network";
    default:
        return "";
    }
}

void OrganismPanel::build(Context& context) {
    const SelectedOrganism* organism = context.island_data.selected_organism();
    if (organism == nullptr) {
        build_choice(context);
        return;
    }
    ImGui::Text("Organism %u of generation %s", organism->id(), with_separators(organism->generation()).c_str());
    if (context.world.replay.is_own()) {
        if (widgets::button("Back to live")) {
            context.world.replay.return_to_present();
            return;
        }
        widgets::explain("Returns to the live world (P).");
    }
    if (!organism->info()) {
        ImGui::TextDisabled("…");
        return;
    }
    build_life(context, *organism);
    ImGui::Separator();
    build_genes(context, *organism);
}

/// Builds the panel while no organism is selected.
void OrganismPanel::build_choice(Context& context) {
    widgets::small_text("Click an organism to inspect it: its health and its genes.", palette::text);
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

void OrganismPanel::build_life(Context& context, const SelectedOrganism& organism) {
    const evod::v1::OrganismInfo& info = *organism.info();
    widgets::small_text(shown_fate(organism), palette::text);
    if (!organism.dead() && !organism.ended()) {
        widgets::small_text(shown_choice(info), palette::text);
        bool following = context.island_data.followed().has_value();
        if (widgets::checkbox("keep it centred (L)", following)) {
            context.island_data.toggle_following(context.world.feed);
        }
    }
    if (info.species() == evod::v1::SPECIES_PREDATOR) {
        ImGui::Text("a predator; eaten: %u prey", info.food_eaten());
    } else {
        ImGui::Text("eaten: %u food, %u poison", info.food_eaten(), info.poison_eaten());
    }
    if (info.has_number()) {
        ImGui::Text("number %u, age %.1f s, children: %u", info.number(), info.age_s(), info.children());
    }
    ImGui::Text("radius %.1f px, mass %.2f kg", info.radius_px(), info.mass_kg());
}

void OrganismPanel::build_genes(Context& context, const SelectedOrganism& organism) {
    const evod::v1::OrganismInfo& info = *organism.info();
    const auto& names = context.island_view.gene_names();
    const GeneRange weights = genes_of(context.world.feed.gene_groups(), evod::v1::GENE_GROUP_BRAIN);
    for (std::size_t gene = 0; gene < names.size() && gene < static_cast<std::size_t>(info.genes_size()); ++gene) {
        if (weights.contains(gene)) {
            continue; // they are too many
        }
        const float value = info.genes(static_cast<int>(gene));
        if (gene < organism.ranges().size()) {
            build_gene(names[gene], value, organism.ranges()[gene], context.gui.scale());
        } else {
            ImGui::Text("%s %.1f", names[gene].c_str(), double{value});
        }
    }
    if (organism.ranges().empty() && !context.island_view.problem().empty()) {
        widgets::small_text(context.island_view.problem() + ".", palette::text);
    }
}

} // namespace evod::viewer
