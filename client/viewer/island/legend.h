// Legend: what the colours mean, drawn in the lower left corner of the island.
//
// Threads      none; used by the thread that draws.
#pragma once

#include "client/viewer/drawing/camera.h"
#include "client/viewer/drawing/gui.h"
#include "client/viewer/island/island_view.h"
#include "client/viewer/island/marks.h"

#include <optional>
#include <string>
#include <vector>

namespace evod::viewer {

struct Legend {
    struct Ramp {
        std::string title; // with the unit
        ColourScale scale;
    };
    struct Entry {
        Colour colour;
        std::string text;
    };
    std::optional<Ramp> ramp;
    std::vector<Entry> entries;
    bool empty() const { return !ramp && entries.empty(); }
};

/// "food_radius, px"
std::string gene_title(const std::string& name);

/// The legend for what is drawn of a snapshot; empty if organisms are not coloured by a property.
///
/// density  the scale of the densities, if they are drawn
Legend legend_of(const IslandView& island_view, const codec::DecodedSnapshot& snapshot,
                 const std::optional<ColourScale>& density, double density_cell_px);

/// Draws the legend unless it is empty. Call between Gui::begin() and Gui::draw().
void build_legend(const Legend& legend, const Camera& camera, const Gui& gui);

} // namespace evod::viewer
