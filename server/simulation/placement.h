// Placement: uniform random places on an island that are clear of what must not be overlapped.
//
// Determinism  a place depends on the stream handed over and on what is already there; organisms are placed in order of
//              id, each clear of those before it.
#pragma once

#include "server/base/random.h"
#include "server/physics/bodies.h"

#include <cstdint>
#include <vector>

namespace evod::simulation {

struct Place {
    physics::Coordinate x, y;
};

/// A uniform random place for a circle, inside the walls and clear of `boxes`.
Place random_place(base::RandomStream& random, const physics::Area& area, float radius_px, const physics::Boxes& boxes);

/// Adds obstacles, then crates clear of obstacles and of each other. The obstacles of a run stay where they are from
/// generation to generation; crates start afresh.
struct BoxRules {
    std::uint32_t obstacle_count, crate_count;
    float obstacle_half_size_px, crate_half_size_px;
    float crate_mass_kg;
};
struct PlacedBoxes {
    physics::Boxes obstacles, crates;
};
PlacedBoxes place_boxes(const BoxRules& rules, base::Seed seed, std::uint32_t island, std::uint64_t generation,
                        const physics::Area& area);

/// Uniform random places for circles, one after another, clear of walls, `boxes` and each other.
///
/// radius_px  shape (count). Room must have been checked: together at most 0.4 of the area (parameters.h, validate).
/// returns    shape (count).
std::vector<Place> place_circles(const std::vector<float>& radius_px, base::Seed seed, std::uint32_t island,
                                 std::uint64_t generation, const physics::Area& area, const physics::Boxes& boxes);

} // namespace evod::simulation
