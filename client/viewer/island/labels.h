// Labels: places the numbers above or below organisms, so that no number covers another.
//
// Owner        none: a function.
// Threads      any.
#pragma once

#include "client/viewer/drawing/camera.h"

#include <optional>
#include <span>
#include <vector>

namespace evod::viewer {

/// The number of an organism, to be placed: the centre and radius of its organism on the screen, and the width of its
/// text, in pixels.
struct HealthLabel {
    Point centre;
    double radius = 0, width = 0;
};

/// Returns the upper left corner of each label, in the order of `labels`; nullopt: there is no place for the label. A
/// label is above its organism, or below it if it would overlap a wall, an earlier label or another organism above. If
/// organisms are at both places, it is above. A label is left out if it would overlap a wall or an earlier label at
/// both places.
///
/// organisms  may be covered only where no other place is free; `width` has no meaning
/// height     of every label, in pixels
/// walls      the part of the screen inside the walls
std::vector<std::optional<Point>> place_labels(std::span<const HealthLabel> labels,
                                               std::span<const HealthLabel> organisms, double height,
                                               const Rectangle& walls);

} // namespace evod::viewer
