#include "client/viewer/panels/family_tree/tree_drawing.h"

#include "client/viewer/text/numbers.h"

#include <algorithm>
#include <cmath>

namespace evod::viewer {

namespace {

constexpr Colour trunk = palette::series_grey; // of organisms before the generation from which lineages are counted
constexpr Colour second_parent_line = faint(palette::series_grey, 90);

} // namespace

Colour on_paper(Colour colour) {
    constexpr double lightness_max = 190, share = 0.78;
    const double lightness = 0.299 * colour.red + 0.587 * colour.green + 0.114 * colour.blue;
    const auto darker = [](std::uint8_t part) { return static_cast<std::uint8_t>(part * share); };
    return lightness > lightness_max ? Colour{darker(colour.red), darker(colour.green), darker(colour.blue)} : colour;
}

void draw_migrant_mark(ImDrawList& list, ImVec2 at, float pixel) {
    const float half = 4.5f * pixel;
    const ImVec2 top{at.x, at.y - half}, right{at.x + half, at.y}, bottom{at.x, at.y + half}, left{at.x - half, at.y};
    list.AddQuadFilled(top, right, bottom, left, ink(palette::plot_background));
    list.AddQuad(top, right, bottom, left, ink(palette::text), 1.5f * pixel);
}

TreeDrawing::TreeDrawing(ImDrawList& list, ImFont& font, float pixel, ImVec2 corner, ImVec2 end, const Subject& subject,
                         const View& view)
    : list_{list}, font_{font}, pixel_{pixel}, corner_{corner}, end_{end}, subject_{subject}, view_{view} {
    const std::string widest = with_separators(subject.tree.last());
    corner_.x += size_of(widest, font).x + 8 * pixel;
}

float TreeDrawing::column(double x) const {
    return corner_.x + static_cast<float>((x - view_.x.min) / view_.x.width()) * (end_.x - corner_.x);
}

float TreeDrawing::row(double generation) const {
    return corner_.y +
           static_cast<float>((generation - view_.generations.min) / view_.generations.width()) * (end_.y - corner_.y);
}

ImVec2 TreeDrawing::point(std::uint64_t generation, std::uint32_t place) const {
    return {column(subject_.tree.row(generation)[place].x), row(static_cast<double>(generation))};
}

bool TreeDrawing::shows(ImVec2 point) const {
    return point.x >= corner_.x && point.x <= end_.x && point.y >= corner_.y && point.y <= end_.y;
}

Colour TreeDrawing::colour_of(std::uint64_t generation, std::uint32_t place) const {
    const std::uint32_t founder = subject_.tree.row(generation)[place].founder;
    return founder == FamilyTree::none ? trunk : on_paper(subject_.colours.of_founder(founder));
}

void TreeDrawing::draw() {
    list_.AddRectFilled(corner_, end_, ink(palette::plot_background));
    draw_generations();
    list_.PushClipRect(corner_, end_, true);
    if (subject_.both_parents) {
        draw_pedigree();
    } else {
        draw_lines();
    }
    if (subject_.lineage.at(subject_.tree.last()).begins.size() > 1) {
        draw_migrants();
    }
    draw_selected();
    draw_marks();
    list_.PopClipRect();
    list_.AddRect(corner_, end_, ink(palette::strip_edge));
}

void TreeDrawing::draw_generations() {
    const float height = end_.y - corner_.y;
    const Ticks ticks = ticks_in(view_.generations, std::max(2, static_cast<int>(height / (2.2f * font_.FontSize))), 1);
    for (const double tick : ticks.at) {
        if (tick < 1) {
            continue;
        }
        const float y = std::round(row(tick));
        list_.AddLine({corner_.x, y}, {end_.x, y}, ink(palette::plot_grid));
        const float top = std::clamp(y - font_.FontSize / 2, corner_.y, end_.y - font_.FontSize);
        write_to_the_left(list_, font_, {corner_.x - 4 * pixel_, top}, palette::text_quiet,
                          tick_label(tick, ticks.step));
    }
    if (subject_.replayed) {
        const float y = std::round(row(static_cast<double>(*subject_.replayed)));
        if (y >= corner_.y && y <= end_.y) {
            list_.AddLine({corner_.x, y}, {end_.x, y}, ink(palette::replay), 2 * pixel_);
            write(list_, font_, {corner_.x + 4 * pixel_, y - font_.FontSize - 2 * pixel_}, palette::stopped,
                  "shown by the replay");
        }
    }
}

/// Draws a line from a parent to a child: across, then down.
void TreeDrawing::draw_line_to(ImVec2 parent, ImVec2 child, Colour colour, float thickness) {
    const ImVec2 turn{std::round(child.x), std::round(parent.y)};
    if (std::abs(parent.x - turn.x) >= 1) {
        list_.AddLine({std::round(parent.x), turn.y}, turn, ink(colour), thickness);
    }
    list_.AddLine(turn, {turn.x, std::round(child.y)}, ink(colour), thickness);
}

void TreeDrawing::draw_lines() {
    const FamilyTree& tree = subject_.tree;
    const float thickness = 1.6f * pixel_;
    const auto begin = std::ranges::lower_bound(tree.lines(), view_.generations.min, {},
                                                [](const auto& line) { return static_cast<double>(line.bottom); });
    std::size_t drawn = 0;
    ImVec2 last{-1, -1};
    for (auto line = begin; line != tree.lines().end() && drawn < lines_max; ++line) {
        if (static_cast<double>(line->top) > view_.generations.max) {
            continue;
        }
        const ImVec2 from = point(line->top, line->from), to = point(line->bottom, line->to);
        const float left = std::min(from.x, to.x), right = std::max(from.x, to.x);
        const ImVec2 pixels{std::floor(to.x), std::floor(from.y) + 10'000 * std::floor(to.y)};
        if (right < corner_.x || left > end_.x || (pixels.x == last.x && pixels.y == last.y)) {
            continue; // outside the view, or at the pixels of the line before it
        }
        last = pixels;
        ++drawn;
        const Colour colour = colour_of(line->bottom, line->to);
        // Before the generation from which lineages are counted, an organism has no founder.
        const bool splits = colour != trunk && line->top < subject_.since;
        const float split = splits ? row(static_cast<double>(subject_.since)) : from.y;
        if (splits) {
            draw_line_to(from, {to.x, split}, trunk, thickness);
            draw_line_to({to.x, split}, to, colour, thickness);
        } else {
            draw_line_to(from, to, colour, thickness);
        }
    }
    const bool roomy = (end_.x - corner_.x) / view_.x.width() > 5 * pixel_;
    for (auto line = begin; line != tree.lines().end() && roomy; ++line) {
        const ImVec2 to = point(line->bottom, line->to);
        if (shows(to)) {
            const bool branches = line->bottom < tree.last();
            list_.AddCircleFilled(to, (branches ? 2.6f : 2.2f) * pixel_,
                                  ink(branches ? palette::text : colour_of(line->bottom, line->to)));
        }
    }
}

void TreeDrawing::draw_pedigree() {
    const FamilyTree& tree = subject_.tree;
    const auto generation_at = [&](double at) {
        return static_cast<std::uint64_t>(
            std::clamp(at, static_cast<double>(tree.first()), static_cast<double>(tree.last())));
    };
    const std::uint64_t begin = generation_at(std::floor(view_.generations.min));
    const std::uint64_t end = generation_at(std::ceil(view_.generations.max));
    std::size_t visible = 0;
    for (std::uint64_t generation = begin; generation <= end; ++generation) {
        visible += tree.row(generation).size();
    }
    second_left_out_ = 2 * visible > lines_max;
    const std::uint64_t stride = (visible + lines_max - 1) / lines_max;
    const auto in_view = [&](ImVec2 a, ImVec2 b) {
        return std::max(a.x, b.x) >= corner_.x && std::min(a.x, b.x) <= end_.x;
    };
    for (std::uint64_t generation = std::max(begin, tree.first() + 1); generation <= end && !second_left_out_;
         ++generation) {
        for (std::uint32_t place = 0; place < tree.row(generation).size(); ++place) {
            if (const std::uint32_t second = tree.row(generation)[place].second; second != FamilyTree::none) {
                const ImVec2 from = point(generation - 1, second), to = point(generation, place);
                if (in_view(from, to)) {
                    list_.AddLine(from, to, ink(second_parent_line), pixel_);
                }
            }
        }
    }
    const std::uint64_t row_step = std::max<std::uint64_t>(stride, 1);
    for (std::uint64_t generation = end; generation > begin && generation > tree.first();
         generation -= std::min(row_step, generation)) {
        for (std::uint32_t place = 0; place < tree.row(generation).size(); ++place) {
            std::uint64_t top = generation;
            std::uint32_t at = place;
            while (top + row_step > generation && tree.row(top)[at].first != FamilyTree::none) {
                at = tree.row(top--)[at].first;
            }
            const ImVec2 from = point(top, at), to = point(generation, place);
            if (top < generation && in_view(from, to)) {
                list_.AddLine(from, to, ink(colour_of(generation, place)), 1.6f * pixel_);
            }
        }
    }
    const float spacing = std::min((end_.x - corner_.x) / static_cast<float>(view_.x.width()),
                                   (end_.y - corner_.y) / static_cast<float>(view_.generations.width()));
    for (std::uint64_t generation = begin; generation <= end && spacing > 6 * pixel_; ++generation) {
        for (std::uint32_t place = 0; place < tree.row(generation).size(); ++place) {
            if (const ImVec2 at = point(generation, place); shows(at)) {
                list_.AddCircleFilled(at, 2.2f * pixel_, ink(colour_of(generation, place)));
            }
        }
    }
}

void TreeDrawing::draw_selected() {
    if (!subject_.selected) {
        return;
    }
    const FamilyTree& tree = subject_.tree;
    std::optional<ImVec2> child;
    RunOrganism at = *subject_.selected;
    while (subject_.lineage.contains(at.generation) && at.index != Lineage::none) {
        if (const std::uint32_t place = tree.place_of(at.generation, at.index); place != FamilyTree::none) {
            const ImVec2 here = point(at.generation, place);
            if (!child) {
                list_.AddCircle(here, 6 * pixel_, ink(palette::selected_line), 0, 2.5f * pixel_);
            } else if (subject_.both_parents) {
                list_.AddLine(here, *child, ink(palette::selected_line), 3 * pixel_);
            } else {
                draw_line_to(here, *child, palette::selected_line, 3 * pixel_);
            }
            child = here;
        }
        if (at.generation == subject_.lineage.first()) {
            break;
        }
        at.index = subject_.lineage.at(at.generation).organisms[at.index].parents[0];
        --at.generation;
    }
}

/// Marks the organisms whose first parent lived on another island.
void TreeDrawing::draw_migrants() {
    constexpr std::size_t row_max = 5'000; // marks in a longer row would hide each other
    const FamilyTree& tree = subject_.tree;
    for (std::uint64_t generation = tree.first() + 1; generation <= tree.last(); ++generation) {
        const auto at = static_cast<double>(generation);
        const FamilyTree::Row &spots = tree.row(generation), &parents = tree.row(generation - 1);
        if (!view_.generations.contains(at) || spots.size() > row_max) {
            continue;
        }
        for (std::uint32_t place = 0; place < spots.size(); ++place) {
            const FamilyTree::Spot& spot = spots[place];
            if (spot.first == FamilyTree::none || !shows(point(generation, place))) {
                continue;
            }
            const Lineage::Place own = subject_.lineage.place_of(generation, spot.organism);
            if (subject_.lineage.place_of(generation - 1, parents[spot.first].organism).island != own.island) {
                draw_migrant_mark(list_, point(generation, place), pixel_);
            }
        }
    }
}

void TreeDrawing::draw_marks() {
    const FamilyTree& tree = subject_.tree;
    if (!tree.common_generation()) {
        return;
    }
    for (const std::uint32_t place : tree.common_ancestors()) {
        const ImVec2 at = point(*tree.common_generation(), place);
        list_.AddCircleFilled(at, 5.5f * pixel_, ink(palette::plot_background));
        list_.AddCircle(at, 5.5f * pixel_, ink(palette::text), 0, 2 * pixel_);
        list_.AddCircleFilled(at, 2.2f * pixel_, ink(palette::text));
    }
    if (subject_.both_parents && tree.all_common_generation()) {
        const float y = std::round(row(static_cast<double>(*tree.all_common_generation())));
        for (float x = corner_.x; x < end_.x; x += 9 * pixel_) {
            list_.AddLine({x, y}, {x + 5 * pixel_, y}, ink(palette::text), 1.5f * pixel_);
        }
    }
}

std::optional<RunOrganism> TreeDrawing::at(ImVec2 mouse) const {
    const FamilyTree& tree = subject_.tree;
    const float reach = 8 * pixel_, height = (end_.y - corner_.y) / static_cast<float>(view_.generations.width());
    const double generation =
        std::round(view_.generations.min + (mouse.y - corner_.y) / (end_.y - corner_.y) * view_.generations.width());
    if (!shows(mouse) || generation < static_cast<double>(tree.first()) ||
        generation > static_cast<double>(tree.last())) {
        return std::nullopt;
    }
    const auto number = static_cast<std::uint64_t>(generation);
    const FamilyTree::Row& spots = tree.row(number);
    const auto x = static_cast<float>(view_.x.min + (mouse.x - corner_.x) / (end_.x - corner_.x) * view_.x.width());
    auto found = std::ranges::lower_bound(spots, x, {}, &FamilyTree::Spot::x);
    if (found == spots.end() || (found != spots.begin() && x - std::prev(found)->x < found->x - x)) {
        --found;
    }
    // Along a line of first parents each point belongs to an organism; in a pedigree the mouse must be near it.
    const float down = subject_.both_parents ? std::abs(mouse.y - row(generation)) : 0;
    const bool near = std::abs(column(found->x) - mouse.x) <= reach && (down <= reach || height < 2 * reach);
    return near ? std::optional{RunOrganism{number, found->organism}} : std::nullopt;
}

void TreeDrawing::draw_pointed_at(const RunOrganism& organism) {
    const FamilyTree& tree = subject_.tree;
    const std::uint32_t place = tree.place_of(organism.generation, organism.index);
    if (place == FamilyTree::none) {
        return;
    }
    list_.PushClipRect(corner_, end_, true);
    const ImVec2 here = point(organism.generation, place);
    const FamilyTree::Spot& spot = tree.row(organism.generation)[place];
    if (subject_.both_parents) {
        for (const auto& [parent, colour] :
             {std::pair{spot.second, palette::second_parent}, std::pair{spot.first, palette::first_parent}}) {
            if (parent != FamilyTree::none) {
                list_.AddLine(point(organism.generation - 1, parent), here, ink(colour), 3 * pixel_);
            }
        }
    }
    list_.AddCircle(here, 5 * pixel_, ink(palette::text), 0, 2 * pixel_);
    list_.PopClipRect();
}

} // namespace evod::viewer
