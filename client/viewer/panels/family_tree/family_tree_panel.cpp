#include "client/viewer/panels/family_tree/family_tree_panel.h"

#include "client/viewer/drawing/widgets.h"
#include "client/viewer/text/numbers.h"

#include <imgui.h>
#include <imgui_internal.h> // SetItemUsingMouseWheel

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

namespace evod::viewer {

namespace {

constexpr double tree_zoom_of_one_notch = 1.25;
constexpr double visible_x_min = 4, visible_generations_min = 4; // least visible part
constexpr std::size_t named_organisms_max = 200;                 // organisms that scripts can find by name

constexpr std::array<const char*, 3> kind_names{"lines of first parents", "both parents",
                                                "ancestors of the selected organism"};
constexpr std::array<const char*, 5> origin_texts{"in the first generation", "elite: an unchanged copy",
                                                  "survivor: lives on", "child", "placed by a user"};

std::string count_of(std::size_t count, const char* noun) {
    return with_separators(count) + " " + noun + (count == 1 ? "" : "s");
}

/// The selected organism, or the one selected last, if the lineage contains it.
std::optional<RunOrganism> selected_in(const Panel::Context& context) {
    const OrganismHistory* history = context.island_view.organism_history();
    if (history == nullptr) {
        return std::nullopt;
    }
    const std::uint32_t index =
        context.island_view.lineage().index_of(history->generation(), {context.world.feed.island(), history->id()});
    return index == Lineage::none ? std::nullopt : std::optional{RunOrganism{history->generation(), index}};
}

std::string name_of(const Lineage& lineage, const RunOrganism& organism) {
    const Lineage::Place place = lineage.place_of(organism.generation, organism.index);
    return "organism " + std::to_string(place.organism) +
           (lineage.at(organism.generation).begins.size() > 1 ? " of island " + std::to_string(place.island) : "");
}

std::optional<std::uint64_t> replayed_generation(const ViewedWorld& world) {
    const codec::ReceivedSnapshot* snapshot = world.feed.snapshot();
    return world.replay.info() == nullptr || snapshot == nullptr ? std::nullopt
                                                                 : std::optional{snapshot->about.generation()};
}

} // namespace

void FamilyTreePanel::build(Context& context) {
    context.island_view.want_lineage();
    build_choices(context);
    const std::string& problem = context.island_view.lineage_problem();
    if (!problem.empty()) {
        widgets::small_text(problem + ".", palette::warning);
    }
    update_tree(context);
    if (tree_.empty()) {
        const bool none_selected = kind_ == Kind::OfSelected && !selected_;
        widgets::small_text(none_selected     ? "Click an organism to select it."
                            : problem.empty() ? "…"
                                              : "",
                            palette::text);
        return;
    }
    widgets::small_text(sentence(context), palette::text);
    build_drawing(context);
}

void FamilyTreePanel::build_choices(Context& context) {
    const auto chosen = static_cast<std::size_t>(kind_);
    ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x - 4.5f * ImGui::GetFontSize());
    if (widgets::begin_drop_down("##tree", kind_names[chosen], "tree")) {
        for (std::size_t i = 0; i < kind_names.size(); ++i) {
            if (widgets::choice("tree", kind_names[i], i == chosen)) {
                kind_ = Kind(i);
                x_.reset();
                generations_.reset();
            }
        }
        ImGui::EndCombo();
    }
    ImGui::SameLine();
    if (widgets::button("Fit")) {
        x_.reset();
        generations_.reset();
    }
    bool coloured = context.island_view.options.colour_by == ColourBy::Lineage;
    if (widgets::checkbox("colour the island by lineage, too", coloured)) {
        context.island_view.options.colour_by = coloured ? ColourBy::Lineage : ColourBy::Nothing;
    }
}

