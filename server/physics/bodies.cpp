#include "server/physics/bodies.h"

namespace evod::physics {
namespace {

/// Calls visit(column, value) for every column, with the value of a void circle in that column.
template <class F>
void for_each_column(Circles& circles, F&& visit) {
    visit(circles.x, void_position);
    visit(circles.y, void_position);
    visit(circles.velocity_x, 0.0f);
    visit(circles.velocity_y, 0.0f);
    visit(circles.inverse_mass, 0.0f);
    visit(circles.id, std::uint32_t{0});
    visit(circles.radius, 0.0f);
}

} // namespace

void Circles::clear() {
    for_each_column(*this, [](auto& column, auto) { column.clear(); });
    size_ = 0;
}

void Circles::resize(std::size_t size) {
    for_each_column(*this, [&](auto& column, auto filling) {
        column.resize(size, filling);
        column.resize(padded(size), filling);
    });
    size_ = size;
}

void Circles::put(std::size_t i, const AtRest& circle) {
    EVOD_ASSERT(i < size_);
    EVOD_ASSERT(circle.mass > 0);
    EVOD_ASSERT(circle.radius >= 0);
    EVOD_ASSERT(circle.id < 0x8000'0000);
    x[i] = circle.x;
    y[i] = circle.y;
    inverse_mass[i] = 1 / circle.mass;
    id[i] = circle.id;
    radius[i] = circle.radius;
}

void Circles::add(const AtRest& circle) {
    resize(size_ + 1);
    put(size_ - 1, circle);
}

void Circles::remove(std::size_t i) {
    EVOD_ASSERT(i < size_);
    // The id is kept: it still identifies the removed circle.
    x[i] = y[i] = void_position;
    velocity_x[i] = velocity_y[i] = 0;
    inverse_mass[i] = radius[i] = 0;
}

void Circles::reorder(const Reordering& reordering) {
    EVOD_ASSERT(reordering.size() <= size_);
    for_each_column(*this, [&](auto& column, auto filling) { reordering.apply(column, filling); });
    size_ = reordering.size();
}

void Boxes::clear() {
    *this = {};
}

void Boxes::add(Coordinate at_x, Coordinate at_y, float new_half_width, float new_half_height, float new_inverse_mass) {
    EVOD_ASSERT(new_half_width > 0);
    EVOD_ASSERT(new_half_height > 0);
    EVOD_ASSERT(new_inverse_mass >= 0);
    x.push_back(at_x);
    y.push_back(at_y);
    velocity_x.push_back(0);
    velocity_y.push_back(0);
    inverse_mass.push_back(new_inverse_mass);
    half_width.push_back(new_half_width);
    half_height.push_back(new_half_height);
}

} // namespace evod::physics
