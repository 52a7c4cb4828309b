// AllPairs: the plainest engine there is, as a first program would have it: objects in one array, every object compared
// with every other in every tick, and every item looked at by every organism.
#pragma once

#include "tests/bench/engines/start_state.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace evod::bench {

class AllPairs {
  public:
    explicit AllPairs(const StartState& start) : model_{start.model}, width_{start.width}, height_{start.height} {
        for (std::uint32_t item = 0; item < start.items.size(); ++item) {
            objects_.push_back({.place = start.items[item], .radius = start.model.item_radius, .number = item});
        }
        item_count_ = objects_.size();
        for (std::uint32_t i = 0; i < start.organisms.size(); ++i) {
            const Born& born = start.organisms[i];
            object_of_.push_back(objects_.size());
            objects_.push_back(
                {.place = born.place, .radius = born.radius, .inverse_mass = 1 / born.mass, .number = i});
        }
    }

    const Vector& place(std::uint32_t i) const { return objects_[object_of_[i]].place; }
    const Vector& velocity(std::uint32_t i) const { return objects_[object_of_[i]].velocity; }
    void set_velocity(std::uint32_t i, const Vector& velocity) { objects_[object_of_[i]].velocity = velocity; }
    void push(std::uint32_t i, const Vector& force) { objects_[object_of_[i]].force = force; }

    void step() {
        for (std::size_t k = item_count_; k < objects_.size(); ++k) {
            Object& body = objects_[k];
            body.velocity.x = (body.velocity.x + body.force.x * body.inverse_mass * model_.tick_s) * model_.damping;
            body.velocity.y = (body.velocity.y + body.force.y * body.inverse_mass * model_.tick_s) * model_.damping;
        }
        for (std::size_t a = 0; a < objects_.size(); ++a) {
            for (std::size_t b = a + 1; b < objects_.size(); ++b) {
                collide(objects_[a], objects_[b]);
            }
        }
        for (std::size_t k = item_count_; k < objects_.size(); ++k) {
            Object& body = objects_[k];
            body.place.x += body.velocity.x * model_.tick_s;
            body.place.y += body.velocity.y * model_.tick_s;
            keep_inside(body.place.x, body.velocity.x, body.radius, width_);
            keep_inside(body.place.y, body.velocity.y, body.radius, height_);
        }
    }

    template <class Found>
    void items_about(const Vector&, double, Found&& found) const {
        for (std::size_t k = 0; k < item_count_; ++k) {
            found(objects_[k].number);
        }
    }

    void move_item(std::uint32_t item, const Vector& place) { objects_[item].place = place; }

    void remove_organism(std::uint32_t i) {
        const std::size_t gap = object_of_[i];
        objects_[gap] = objects_.back();
        object_of_[objects_[gap].number] = gap;
        objects_.pop_back();
    }

  private:
    struct Object {
        Vector place, velocity{}, force{};
        double radius, inverse_mass = 0; // an item's is 0
        std::uint32_t number;            // among the items, or among the organisms
    };

    void collide(Object& a, Object& b) const {
        const Vector way{b.place.x - a.place.x, b.place.y - a.place.y};
        const double reach = a.radius + b.radius, distance = square(way);
        if (distance > reach * reach || a.inverse_mass == 0 || b.inverse_mass == 0) {
            return;
        }
        const double length = std::sqrt(distance);
        const Vector normal = length > 0 ? Vector{way.x / length, way.y / length} : Vector{1, 0};
        const double total = a.inverse_mass + b.inverse_mass;
        shift(a.place, normal, -(reach - length) * a.inverse_mass / total);
        shift(b.place, normal, (reach - length) * b.inverse_mass / total);
        const double approach = (b.velocity.x - a.velocity.x) * normal.x + (b.velocity.y - a.velocity.y) * normal.y;
        if (approach >= 0) {
            return;
        }
        const double impulse = -(1 + model_.restitution) * approach / total;
        shift(a.velocity, normal, -impulse * a.inverse_mass);
        shift(b.velocity, normal, impulse * b.inverse_mass);
    }

    static void shift(Vector& what, const Vector& direction, double by) {
        what.x += direction.x * by;
        what.y += direction.y * by;
    }

    void keep_inside(double& place, double& velocity, double radius, double size) const {
        const double inside = std::clamp(place, radius, size - radius);
        if (inside != place && (inside - place) * velocity < 0) {
            velocity *= -model_.restitution;
        }
        place = inside;
    }

    Model model_;
    double width_, height_;
    std::size_t item_count_;
    std::vector<Object> objects_; // items, which rest, then organisms
    std::vector<std::size_t> object_of_;
};

} // namespace evod::bench