void FamilyTreePanel::update_tree(Context& context) {
    const IslandView& island_view = context.island_view;
    const Lineage& lineage = island_view.lineage();
    if (!island_view.lineage_is_current()) {
        tree_ = {};
        source_ = {};
        return;
    }
    selected_ = selected_in(context);
    const Source source{context.world.feed.place_number(), lineage.version(), kind_,
                        kind_ == Kind::OfSelected ? selected_ : std::nullopt};
    const bool same_subject = source.kind == source_.kind && source.root == source_.root && !tree_.empty();
    if (source != source_ && (!same_subject || source.place != source_.place || context.now >= next_build_)) {
        source_ = source;
        const auto begun = std::chrono::steady_clock::now();
        tree_ = {};
        if (kind_ == Kind::OfSelected && selected_) {
            tree_ = FamilyTree{lineage, selected_->generation, std::array{selected_->index}, FamilyTree::Parents::Both};
        } else if (kind_ != Kind::OfSelected && !lineage.empty()) {
            const auto [begin, count] = lineage.island_range(lineage.last(), context.world.feed.island());
            std::vector<std::uint32_t> roots(count);
            std::iota(roots.begin(), roots.end(), begin);
            tree_ = FamilyTree{lineage, lineage.last(), roots,
                               kind_ == Kind::BothParents ? FamilyTree::Parents::Both : FamilyTree::Parents::First};
        }
        if (!tree_.empty()) {
            colour_tree(context);
        }
        // A large tree of a fast world must not use all the time of the drawing thread.
        next_build_ = context.now + 20 * (std::chrono::steady_clock::now() - begun);
    }
}

/// Colours the tree by the lineages of its last generation.
void FamilyTreePanel::colour_tree(const Context& context) {
    const Lineage& lineage = context.island_view.lineage();
    const std::uint64_t since = context.island_view.lineage_base_of(tree_.last());
    if (since != since_) {
        colours_ = {}; // founders have other numbers
        since_ = since;
    }
    colours_.update(Families{ancestors_of(lineage, tree_.last(), context.world.feed.island(), since)});
    tree_.set_base(since);
}

std::string FamilyTreePanel::sentence(const Context& context) const {
    const Lineage& lineage = context.island_view.lineage();
    const std::string first = with_separators(tree_.first()), last = with_separators(tree_.last());
    const std::string roots = count_of(tree_.row(tree_.last()).size(), "organism") + " of generation " + last;
    std::string text;
    if (kind_ == Kind::OfSelected) {
        std::size_t ancestors = 0;
        for (std::uint64_t generation = tree_.first(); generation < tree_.last(); ++generation) {
            ancestors += tree_.row(generation).size();
        }
        text = print("Organism %u of generation %s has %s since generation %s.",
                     lineage.place_of(tree_.last(), tree_.row(tree_.last())[0].organism).organism, last.c_str(),
                     count_of(ancestors, "ancestor").c_str(), first.c_str());
    } else if (const auto common = tree_.common_generation()) {
        const std::string name = name_of(lineage, {*common, tree_.row(*common)[tree_.common_ancestors()[0]].organism});
        const std::string ago = count_of(tree_.last() - *common, "generation") + " earlier";
        if (kind_ == Kind::FirstParents) {
            text = "The lines of the " + roots + " meet in " + name + " of generation " + with_separators(*common) +
                   ", " + ago + ".";
        } else {
            text = print("The %s have %s in generation %s, %s.", roots.c_str(),
                         tree_.common_ancestors().size() == 1
                             ? "one common ancestor"
                             : count_of(tree_.common_ancestors().size(), "common ancestor").c_str(),
                         with_separators(*common).c_str(), ago.c_str());
            if (const auto all = tree_.all_common_generation()) {
                text += " Up to generation " + with_separators(*all) + " (dashed line), all are ancestors of all.";
            }
        }
    } else {
        text = print("The %s descend from %s of generation %s.", roots.c_str(),
                     count_of(tree_.row(tree_.first()).size(), "organism").c_str(), first.c_str());
        if (const std::size_t placed = tree_.placed_count(); placed > 0) {
            text.back() = ' ';
            text += "and from " + count_of(placed, "organism") + " that a user placed.";
        }
    }
    if (lineage.first() > 1 && tree_.first() == lineage.first()) {
        text += " Generations before " + with_separators(lineage.first()) + " are not loaded.";
    }
    if (selected_ && kind_ != Kind::OfSelected &&
        tree_.place_of(selected_->generation, selected_->index) == FamilyTree::none) {
        text += " The selected organism has no descendants here.";
    }
    return text;
}

