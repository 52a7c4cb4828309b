// Bodies: circles and axis-aligned boxes, without rotation, stored as columns.
//
// Positions are whole numbers of 1/4096 px. A difference of two positions is exact, and only differences are converted
// to floats, so bodies move the same way at every place of an island, however large it is. Velocities are floats. An
// island may be 524,288 px wide.
#pragma once

#include "server/base/assert.h"
#include "server/base/column.h"
#include "server/physics/reordering.h"
#include "server/physics/units.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace evod::physics {

/// The side of an island is shorter than this, so that every position fits into a Coordinate.
constexpr double island_size_max_px = 1 << 19;

/// Converts px to units, rounded to the nearest unit, halves to even; |px| < island_size_max_px.
inline Coordinate to_units(double px) {
    EVOD_ASSERT(std::abs(px) < island_size_max_px);
    return static_cast<Coordinate>(std::lrint(px * units_per_px));
}
inline Coordinate to_units(float px) {
    EVOD_ASSERT(std::abs(px) < static_cast<float>(island_size_max_px));
    return static_cast<Coordinate>(std::lrint(px * static_cast<float>(units_per_px)));
}
inline double to_px(Coordinate units) {
    return static_cast<double>(units) / units_per_px;
}

/// Returns b − a in units. For a void body the subtraction may wrap around, but the result is still a large distance.
inline Coordinate difference(Coordinate a, Coordinate b) {
    return static_cast<Coordinate>(static_cast<std::uint32_t>(b) - static_cast<std::uint32_t>(a));
}

/// Returns b − a in px; exact up to 4,096 px.
inline float distance_px(Coordinate a, Coordinate b) {
    return static_cast<float>(difference(a, b)) * px_per_unit;
}

/// The inside of an island in units: 0 … width, 0 … height. The walls are the half-planes outside it.
struct Area {
    Coordinate width = 0, height = 0;
};

/// The columns that circles and boxes share; index i of every column is the same body.
struct Bodies {
    base::Column<Coordinate> x, y;              // centre
    base::Column<float> velocity_x, velocity_y; // px/s
    base::Column<float> inverse_mass;           // 1/kg; 0 means immovable
};

/// Circles, in any order. Contacts are resolved in order of `id`.
///
/// Columns have padded(size()) elements. The elements beyond size() are void: immovable, without extent, at
/// void_position. A removed circle is void until reorder() leaves it out.
struct Circles : Bodies {
    base::Column<std::uint32_t> id; // below 2^31
    base::Column<float> radius;     // px

    std::size_t size() const { return size_; }
    bool is_void(std::size_t i) const { return x[i] == void_position; }
    void clear();
    /// Changes the number of circles: appends void circles, or removes the last circles.
    void resize(std::size_t size);
    /// A circle at rest. put() replaces a void circle by it; different void circles may be replaced in parallel.
    struct AtRest {
        std::uint32_t id;
        Coordinate x, y;
        float radius, mass; // px, kg
    };
    void put(std::size_t i, const AtRest& circle);
    /// Appends a circle at rest.
    void add(const AtRest& circle);
    /// Makes a circle void: an immovable placeholder that touches nothing.
    void remove(std::size_t i);
    /// Sorts the circles: order[0], order[1], … become circles 0, 1, …, and circles that `order` leaves out are
    /// dropped.
    void reorder(const Reordering& reordering);

  private:
    std::size_t size_ = 0;
};

/// Boxes. A box's index is its identity.
struct Boxes : Bodies {
    base::Column<float> half_width, half_height; // px

    std::size_t size() const { return x.size(); }
    void clear();
    /// Adds a box at rest. new_inverse_mass must be 0 for an obstacle.
    void add(Coordinate at_x, Coordinate at_y, float new_half_width, float new_half_height, float new_inverse_mass);
};

} // namespace evod::physics
