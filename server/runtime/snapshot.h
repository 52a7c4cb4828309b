// Snapshot: an immutable picture of a world between two ticks, for those who watch it.
//
// Taking one is copying columns as they lie, for worlds stand still meanwhile; to put entities in order and to compute
// anything of them is left to the reader's thread.
//
// Owner        shared; the last to let go gives the memory back to the pool it came from.
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

/// By id where each is, and what is there, in any order: the dead may have left void places.
struct OrganismsSnapshot {
    base::Column<std::uint32_t> place_of; // simulation::Island::no_body of the dead
    base::Column<physics::Coordinate> x, y;
    base::Column<float> radius_px, health;
    std::uint32_t alive_count = 0;
};

struct ItemsSnapshot {
    base::Column<simulation::Items::Item> all; // by id, there or not
    std::uint32_t present_count = 0;
};

struct BoxesSnapshot {
    std::vector<physics::Coordinate> x, y;
    std::vector<float> half_width_px, half_height_px;
};

struct IslandSnapshot {
    std::uint32_t island = 0;
    double width_px = 0, height_px = 0;
    simulation::LiveStatistics live; // but for health_mean, which follows from what organisms have
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
    bool after_change = false; // shows what a command or a reached goal has changed: to be shown whatever the rate
    std::vector<IslandSnapshot> islands; // those that are watched, by rising index
};

using SnapshotPtr = std::shared_ptr<const Snapshot>;

/// Hands out snapshots and takes their memory back when nobody holds them.
class SnapshotPool {
  public:
    SnapshotPool() : spare_{std::make_shared<Spare>()} {}

    /// islands  the indices of those to copy, each below the world's island count.
    SnapshotPtr take(const simulation::Entry& entry, const std::vector<std::uint32_t>& islands, bool after_change);

  private:
    static constexpr std::size_t spares_max = 4; // one written, one waiting, one being sent, one to spare
    struct Spare {
        std::mutex mutex; // guards what follows
        std::vector<std::unique_ptr<Snapshot>> snapshots;
    };
    std::shared_ptr<Spare> spare_; // outlives the pool while snapshots are held
};

} // namespace evod::runtime