std::string FamilyTreePanel::note_of(const Context& context, const RunOrganism& organism) const {
    const Lineage& lineage = context.island_view.lineage();
    const Lineage::Organism& about = lineage.at(organism.generation).organisms[organism.index];
    std::string text = name_of(lineage, organism) + " of generation " + with_separators(organism.generation);
    text[0] = 'O';
    text += std::string{"\n"} + origin_texts[static_cast<std::size_t>(about.origin)];
    text += std::isfinite(about.fitness) ? "\nfitness " + shown_number(static_cast<double>(about.fitness))
                                         : "\nfitness not known yet";
    const auto parent = [&](std::uint32_t index) { return name_of(lineage, {organism.generation - 1, index}); };
    const auto [first, second] = about.parents;
    if (first != Lineage::none && second == first) {
        text += "\nparent: " + parent(first);
    } else if (first != Lineage::none && second != Lineage::none) {
        text += "\nfirst parent: " + parent(first) + "\nsecond parent: " + parent(second);
    }
    const std::uint32_t place = tree_.place_of(organism.generation, organism.index);
    if (tree_.common_generation() == organism.generation &&
        std::ranges::find(tree_.common_ancestors(), place) != tree_.common_ancestors().end()) {
        text += "\ncommon ancestor of all";
    }
    return text + "\nclick: show its birth";
}

void FamilyTreePanel::show_birth(Context& context, const RunOrganism& organism) {
    const Lineage::Place place = context.island_view.lineage().place_of(organism.generation, organism.index);
    context.world.feed.choose_island(place.island);
    context.world.replay.show_birth(organism.generation, place.organism);
}

/// The wheel zooms at the mouse, and dragging moves the visible part.
void FamilyTreePanel::move_view(const TreeDrawing& drawing, const TreeDrawing::View& shown) {
    const ImGuiIO& io = ImGui::GetIO();
    const Range whole_x{0, static_cast<double>(tree_.width())}, whole = whole_generations(tree_);
    const float width = drawing.end().x - drawing.corner().x, height = drawing.end().y - drawing.corner().y;
    if (ImGui::IsItemHovered() && ImGui::IsMouseDoubleClicked(0)) {
        x_.reset();
        generations_.reset();
    } else if (ImGui::IsItemHovered() && io.MouseWheel != 0) {
        const double factor = std::pow(tree_zoom_of_one_notch, io.MouseWheel);
        const double share_x = std::clamp((io.MousePos.x - drawing.corner().x) / width, 0.f, 1.f);
        const double share = std::clamp((io.MousePos.y - drawing.corner().y) / height, 0.f, 1.f);
        x_ = zoomed(shown.x, share_x, factor, whole_x, std::min(visible_x_min, whole_x.width()));
        generations_ = zoomed(shown.generations, share, factor, whole, visible_generations_min);
    } else if (ImGui::IsItemActive() && (io.MouseDelta.x != 0 || io.MouseDelta.y != 0)) {
        x_ = moved(shown.x, -io.MouseDelta.x / width * shown.x.width(), whole_x);
        generations_ = moved(shown.generations, -io.MouseDelta.y / height * shown.generations.width(), whole);
    }
}

