#include "client/viewer/island/legend.h"

#include "client/viewer/drawing/ink.h"
#include "client/viewer/text/numbers.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>

namespace evod::viewer {

std::string gene_title(const std::string& name) {
    return name + (name == "food_radius" || name == "poison_radius" ? ", px"
                   : name.find('<') != std::string::npos            ? "" // a weight
                                                                    : ", gene units");
}

Legend legend_of(const IslandView& island_view, const codec::ReceivedSnapshot& snapshot,
                 const std::optional<ColourScale>& density, double density_cell_px) {
    Legend legend;
    const Population* population = island_view.population();
    if (density) {
        const std::string side = shown_number(density_cell_px);
        legend.ramp = {"organisms in " + side + " × " + side + " px", *density};
        return legend;
    }
    switch (island_view.options.colour_by) {
    case ColourBy::Nothing:
        break;
    case ColourBy::Health:
        legend.ramp = {"health, points", health_scale(snapshot.entities->organisms, island_view.options.ramp)};
        break;
    case ColourBy::Gene:
        if (population != nullptr && island_view.options.gene < population->gene_count()) {
            legend.ramp = {gene_title(island_view.gene_names()[island_view.options.gene]),
                           gene_scale(*population, island_view.options.gene, island_view.options.ramp)};
        }
        break;
    }
    if (snapshot.entities->organisms.has_species()) {
        legend.entries.push_back({{}, "predator", &Styles::predator});
    }
    const bool needs_population = island_view.options.colour_by == ColourBy::Gene ||
                                  island_view.options.radii == Which::All || island_view.options.forces != Which::None;
    if (needs_population && population == nullptr && !island_view.problem().empty()) {
        legend.entries.push_back({palette::unknown, island_view.problem()});
    }
    if (island_view.options.radii == Which::All && population != nullptr) {
        legend.entries.push_back({{}, "perception radius for food", &Styles::food_radius});
        legend.entries.push_back({{}, "perception radius for poison", &Styles::poison_radius});
    }
    if (island_view.options.forces != Which::None && population != nullptr) {
        const palette::IslandColours& colours = palette::of(island_view.options.look);
        const std::string length = "; an arrow of 30 px is 100 kg px/s²";
        if (snapshot.entities->organisms.has_headings()) {
            legend.entries.push_back({colours.wanders, "steered by its network" + length, &Styles::arrow});
        } else {
            legend.entries.push_back({colours.seeks, "seeks food", &Styles::arrow});
            legend.entries.push_back({colours.flees, "flees from poison", &Styles::arrow});
            legend.entries.push_back({colours.wanders, "wanders" + length, &Styles::arrow});
        }
    }
    return legend;
}

void build_legend(const Legend& legend, const Camera& camera, const Gui& gui, Look look, MarkPainter& marks) {
    if (legend.empty()) {
        return;
    }
    const float pixel = gui.scale();
    const float inside = 8 * pixel, line = 18 * pixel, bar_width = 200 * pixel, bar_height = 12 * pixel,
                swatch = 12 * pixel, gap = 6 * pixel;
    const ImFont& font = gui.label();
    float width = legend.ramp ? std::max(bar_width, size_of(legend.ramp->title, font).x) : 0;
    for (const Legend::Entry& entry : legend.entries) {
        width = std::max(width, size_of(entry.text, font).x + swatch + gap);
    }
    const float height = (legend.ramp ? 2 * line + bar_height + 4 * pixel : 0) +
                         static_cast<float>(legend.entries.size()) * line + 2 * inside;
    const Rectangle& viewport = camera.viewport();
    const ImVec2 corner{std::floor(static_cast<float>(viewport.left)) + 12 * pixel,
                        std::floor(static_cast<float>(viewport.top + viewport.height) - height - 12 * pixel)};
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    const palette::IslandColours& colours = palette::of(look);
    const Styles& styles = styles_of(look);
    list.AddRectFilled(corner, {corner.x + width + 2 * inside, corner.y + height}, ink(colours.ground), 4 * pixel);
    list.AddRect(corner, {corner.x + width + 2 * inside, corner.y + height}, ink(faint(colours.label, 80)), 4 * pixel);
    const float left = corner.x + inside;
    float top = corner.y + inside;
    if (legend.ramp) {
        const ColourScale& scale = legend.ramp->scale;
        write(list, font, {left, top}, colours.label, legend.ramp->title);
        top += line;
        draw_ramp(list, {left, top}, {bar_width, bar_height}, scale.ramp);
        top += bar_height + 4 * pixel;
        write(list, font, {left, top}, colours.label, shown_number(scale.low));
        write_to_the_left(list, font, {left + bar_width, top}, colours.label, shown_number(scale.high));
        top += line;
    }
    for (const Legend::Entry& entry : legend.entries) {
        const ImVec2 centre{left + swatch / 2, top + line / 2};
        marks.add(list, centre, swatch / 2, double{pixel}, styles.*entry.mark, entry.colour);
        write(list, font, {left + swatch + gap, top}, colours.label, entry.text);
        top += line;
    }
}

} // namespace evod::viewer
