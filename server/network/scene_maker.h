// Scene maker: an island of a snapshot as encoders take it, in whole numbers, and entities by rising id.
//
// The simulation thread copies columns as they lie. What lies there is put in order here, on the network thread, where
// it keeps nobody from simulating.
//
// Owner        Streams, which keeps its memory warm from one picture to the next; on the network thread.
#pragma once

#include "proto/wire/scene.h"
#include "server/runtime/snapshot.h"

#include <cstdint>
#include <vector>

namespace evod::network {

class SceneMaker {
  public:
    wire::Scene scene_of(const runtime::IslandSnapshot& island);

  private:
    wire::Entities organisms_of(const runtime::OrganismsSnapshot& organisms, std::uint32_t position_bytes);

    struct Organism {
        std::int32_t x = physics::elsewhere, y = physics::elsewhere; // of a number that nobody has
        float radius_px = 0, health = 0;
    };
    std::vector<Organism> by_id_;
};

} // namespace evod::network