void FamilyTreePanel::build_drawing(Context& context) {
    const IslandView& island_view = context.island_view;
    const float pixel = context.gui.scale();
    const Range whole_x{0, static_cast<double>(tree_.width())}, whole = whole_generations(tree_);
    const TreeDrawing::View view{x_ ? zoomed(*x_, 0, 1, whole_x, std::min(visible_x_min, whole_x.width())) : whole_x,
                                 generations_ ? zoomed(*generations_, 0, 1, whole, visible_generations_min)
                                              : fitted_generations(tree_)};
    const TreeDrawing::Subject subject{.tree = tree_,
                                       .lineage = island_view.lineage(),
                                       // The same colours as on the island, if the same lineages are counted.
                                       .colours = since_ == island_view.families_since() ? island_view.family_colours()
                                                                                         : colours_,
                                       .since = since_,
                                       .both_parents = kind_ != Kind::FirstParents,
                                       .selected = selected_,
                                       .replayed = replayed_generation(context.world)};
    const float legend = 2 * (ImGui::GetFontSize() + 6 * pixel);
    const ImVec2 corner = ImGui::GetCursorScreenPos(), room = ImGui::GetContentRegionAvail();
    const ImVec2 size{std::max(room.x, 80 * pixel), std::max(room.y - legend, 160 * pixel)};
    ImGui::InvisibleButton("##drawing", size);
    widgets::mark("tree of generation " + std::to_string(tree_.last()));
    ImGui::SetItemUsingMouseWheel(); // prevents the window from scrolling
    TreeDrawing drawing{*ImGui::GetWindowDrawList(),
                        context.gui.label(),
                        pixel,
                        corner,
                        {corner.x + size.x, corner.y + size.y},
                        subject,
                        view};
    drawing.draw();
    WidgetPositions& positions = context.gui.widget_positions();
    const auto name = [&](const std::string& text, ImVec2 point) {
        if (drawing.shows(point)) {
            positions.add({.name = text, .place = {point.x, point.y, 0, 0}});
        }
    };
    if (tree_.common_generation()) {
        name("common ancestor", drawing.point(*tree_.common_generation(), tree_.common_ancestors()[0]));
    }
    const FamilyTree::Row& roots = tree_.row(tree_.last());
    for (std::uint32_t place = 0; place < std::min(roots.size(), named_organisms_max); ++place) {
        const auto id = island_view.lineage().place_of(tree_.last(), roots[place].organism).organism;
        name("organism " + std::to_string(id), drawing.point(tree_.last(), place));
    }
    const ImVec2 mouse = ImGui::GetIO().MousePos;
    const ImVec2 dragged = ImGui::GetMouseDragDelta(0, 0);
    const bool clicked = ImGui::IsItemDeactivated() && std::hypot(dragged.x, dragged.y) < 4 * pixel;
    const auto pointed_at = ImGui::IsItemHovered() ? drawing.at(mouse) : std::nullopt;
    if (pointed_at) {
        drawing.draw_pointed_at(*pointed_at);
        ImGui::SetMouseCursor(ImGuiMouseCursor_Hand);
        if (!ImGui::IsItemActive()) {
            widgets::note(note_of(context, *pointed_at));
        }
    }
    move_view(drawing, view);
    build_legend(context, drawing.second_parents_left_out());
    if (pointed_at && clicked) {
        show_birth(context, *pointed_at);
    }
}

void FamilyTreePanel::build_legend(const Context& context, bool second_parents_left_out) {
    ImDrawList& list = *ImGui::GetWindowDrawList();
    ImFont& font = context.gui.label();
    const float pixel = context.gui.scale(), letter = font.FontSize, icon = 16 * pixel;
    const ImVec2 begin = ImGui::GetCursorScreenPos();
    const float right = begin.x + ImGui::GetContentRegionAvail().x;
    ImVec2 at = begin;
    const auto entry = [&](const std::string& text, auto&& draw) {
        const float width = icon + 5 * pixel + size_of(text, font).x + 12 * pixel;
        if (at.x > begin.x && at.x + width > right) {
            at = {begin.x, at.y + letter + 4 * pixel};
        }
        draw(ImVec2{at.x, at.y + std::round(letter / 2)});
        write(list, font, {at.x + icon + 5 * pixel, at.y}, palette::text, text);
        at.x += width;
    };
    const auto line = [&](Colour colour, float thickness) {
        return [&list, icon, colour, thickness](ImVec2 from) {
            list.AddLine(from, {from.x + icon, from.y}, ink(colour), thickness);
        };
    };
    const std::string lineages = "lineages since generation " + with_separators(since_);
    context.gui.widget_positions().add({.name = lineages, .place = {begin.x, begin.y, 0, 0}});
    entry(lineages, [&](ImVec2 from) {
        for (std::size_t i = 0; i < 4; ++i) {
            const float x = from.x + static_cast<float>(i) * icon / 4;
            list.AddRectFilled({x, from.y - 4 * pixel}, {x + icon / 4, from.y + 4 * pixel},
                               ink(on_paper(palette::lineages[i])));
        }
    });
    if (tree_.common_generation()) {
        entry("common ancestor", [&](ImVec2 from) {
            list.AddCircle({from.x + icon / 2, from.y}, 5 * pixel, ink(palette::text), 0, 2 * pixel);
            list.AddCircleFilled({from.x + icon / 2, from.y}, 2 * pixel, ink(palette::text));
        });
    }
    if (context.world.feed.island_count() > 1) {
        entry("parent on another island", [&](ImVec2 from) {
            draw_migrant_mark(list, {from.x + icon / 2, from.y}, pixel);
        });
    }
    if (selected_) {
        entry("selected", line(palette::selected_line, 3 * pixel));
    }
    if (kind_ != Kind::FirstParents) {
        entry(second_parents_left_out ? "second parents: zoom in" : "second parent",
              line(faint(palette::series_grey, 140), pixel));
    }
    ImGui::Dummy({right - begin.x, at.y + letter + 4 * pixel - begin.y});
}

} // namespace evod::viewer
