// Timeline layout: which pixel of the time line shows which tick, and which generations and labels are drawn there.
//
// Threads      none; pure functions.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace evod::viewer {

/// The ticks of a run along a line of pixels.
struct TimeScale {
    std::uint64_t first_tick = 0, last_tick = 0; // first_tick <= last_tick
    double left = 0, width = 1;                  // pixels

    /// A tick outside the run is at the nearer end.
    double x_of(std::uint64_t tick) const;
    /// The nearest tick; beyond an end the tick of that end.
    std::uint64_t tick_at(double x) const;
};

/// The generations to mark from `first` to `last`: at most `count_max` multiples of 1, 2, 5, 10, 20, 50, …
std::vector<std::uint64_t> marked_generations(std::uint64_t first, std::uint64_t last, std::size_t count_max);

/// A text on the line, in pixels.
struct Label {
    double left, width;
};
/// The labels to draw so that none overlaps another: the first, and each that begins at least `gap` pixels after the end
/// of the one drawn before it.
///
/// returns  indices, rising.
std::vector<std::size_t> separate_labels(std::span<const Label> labels, double gap);

} // namespace evod::viewer
