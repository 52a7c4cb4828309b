// Snapshot: an immutable copy of a world between two ticks, for streaming.
//
// The worlds wait while the simulation thread copies, so it only copies columns in memory order. The thread that reads the
// snapshot sorts entities and computes everything else.
//
// Owner        shared; the last owner returns the memory to the pool it came from.
// Threads      taken by the simulation thread, read by any.
#pragma once

#include "server/base/column.h"
#include "server/base/state_hash.h"
#include "server/physics/bodies.h"
#include "server/simulation/laboratory.h"

#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace evod::runtime {

/// Columns in memory order, with gaps left by the dead, and the index of each organism in them.
struct OrganismsSnapshot {
    base::Column<std::uint32_t> place_of; // by id: index in the columns; simulation::Island::no_body for the dead
    base::Column<physics::Coordinate> x, y;
    base::Column<float> radius_px, health;
    std::uint32_t alive_count = 0;
};

struct ItemsSnapshot {
    base::Column<simulation::Items::Item> all; // by id, present or not
    std::uint32_t present_count = 0;
};

struct BoxesSnapshot {
    std::vector<physics::Coordinate> x, y;
    std::vector<float> half_width_px, half_height_px;
};

struct IslandSnapshot {
    std::uint32_t island = 0;
    double width_px = 0, height_px = 0;
    simulation::LiveStatistics live; // without health_mean, which the reader computes
    OrganismsSnapshot organisms;
    ItemsSnapshot food, poison;
    BoxesSnapshot boxes; // crates, then obstacles
    std::uint32_t crate_count = 0;
};

struct Snapshot {
    std::string world;
    simulation::RunId run_id;
    simulation::Moment moment;
    simulation::RunState state{};
    simulation::Speed speed;
    base::StateHash hash;
    double ticks_per_s = 0;
    bool slowed = false;
    double item_radius_px = 0;
    std::uint32_t island_count = 0;
    bool after_change = false;           // shows the effect of a command or a reached goal: sent whatever the rate
    std::vector<IslandSnapshot> islands; // those with subscriptions, indices rising
};

using SnapshotPtr = std::shared_ptr<const Snapshot>;

/// Makes snapshots and reuses their memory.
class SnapshotPool {
  public:
    SnapshotPool() : spare_{std::make_shared<Spare>()} {}

    /// islands  the indices of those to copy, each below the world's island count.
    SnapshotPtr take(const simulation::Entry& entry, const std::vector<std::uint32_t>& islands, bool after_change);

  private:
    static constexpr std::size_t spares_max = 4; // one being written, one waiting, one being sent, one spare
    struct Spare {
        std::mutex mutex; // guards what follows
        std::vector<std::unique_ptr<Snapshot>> snapshots;
    };
    std::shared_ptr<Spare> spare_; // outlives the pool while snapshots exist
};

} // namespace evod::runtime
