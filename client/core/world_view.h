// WorldView: the latest two snapshots of an island, and positions interpolated between them.
//
// Snapshots arrive 20 or 30 times a second, and the screen is drawn 60 times. The drawn state is one snapshot behind: organisms
// move from their position in the previous snapshot to that in the latest.
//
// Owner        a viewer, one for each visible island.
// Threads      none; used by the thread that draws.
#pragma once

#include "proto/codec/snapshot_codec.h"

#include <chrono>
#include <memory>
#include <vector>

namespace evod::core {

class WorldView {
  public:
    using Clock = std::chrono::steady_clock;

    /// Centres, in the order of latest()->organisms or ->crates.
    struct Positions {
        std::vector<float> x_px, y_px;
    };

    /// Snapshots further apart in simulated time are not interpolated: a straight line between them means nothing. 2 s is 60
    /// times real time at 30 snapshots per second.
    static constexpr double blended_s_max = 2;
    /// The interpolation takes as long as the interval between the arrivals of both snapshots, at most this long: a world that
    /// was paused shows its next tick soon.
    static constexpr std::chrono::duration<double> glide_max{0.25};

    /// Adds a snapshot. One of another run or generation, or of an earlier tick, is not interpolated with the previous one. One of
    /// the same tick, with another region or level of detail, replaces the latest.
    void add(std::shared_ptr<const codec::DecodedSnapshot> snapshot, Clock::time_point arrived);

    /// Drops both snapshots, for another world or island.
    void clear();

    /// Null before the first snapshot.
    const std::shared_ptr<const codec::DecodedSnapshot>& latest() const { return latest_; }
    /// Null if the latest is not interpolated.
    const std::shared_ptr<const codec::DecodedSnapshot>& previous() const { return previous_; }

    /// The position of `now` between previous() and latest(), 0 to 1; 1 without interpolation.
    double blend_at(Clock::time_point now) const;

    /// The drawn positions of the organisms and crates of latest() at a blend. An entity that previous() does not contain is at its
    /// latest position. Valid until the next call of this object.
    const Positions& organisms_at(double blend);
    const Positions& crates_at(double blend);

  private:
    std::shared_ptr<const codec::DecodedSnapshot> latest_, previous_;
    Clock::time_point latest_arrived_{};
    std::chrono::duration<double> glide_{0}; // duration of the interpolation
    // By index in latest_: index in previous_, or npos.
    std::vector<std::size_t> match_, crate_match_;
    Positions organisms_, crates_;
};

} // namespace evod::core
