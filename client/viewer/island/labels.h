// Labels: places the numbers above or below organisms, so that they rarely overlap.
//
// Owner        none: a function.
// Threads      any.
#pragma once

#include "client/viewer/drawing/camera.h"

#include <span>
#include <vector>

namespace evod::viewer {

/// The number of an organism, to be placed: the centre and radius of its organism on the screen, and the width of its
/// text, in pixels.
struct HealthLabel {
    Point centre;
    double radius = 0, width = 0;
};

/// Returns the upper left corner of each label, in the order of `labels`. A label is above its organism, or below it if
/// it would overlap a wall or an earlier label there. If it overlaps one at both places, it is above.
///
/// height  of every label, in pixels
/// walls   the part of the screen inside the walls
std::vector<Point> place_labels(std::span<const HealthLabel> labels, double height, const Rectangle& walls);

} // namespace evod::viewer
