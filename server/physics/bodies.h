// Bodies: circles and axis-aligned boxes, without rotation, as columns.
//
// Positions are whole numbers of 1/4096 px, so a scene moves the same way anywhere on an island, however large: a
// difference of positions is exact, and only differences are turned into floats. Velocities are floats; they know no
// place. An island may be 524,288 px wide.
#pragma once

#include "server/base/column.h"
#include "server/physics/reordering.h"
#include "server/physics/units.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace evod::physics {

/// The nearest whole unit, halves to even; |px| < 2^19.
inline Coordinate to_units(double px) {
    return static_cast<Coordinate>(std::lrint(px * units_per_px));
}
inline Coordinate to_units(float px) {
    return static_cast<Coordinate>(std::lrint(px * static_cast<float>(units_per_px)));
}
inline double to_px(Coordinate units) {
    return static_cast<double>(units) / units_per_px;
}

/// b − a in units. Wraps around for what is_elsewhere, which is far from everything all the same.
inline Coordinate difference(Coordinate a, Coordinate b) {
    return static_cast<Coordinate>(static_cast<std::uint32_t>(b) - static_cast<std::uint32_t>(a));
}

/// b − a in px; exact up to 4,096 px.
inline float distance_px(Coordinate a, Coordinate b) {
    return static_cast<float>(difference(a, b)) * px_per_unit;
}

/// An island's inside: 0 … width, 0 … height. The walls are half-planes beyond it.
struct Area {
    Coordinate width = 0, height = 0;
};

/// What circles and boxes have in common; index i of every column is the same body.
struct Bodies {
    base::Column<Coordinate> x, y;              // centre
    base::Column<float> velocity_x, velocity_y; // px/s
    base::Column<float> inverse_mass;           // 1/kg; 0 is immovable
};

/// Circles, in any order; contacts are resolved in order of `id`.
///
/// Columns are padded(size()) long. What is beyond size(), and circles that have been removed until compact() is
/// called, are void: immovable, without extent, and elsewhere.
struct Circles : Bodies {
    base::Column<std::uint32_t> id; // below 2^31
    base::Column<float> radius;     // px

    std::size_t size() const { return size_; }
    bool is_void(std::size_t i) const { return x[i] == elsewhere; }
    void clear();
    /// Void circles are added, or the last ones taken away.
    void resize(std::size_t size);
    /// A circle at rest in the place of a void one; side by side for different ones.
    struct AtRest {
        std::uint32_t id;
        Coordinate x, y;
        float radius, mass; // px, kg
    };
    void put(std::size_t i, const AtRest& circle);
    /// The same, after the last one.
    void add(const AtRest& circle);
    /// Makes the circle void.
    void remove(std::size_t i);
    /// Those that are left become the circles with the indices order[0], order[1], …
    void reorder(const Reordering& reordering);

  private:
    std::size_t size_ = 0;
};

/// Boxes; their index is their identity.
struct Boxes : Bodies {
    base::Column<float> half_width, half_height; // px

    std::size_t size() const { return x.size(); }
    void clear();
    /// Adds a box at rest. inverse_mass: 0 for an obstacle.
    void add(Coordinate at_x, Coordinate at_y, float new_half_width, float new_half_height, float new_inverse_mass);
};

} // namespace evod::physics
