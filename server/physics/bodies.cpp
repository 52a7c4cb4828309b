#include "server/physics/bodies.h"

namespace evod::physics {
namespace {

template <class F>
void for_each_column(Bodies& bodies, F&& visit) {
    visit(bodies.x);
    visit(bodies.y);
    visit(bodies.velocity_x);
    visit(bodies.velocity_y);
    visit(bodies.force_x);
    visit(bodies.force_y);
    visit(bodies.inverse_mass);
}

void add_at_rest(Bodies& bodies, Coordinate x, Coordinate y, float inverse_mass) {
    bodies.x.push_back(x);
    bodies.y.push_back(y);
    bodies.velocity_x.push_back(0);
    bodies.velocity_y.push_back(0);
    bodies.force_x.push_back(0);
    bodies.force_y.push_back(0);
    bodies.inverse_mass.push_back(inverse_mass);
}

} // namespace

void Circles::clear() {
    for_each_column(*this, [](auto& column) { column.clear(); });
    id.clear();
    radius.clear();
}

void Circles::add(std::uint32_t new_id, Coordinate at_x, Coordinate at_y, float new_radius, float mass) {
    add_at_rest(*this, at_x, at_y, 1 / mass);
    id.push_back(new_id);
    radius.push_back(new_radius);
}

void Circles::keep_only(const std::vector<std::uint8_t>& keep) {
    for_each_column(*this, [&](auto& column) { keep_flagged(column, keep); });
    keep_flagged(id, keep);
    keep_flagged(radius, keep);
}

void Boxes::clear() {
    for_each_column(*this, [](auto& column) { column.clear(); });
    half_width.clear();
    half_height.clear();
}

void Boxes::add(Coordinate at_x, Coordinate at_y, float new_half_width, float new_half_height, float new_inverse_mass) {
    add_at_rest(*this, at_x, at_y, new_inverse_mass);
    half_width.push_back(new_half_width);
    half_height.push_back(new_half_height);
}

} // namespace evod::physics
