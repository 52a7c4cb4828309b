// Legend: explains the colours of the organisms. It is drawn in the lower left corner of the island.
//
// Threads      none; used by the thread that draws.
#pragma once

#include "client/viewer/drawing/camera.h"
#include "client/viewer/drawing/gui.h"
#include "client/viewer/island/island_view.h"
#include "client/viewer/island/mark_painter.h"
#include "client/viewer/island/marks.h"
#include "client/viewer/island/styles.h"

#include <optional>
#include <string>
#include <vector>

namespace evod::viewer {

struct Legend {
    struct Ramp {
        std::string title; // includes the unit
        ColourScale scale;
    };
    struct Entry {
        std::optional<Colour> colour; // nullopt: the colour of the mark's style
        std::string text;
        ShapeStyle Styles::*mark = &Styles::coloured; // the mark that the text explains
    };
    std::optional<Ramp> ramp;
    std::vector<Entry> entries;
    bool empty() const { return !ramp && entries.empty(); }
};

/// Returns the gene's name with its unit: "food_radius, px".
std::string gene_title(const std::string& name);

/// Returns the legend for a drawn snapshot; empty if organisms are not coloured by a property.
///
/// density  the colour scale of the densities; nullopt if no densities are drawn
Legend legend_of(const IslandView& island_view, const codec::ReceivedSnapshot& snapshot,
                 const std::optional<ColourScale>& density, double density_cell_px);

/// Draws the legend unless it is empty. Call between Gui::begin() and Gui::draw().
void build_legend(const Legend& legend, const Camera& camera, const Gui& gui, Look look, MarkPainter& marks);

} // namespace evod::viewer
