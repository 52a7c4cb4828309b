#include "server/simulation/hunt.h"

namespace evod::simulation {

void Hunt::look(const physics::Circles& bodies, const LivingOrganisms& living, base::Range block, std::uint32_t tick,
                OrganismColumns& columns) {
    for (std::size_t i = block.begin; i < physics::padded(block.end); ++i) {
        SeenPlaces seen_places{columns.food.x[i], columns.food.y[i], columns.poison.x[i], columns.poison.y[i], 0};
        if (i < block.end && !bodies.is_void(i)) {
            look(bodies, living, static_cast<std::uint32_t>(i), tick, seen_places);
        }
        food_x_[i] = seen_places.food_x;
        food_y_[i] = seen_places.food_y;
        threat_x_[i] = seen_places.threat_x;
        threat_y_[i] = seen_places.threat_y;
        is_hunted_[i] = seen_places.is_hunted;
    }
    columns.food.x = food_x_.data();
    columns.food.y = food_y_.data();
    columns.poison.x = threat_x_.data();
    columns.poison.y = threat_y_.data();
    columns.is_hunted = is_hunted_.data();
}

void Hunt::look(const physics::Circles& bodies, const LivingOrganisms& living, std::uint32_t body, std::uint32_t tick,
                SeenPlaces& seen_places) const {
    const physics::Coordinate x = bodies.x[body], y = bodies.y[body];
    const auto any = [](std::uint32_t) { return true; };
    if (is_predator(body)) {
        seen_places = {physics::void_position, physics::void_position, physics::void_position, physics::void_position,
                       0};
        if (living.hunts_from[body] <= tick) {
            const std::uint32_t seen = prey_.nearest(bodies, x, y, living.food_radius[body], any);
            if (seen != BodyGrid::none) {
                seen_places.food_x = bodies.x[seen];
                seen_places.food_y = bodies.y[seen];
            }
        }
        return;
    }
    const std::uint32_t seen = predators_.nearest(bodies, x, y, living.poison_radius[body], any);
    if (seen == BodyGrid::none) {
        return;
    }
    const auto square_to = [&](physics::Coordinate to_x, physics::Coordinate to_y) {
        const float dx = physics::distance_px(x, to_x), dy = physics::distance_px(y, to_y);
        return dx * dx + dy * dy;
    };
    if (square_to(bodies.x[seen], bodies.y[seen]) <= square_to(seen_places.threat_x, seen_places.threat_y)) {
        seen_places.threat_x = bodies.x[seen];
        seen_places.threat_y = bodies.y[seen];
        seen_places.is_hunted = -1;
    }
}

} // namespace evod::simulation
