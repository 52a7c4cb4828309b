#include "server/simulation/hunt.h"

namespace evod::simulation {

void Hunt::look(const physics::Circles& bodies, const LivingOrganisms& living, base::Range block, std::uint32_t tick,
                OrganismColumns& columns) {
    for (std::size_t i = block.begin; i < physics::padded(block.end); ++i) {
        Sight sight{columns.food.x[i], columns.food.y[i], columns.poison.x[i], columns.poison.y[i], 0};
        if (i < block.end && !bodies.is_void(i)) {
            look(bodies, living, static_cast<std::uint32_t>(i), tick, sight);
        }
        food_x_[i] = sight.food_x;
        food_y_[i] = sight.food_y;
        threat_x_[i] = sight.threat_x;
        threat_y_[i] = sight.threat_y;
        is_hunted_[i] = sight.is_hunted;
    }
    columns.food.x = food_x_.data();
    columns.food.y = food_y_.data();
    columns.poison.x = threat_x_.data();
    columns.poison.y = threat_y_.data();
    columns.is_hunted = is_hunted_.data();
}

void Hunt::look(const physics::Circles& bodies, const LivingOrganisms& living, std::uint32_t body, std::uint32_t tick,
                Sight& sight) const {
    const physics::Coordinate x = bodies.x[body], y = bodies.y[body];
    const auto any = [](std::uint32_t) { return true; };
    if (is_predator(body)) {
        sight = {physics::void_position, physics::void_position, physics::void_position, physics::void_position, 0};
        if (living.hunts_from[body] <= tick) {
            const std::uint32_t seen = prey_.nearest(bodies, x, y, living.food_radius[body], any);
            if (seen != BodyGrid::none) {
                sight.food_x = bodies.x[seen];
                sight.food_y = bodies.y[seen];
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
    if (square_to(bodies.x[seen], bodies.y[seen]) <= square_to(sight.threat_x, sight.threat_y)) {
        sight.threat_x = bodies.x[seen];
        sight.threat_y = bodies.y[seen];
        sight.is_hunted = -1;
    }
}

} // namespace evod::simulation
