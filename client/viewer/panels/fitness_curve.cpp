#include "client/viewer/panels/fitness_curve.h"

#include "client/viewer/drawing/ink.h"
#include "client/viewer/text/numbers.h"

#include <algorithm>
#include <cmath>

namespace evod::viewer {

namespace {

using Generation = FitnessHistory::Generation;

constexpr float curve_height = 84, inside = 6; // pixels at scale 1

/// Maps generations and fitness to pixels.
struct Axes {
    double first = 0, last = 1, low = 0, high = 1;
    ImVec2 corner, size;

    float x_of(std::uint64_t generation) const {
        const double share = last > first ? (static_cast<double>(generation) - first) / (last - first) : 0.5;
        return corner.x + static_cast<float>(share) * size.x;
    }
    float y_of(double fitness) const {
        return corner.y + size.y * (1 - static_cast<float>((fitness - low) / (high - low)));
    }
};

void draw_line(ImDrawList& list, const Axes& axes, std::span<const Generation> generations, double Generation::*value,
               Colour colour, float thickness) {
    std::vector<ImVec2> points;
    for (const Generation& generation : generations) {
        if (std::isfinite(generation.*value)) {
            points.push_back({axes.x_of(generation.number), axes.y_of(generation.*value)});
        }
    }
    if (points.size() == 1) {
        list.AddCircleFilled(points[0], 2 * thickness, ink(colour));
    }
    list.AddPolyline(points.data(), static_cast<int>(points.size()), ink(colour), 0, thickness);
}

} // namespace

std::vector<Generation> reduced(std::span<const Generation> generations, std::size_t columns) {
    if (generations.size() <= std::max<std::size_t>(columns, 1)) {
        return {generations.begin(), generations.end()};
    }
    std::vector<Generation> result;
    for (std::size_t column = 0; column < columns; ++column) {
        const std::size_t begin = column * generations.size() / columns;
        const std::size_t end = (column + 1) * generations.size() / columns;
        Generation joined = generations[end - 1];
        double sum = 0;
        for (const Generation& generation : generations.subspan(begin, end - begin)) {
            joined.best = std::max(joined.best, generation.best);
            sum += generation.mean;
        }
        joined.mean = sum / static_cast<double>(end - begin);
        result.push_back(joined);
    }
    return result;
}

std::optional<std::uint64_t> build_fitness_curve(std::span<const Generation> generations, bool complete,
                                                 const Gui& gui) {
    const float scale = gui.scale(), edge = inside * scale, line = gui.label().FontSize + 4 * scale;
    const ImVec2 corner = ImGui::GetCursorScreenPos();
    const ImVec2 size{std::max(ImGui::GetContentRegionAvail().x, 40.f), curve_height * scale};
    const bool clicked = ImGui::InvisibleButton("##fitness", size);
    ImDrawList& list = *ImGui::GetWindowDrawList();
    list.AddRectFilled(corner, {corner.x + size.x, corner.y + size.y}, ink(palette::plot_background), 4 * scale);
    const ImVec2 title{corner.x + edge, corner.y + 2 * scale};
    if (generations.empty()) {
        write(list, gui.label(), title, palette::text_quiet,
              complete ? "Fitness: the curve begins when the first generation ends"
                       : "Fitness: loading the earlier generations …");
        return std::nullopt;
    }
    const Generation& newest = generations.back();
    float x = write(list, gui.label(), title, palette::text, "Fitness, generation " + with_separators(newest.number));
    for (const auto& [name, value, colour] :
         {std::tuple{" best ", newest.best, palette::series_orange}, {" mean ", newest.mean, palette::series_blue}}) {
        const float y = title.y + gui.label().FontSize / 2;
        list.AddLine({x + 10 * scale, y}, {x + 24 * scale, y}, ink(colour), 2 * scale);
        x = write(list, gui.label(), {x + 24 * scale, title.y}, palette::text, name + shown_fitness(value));
    }
    Axes axes{.first = static_cast<double>(generations.front().number),
              .last = static_cast<double>(newest.number),
              .corner = {corner.x + edge, corner.y + line},
              .size = {size.x - 2 * edge, size.y - line - edge}};
    const auto drawn = reduced(generations, static_cast<std::size_t>(axes.size.x));
    axes.high = 0;
    for (const Generation& generation : drawn) {
        for (const double value : {generation.best, generation.mean}) {
            axes.low = std::isfinite(value) ? std::min(axes.low, value) : axes.low;
            axes.high = std::isfinite(value) ? std::max(axes.high, value) : axes.high;
        }
    }
    axes.high = axes.high > axes.low ? axes.high + (axes.high - axes.low) * 0.05 : axes.low + 1;
    draw_line(list, axes, drawn, &Generation::mean, palette::series_blue, 1.5f * scale);
    draw_line(list, axes, drawn, &Generation::best, palette::series_orange, 1.5f * scale);
    if (!ImGui::IsItemHovered() && !clicked) {
        return std::nullopt;
    }
    const double share = static_cast<double>((ImGui::GetIO().MousePos.x - axes.corner.x) / axes.size.x);
    const double wanted = axes.first + std::clamp(share, 0.0, 1.0) * (axes.last - axes.first);
    const Generation& pointed = *std::ranges::min_element(generations, {}, [&](const Generation& generation) {
        return std::abs(static_cast<double>(generation.number) - wanted);
    });
    const float at = axes.x_of(pointed.number);
    list.AddLine({at, axes.corner.y}, {at, axes.corner.y + axes.size.y}, ink(palette::text_quiet));
    ImGui::SetTooltip("generation %s\nbest %s\nmean %s\nA click shows this generation in a replay.",
                      with_separators(pointed.number).c_str(), shown_fitness(pointed.best).c_str(),
                      shown_fitness(pointed.mean).c_str());
    return clicked ? std::optional{pointed.number} : std::nullopt;
}

} // namespace evod::viewer
