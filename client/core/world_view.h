// WorldView: the latest two snapshots of an island, and positions interpolated between them.
//
// Snapshots arrive 20 or 30 times per second, but the screen is drawn 60 times per second. The drawn state is one
// snapshot behind: organisms move from their position in the previous snapshot to their position in the latest
// snapshot.
//
// Owner        a viewer; it has one WorldView for each visible island.
// Threads      none; only the drawing thread uses it.
#pragma once

#include "proto/codec/snapshot_codec.h"

#include <chrono>
#include <memory>
#include <vector>

namespace evod::core {

class WorldView {
  public:
    using Clock = std::chrono::steady_clock;

    /// Positions of the centres, in the order of latest()->organisms or latest()->crates.
    struct Positions {
        std::vector<float> x_px, y_px;
    };

    /// Two snapshots are interpolated only if they are at most this far apart in simulated time. Over longer times the
    /// real paths are not straight lines. At 30 snapshots per second, 2 s between snapshots is a speed of 60 times real
    /// time.
    static constexpr double blended_s_max = 2;
    /// The interpolation takes as long as the interval between the arrivals of the two snapshots, but at most this
    /// long. The limit lets a world that was paused for a long time show its next tick soon.
    static constexpr std::chrono::duration<double> glide_max{0.25};

    /// Adds a snapshot. It is not interpolated if it belongs to another run or generation than the previous snapshot,
    /// or to an earlier tick. A snapshot of the same tick, with another region or level of detail, replaces the latest.
    void add(std::shared_ptr<const codec::DecodedSnapshot> snapshot, Clock::time_point arrived);

    /// Drops both snapshots. Call it before showing another world or island.
    void clear();

    /// The snapshot added last; null before the first.
    const std::shared_ptr<const codec::DecodedSnapshot>& latest() const { return latest_; }
    /// The snapshot before latest(); null if latest() is not interpolated.
    const std::shared_ptr<const codec::DecodedSnapshot>& previous() const { return previous_; }

    /// Returns the progress of the interpolation at `now`: 0 draws the positions in previous(), 1 those in latest().
    /// Returns 1 if latest() is not interpolated.
    double blend_at(Clock::time_point now) const;

    /// Returns the positions at which to draw the organisms (or crates) in latest(), for a result of blend_at(). An
    /// entity that is not in previous() is drawn at its position in latest(). The reference is valid until the next
    /// call to this object.
    const Positions& organisms_at(double blend);
    const Positions& crates_at(double blend);

  private:
    std::shared_ptr<const codec::DecodedSnapshot> latest_, previous_;
    Clock::time_point latest_arrived_{};
    std::chrono::duration<double> glide_{0}; // duration of the interpolation
    // For each index in latest_: the index of the same entity in previous_, or npos.
    std::vector<std::size_t> match_, crate_match_;
    Positions organisms_, crates_;
};

} // namespace evod::core
