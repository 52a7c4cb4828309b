// Past: which seek is sent when, and where the moments of a run lie along a line.
//
// Threads      none; used by the thread that draws.
#pragma once

#include "evod/v1/commands.pb.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace evod::viewer {

/// Seeks, one at a time: while one is under way the newest that is asked for waits, and those between are never sent.
class Seeks {
  public:
    /// Returns what is to be sent now; nullopt while another is under way.
    std::optional<evod::v1::RunMoment> ask(evod::v1::RunMoment to);
    /// The one under way was answered, or never will be. Returns what is to be sent next.
    std::optional<evod::v1::RunMoment> answered();
    void forget() { *this = Seeks{}; }

    /// Where it will be when all that was asked for is done; null if nothing is under way.
    const evod::v1::RunMoment* target() const;

  private:
    std::optional<evod::v1::RunMoment> under_way_, next_;
};

/// The ticks of a run along a line of pixels.
struct TimeScale {
    std::uint64_t first_tick = 0, last_tick = 0; // first_tick <= last_tick
    double left = 0, width = 1;                  // pixels

    double x_of(std::uint64_t tick) const; // of a tick outside: the nearer end
    std::uint64_t tick_at(double x) const; // the nearest; beyond an end: that
};

/// Generations to be marked: at most `count_max` from `first` to `last`, multiples of 1, 2, 5, 10, 20, 50, …
std::vector<std::uint64_t> marked_generations(std::uint64_t first, std::uint64_t last, std::size_t count_max);

/// What is written along a line, in pixels.
struct Label {
    double left, width;
};
/// The labels that can be written without covering each other: the first, and each that begins `apart` pixels or more
/// after the one before it that is written. Indices, rising.
std::vector<std::size_t> labels_apart(std::span<const Label> labels, double apart);

} // namespace evod::viewer
