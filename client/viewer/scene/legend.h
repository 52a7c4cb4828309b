// Legend: what the colours over the island mean, in its lower left corner.
//
// Threads      none; used by the thread that draws.
#pragma once

#include "client/viewer/drawing/camera.h"
#include "client/viewer/drawing/gui.h"
#include "client/viewer/scene/marks.h"
#include "client/viewer/scene/sight.h"

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

/// Of what is shown of a picture; empty where colours say nothing but what is what.
///
/// density  of the densities that are drawn, if they are
Legend legend_of(const Sight& sight, const codec::DecodedSnapshot& picture, const std::optional<ColourScale>& density,
                 double density_cell_px);

/// Between Gui::begin() and Gui::draw(); nothing of an empty one.
void build_legend(const Legend& legend, const Camera& camera, const Gui& gui);

} // namespace evod::viewer
