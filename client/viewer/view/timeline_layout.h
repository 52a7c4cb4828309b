// Timeline layout: converts between ticks and pixels of the time line, and selects the generations and labels to draw.
//
// Threads      none; pure functions.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace evod::viewer {

/// Maps the ticks of a run to positions on a line of pixels.
struct TimeScale {
    std::uint64_t first_tick = 0, last_tick = 0; // first_tick <= last_tick
    double left = 0, width = 1;                  // pixels

    /// Returns the position of a tick. A tick outside the run is placed at the nearer end of the line.
    double x_of(std::uint64_t tick) const;
    /// Returns the tick nearest to x. If x is beyond an end of the line, returns the tick at that end.
    std::uint64_t tick_at(double x) const;
};

/// Returns the generations to mark between `first` and `last`: the multiples of the smallest of 1, 2, 5, 10, 20, 50, …
/// for which there are at most `count_max` marks.
std::vector<std::uint64_t> marked_generations(std::uint64_t first, std::uint64_t last, std::size_t count_max);

/// A label on the line, in pixels.
struct Label {
    double left, width;
};
/// Selects labels that do not overlap: the first label, and then each label that begins at least `gap` pixels after the
/// end of the last selected one.
///
/// returns  indices of the selected labels, in increasing order.
std::vector<std::size_t> separate_labels(std::span<const Label> labels, double gap);

} // namespace evod::viewer
