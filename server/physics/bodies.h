// Bodies: circles and axis-aligned boxes, without rotation, as columns.
//
// Positions are whole numbers of 1/4096 px, so a scene moves the same way anywhere on an island, however large: a
// difference of positions is exact, and only differences are turned into floats. Velocities are floats; they know no
// place. An island may be 524,288 px wide.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace evod::physics {

using Coordinate = std::int32_t;
constexpr Coordinate units_per_px = 4096;
constexpr float px_per_unit = 1.0f / units_per_px;

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

/// b − a in px; exact up to 4,096 px.
inline float distance_px(Coordinate a, Coordinate b) {
    return static_cast<float>(b - a) * px_per_unit;
}

/// An island's inside: 0 … width, 0 … height. The walls are half-planes beyond it.
struct Area {
    Coordinate width = 0, height = 0;
};

/// What circles and boxes have in common; index i of every column is the same body.
struct Bodies {
    std::vector<Coordinate> x, y;              // centre
    std::vector<float> velocity_x, velocity_y; // px/s
    std::vector<float> force_x, force_y;       // kg px/s², until the end of the tick
    std::vector<float> inverse_mass;           // 1/kg; 0 is immovable

    std::size_t size() const { return x.size(); }
};

/// Circles; `id` rises with the index, and contacts are resolved in order of it.
struct Circles : Bodies {
    std::vector<std::uint32_t> id;
    std::vector<float> radius; // px

    void clear();
    /// Adds a circle at rest.
    void add(std::uint32_t new_id, Coordinate at_x, Coordinate at_y, float new_radius, float mass);
    /// Keeps the bodies whose flag is set, in their order. keep: shape (size).
    void keep_only(const std::vector<std::uint8_t>& keep);
};

/// Boxes; their index is their identity.
struct Boxes : Bodies {
    std::vector<float> half_width, half_height; // px

    void clear();
    /// Adds a box at rest. inverse_mass: 0 for an obstacle.
    void add(Coordinate at_x, Coordinate at_y, float new_half_width, float new_half_height, float new_inverse_mass);
};

/// Keeps the elements whose flag is set, in their order.
template <class T>
void keep_flagged(std::vector<T>& column, const std::vector<std::uint8_t>& keep) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < column.size(); ++i)
        if (keep[i])
            column[kept++] = column[i];
    column.resize(kept);
}

} // namespace evod::physics
