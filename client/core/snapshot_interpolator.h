// SnapshotInterpolator: the latest two snapshots of an island, and positions interpolated between them.
//
// Snapshots arrive 20 or 30 times per second, but the screen is drawn 60 times per second. The drawn state is one
// snapshot behind: organisms move from their position in the previous snapshot to their position in the latest
// snapshot.
//
// Owner        a viewer; it has one SnapshotInterpolator for each visible island.
// Threads      none; only the drawing thread uses it.
#pragma once

#include "proto/codec/snapshot_codec.h"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace evod::core {

/// The positions at which to draw the entities of one kind. Each position is computed when it is read; nothing is
/// copied. If only `entities` is set, the positions are those in one snapshot.
struct Positions {
    static constexpr std::uint32_t no_match = ~std::uint32_t{0};
    struct Position {
        float x_px, y_px;
    };

    const codec::Entities* entities = nullptr;
    const codec::Entities* previous = nullptr; // the same kind in the previous snapshot; nullptr: no interpolation
    std::span<const std::uint32_t> match{};    // key: index in `entities`; value: index in `previous`, or no_match
    double blend = 1;                          // 0 gives the positions in `previous`, 1 those in `entities`

    std::size_t size() const { return entities == nullptr ? 0 : entities->x.size(); }
    /// Returns the centre of entity i. An entity without a match keeps its position in `entities`.
    Position operator[](std::size_t i) const {
        const std::uint32_t j = previous == nullptr ? no_match : match[i];
        if (j == no_match) {
            return {entities->x_px(i), entities->y_px(i)};
        }
        return {between(previous->x[j], entities->x[i]), between(previous->y[j], entities->y[i])};
    }

    /// Returns the heading of entity i in radians, turned by the smaller angle. The entities must have headings.
    float heading_radians(std::size_t i) const {
        const std::uint32_t j = previous == nullptr || !previous->has_headings() ? no_match : match[i];
        const auto turned = static_cast<std::int8_t>(j == no_match ? 0 : entities->heading[i] - previous->heading[j]);
        constexpr double per_step = 6.283185307179586 / codec::heading_steps;
        const double steps = static_cast<std::int8_t>(entities->heading[i]) - (1 - blend) * turned;
        return static_cast<float>(steps * per_step);
    }

  private:
    /// Interpolates between two positions given in steps. The difference of whole steps is exact, and few conversions
    /// are needed.
    float between(std::uint32_t from, std::uint32_t to) const {
        const double steps = static_cast<std::int32_t>(from) + static_cast<std::int32_t>(to - from) * blend;
        return static_cast<float>(steps) * (1 / codec::steps_per_px);
    }
};

class SnapshotInterpolator {
  public:
    using Clock = std::chrono::steady_clock;

    /// Two snapshots are interpolated only if they are at most this far apart in simulated time. Over longer times the
    /// real paths are not straight lines. At 30 snapshots per second, 2 s between snapshots is a speed of 60 times real
    /// time.
    static constexpr double blended_s_max = 2;
    /// The interpolation takes as long as the interval between the arrivals of the two snapshots, but at most this
    /// long. The limit lets a world that was paused for a long time show its next tick soon.
    static constexpr std::chrono::duration<double> glide_max{0.25};

    /// Adds a snapshot. It is not interpolated if it belongs to another run or generation than the previous snapshot,
    /// or to an earlier tick. A snapshot of the same tick, with another region or level of detail, replaces the latest.
    void add(std::shared_ptr<const codec::ReceivedSnapshot> snapshot, Clock::time_point arrived);

    /// Drops both snapshots. Call it before showing another world or island.
    void clear();

    /// Returns the snapshot that was added last; null if none was added.
    const std::shared_ptr<const codec::ReceivedSnapshot>& latest() const { return latest_; }
    /// Returns the snapshot before latest(); null if latest() is not interpolated.
    const std::shared_ptr<const codec::ReceivedSnapshot>& previous() const { return previous_; }

    /// Returns the progress of the interpolation at `now`: 0 draws the positions in previous(), 1 those in latest().
    /// Returns 1 if latest() is not interpolated.
    double blend_at(Clock::time_point now) const;

    /// Returns the positions at which to draw the organisms (or crates) in latest(), for a result of blend_at(). An
    /// entity that is not in previous() is drawn at its position in latest(). Valid until the next add() or clear().
    Positions organisms_at(double blend) const { return at(&codec::QuantisedSnapshot::organisms, match_, blend); }
    Positions crates_at(double blend) const { return at(&codec::QuantisedSnapshot::crates, crate_match_, blend); }

  private:
    using Kind = codec::Entities codec::QuantisedSnapshot::*;
    Positions at(Kind kind, std::span<const std::uint32_t> match, double blend) const;

    std::shared_ptr<const codec::ReceivedSnapshot> latest_, previous_;
    Clock::time_point latest_arrived_{};
    std::chrono::duration<double> glide_{0};         // duration of the interpolation
    std::vector<std::uint32_t> match_, crate_match_; // as in Positions, if previous_ is set
};

} // namespace evod::core
