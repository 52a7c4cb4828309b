// Placement: uniform random places on an island that do not overlap obstacles or bodies already placed.
//
// Determinism  a place depends only on the given stream and on the bodies placed before. Organisms are placed in order
//              of id. Each organism gets the first of its random places that is clear of the bodies placed before, for
//              any number of threads.
#pragma once

#include "server/base/executor.h"
#include "server/base/random.h"
#include "server/physics/bodies.h"
#include "server/simulation/place_grid.h"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace evod::simulation {

/// Stores boxes in a grid, and tests whether a place is clear of them. The cost does not depend on the number of boxes.
class BoxGrid {
  public:
    /// Creates a grid without boxes.
    BoxGrid() = default;
    BoxGrid(const physics::Area& area, std::size_t expected_count) : grid_{area, expected_count} {}
    /// Creates a grid with these boxes at their present positions.
    BoxGrid(const physics::Area& area, const physics::Boxes& boxes);

    void add(Place place, float half_width_px, float half_height_px);

    bool clear_of_circle(Place place, float radius_px) const;
    bool clear_of_box(Place place, float half_size_px) const;

  private:
    struct HalfSize {
        float width_px, height_px;
    };
    PlaceGrid<HalfSize> grid_;
    float widest_px_ = 0; // greatest half width or half height
};

/// Circles on an island, in a grid that stores their radii.
class PlacedCircles {
  public:
    /// expected_count  about so many circles will be added.
    /// widest_px       at most the radius of the widest one; a greater number makes the first searches slower.
    PlacedCircles(const physics::Area& area, std::size_t expected_count, float widest_px = 0)
        : grid_{area, expected_count}, widest_px_{widest_px} {}

    void prefetch(Place place, float radius_px) const;
    /// Returns whether a circle touches none of them.
    bool clear(Place place, float radius_px) const;
    void add(Place place, float radius_px) {
        grid_.add(place, radius_px);
        widest_px_ = std::max(widest_px_, radius_px);
    }

  private:
    PlaceGrid<float> grid_;
    float widest_px_;
};

/// Draws a uniform random place for a circle, inside the walls and clear of `boxes`.
///
/// margin_px  the least distance between a wall and the centre, if it is greater than the radius; so below too.
Place random_place(base::RandomStream& random, const physics::Area& area, float radius_px, const BoxGrid& boxes,
                   float margin_px = 0);

/// The rules of place_boxes(), which places obstacles, then crates that are clear of obstacles and of each other.
/// Obstacles stay in place from generation to generation of a run; crates are placed again.
struct BoxRules {
    std::uint32_t obstacle_count, crate_count;
    float obstacle_half_size_px, crate_half_size_px;
    float crate_mass_kg;
    float margin_px = 0;
};
struct PlacedBoxes {
    physics::Boxes obstacles, crates;
};
PlacedBoxes place_boxes(const BoxRules& rules, base::Seed seed, std::uint32_t island, std::uint64_t generation,
                        const physics::Area& area);

/// Draws uniform random places for circles, one after another, clear of walls, `boxes` and each other.
///
/// radius_px  one radius per circle. Bodies and boxes must cover at most 0.4 of the area (validate() in parameters.h).
/// returns    one place per circle.
std::vector<Place> place_circles(const std::vector<float>& radius_px, base::Seed seed, std::uint32_t island,
                                 std::uint64_t generation, const physics::Area& area, const BoxGrid& boxes,
                                 base::Executor& executor, float margin_px = 0);

} // namespace evod::simulation
