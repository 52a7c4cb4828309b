// Snapshot columns: an island of a snapshot as encoders take it, entities by rising id.
//
// The simulation thread copies columns as they lie. What lies there is put in order here, on the network thread, where
// it keeps nobody from simulating.
//
// Owner        Streams, which keeps its memory warm from one picture to the next; on the network thread.
#pragma once

#include "proto/wire/snapshot_codec.h"
#include "server/runtime/snapshot.h"

#include <cstdint>
#include <vector>

namespace evod::network {

class SnapshotColumns {
  public:
    /// Valid until the next call, and as long as the island is there.
    wire::IslandColumns of(const runtime::IslandSnapshot& island);

  private:
    /// The items that are there.
    struct Items {
        std::vector<std::uint32_t> id;
        std::vector<std::int32_t> x, y;
    };
    static wire::ItemColumns put_in_order(const runtime::ItemsSnapshot& items, Items& to);
    wire::OrganismColumns put_in_order(const runtime::OrganismsSnapshot& organisms);

    struct Organism {
        std::int32_t x = physics::elsewhere, y = physics::elsewhere; // of a number that nobody has
        float radius_px = 0, health = 0;
    };
    std::vector<Organism> by_id_;
    struct Organisms {
        std::vector<std::uint32_t> id;
        std::vector<std::int32_t> x, y;
        std::vector<float> radius_px, health;
    } organisms_;
    Items food_, poison_;
};

} // namespace evod::network
