// Snapshot: an immutable copy of a world between two ticks, for streaming.
//
// The worlds wait while the simulation thread copies, so it only copies columns in the order of memory. The thread that
// reads the snapshot sorts the entities and does all other calculations.
//
// Owner        shared. The last owner returns the memory to the pool that created the snapshot.
// Threads      the simulation thread creates a snapshot. Any thread may read it.
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

/// Columns in the order of memory, with gaps where organisms have died, and the position of each organism in the
/// columns.
struct OrganismsSnapshot {
    // Key: id of an organism; value: its index in the columns, or simulation::Island::no_body if it is dead.
    base::Column<std::uint32_t> place_of;
    base::Column<physics::Coordinate> x, y;
    base::Column<float> radius_px, health;
    base::Column<float> heading; // radians; empty if organisms have no heading
    // Key: id of an organism, alive or dead. Empty in worlds without predators.
    std::vector<simulation::Species> species;
    std::uint32_t alive_count = 0;
};

struct ItemsSnapshot {
    base::Column<simulation::Items::Item> all; // index: id of the item; includes items that are not present
    std::uint32_t present_count = 0;
};

struct BoxesSnapshot {
    std::vector<physics::Coordinate> x, y;
    std::vector<float> half_width_px, half_height_px;
};

struct IslandSnapshot {
    std::uint32_t island = 0;
    double width_px = 0, height_px = 0;
    simulation::LiveStatistics live; // health_mean is not set, because the reader computes it
    OrganismsSnapshot organisms;
    ItemsSnapshot food, poison;
    BoxesSnapshot boxes; // first the crates, then the obstacles
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
    // true: the snapshot shows the effect of a command or of a reached goal, so the server sends it regardless of the
    // rate.
    bool after_change = false;
    std::vector<IslandSnapshot> islands; // the islands with subscriptions, in order of their indices
};

using SnapshotPtr = std::shared_ptr<const Snapshot>;

/// Creates snapshots and reuses the memory of released ones.
class SnapshotPool {
  public:
    SnapshotPool() : spare_{std::make_shared<Spare>()} {}

    /// Copies these islands of a world into a snapshot. Each index must be below the world's island count.
    SnapshotPtr take(const simulation::Entry& entry, const std::vector<std::uint32_t>& islands, bool after_change);

  private:
    static constexpr std::size_t spares_max = 4; // one being written, one waiting, one being sent, and one in reserve
    struct Spare {
        std::mutex mutex; // guards the members below
        std::vector<std::unique_ptr<Snapshot>> snapshots;
    };
    std::shared_ptr<Spare> spare_; // may outlive the pool, because snapshots return their memory to it
};

} // namespace evod::runtime
