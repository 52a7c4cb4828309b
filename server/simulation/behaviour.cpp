#include "server/simulation/behaviour.h"

#include "server/base/elementary.h"

#include <cmath>

namespace evod::simulation {
namespace {

struct Force {
    float x, y;
};

/// A force of size `size` along (x, y), or in a random direction if that has no length.
Force along(float x, float y, float size, const base::RandomKey& key, std::uint32_t id, std::uint32_t tick) {
    const float square = x * x + y * y;
    if (square == 0) {
        const base::Direction random = base::direction(key.words(id, tick, 0)[0]);
        return {random.x * size, random.y * size};
    }
    const float share = size / std::sqrt(square);
    return {x * share, y * share};
}

} // namespace

void perceive_and_choose(const Living& living, const Items& food, const Items& poison, const BehaviourRules& rules,
                         const base::RandomKey& key, std::uint32_t tick, physics::Circles& bodies, Sight& sight,
                         base::Executor& executor) {
    const std::size_t n = living.size();
    sight.x = bodies.x;
    sight.y = bodies.y;
    sight.food_distance.resize(n);
    sight.poison_distance.resize(n);
    executor.parallel_for(n, 512, [&](base::Range range) {
        for (std::size_t i = range.begin; i < range.end; ++i) {
            const std::uint32_t id = bodies.id[i];
            const Items::Nearest meal = food.nearest(bodies.x[i], bodies.y[i], living.food_radius[i]);
            const Items::Nearest danger = poison.nearest(bodies.x[i], bodies.y[i], living.poison_radius[i]);
            sight.food_distance[i] = std::sqrt(meal.square);
            sight.poison_distance[i] = std::sqrt(danger.square);
            const bool sees_food = meal.item != Items::none, sees_poison = danger.item != Items::none;

            const bool afraid =
                sees_poison && (rules.flee_rule == FleeRule::Always || !sees_food || danger.square < meal.square);
            const float effort = living.impulse[i] * rules.force_per_unit;
            Force force;
            if (afraid && base::unit_float(key.words(id, tick, 0)[1]) * rules.certain_impulse < living.impulse[i])
                force = along(-danger.dx, -danger.dy, effort, key, id, tick);
            else if (sees_food)
                force = along(meal.dx - bodies.velocity_x[i] * rules.lookahead_s,
                              meal.dy - bodies.velocity_y[i] * rules.lookahead_s, effort, key, id, tick);
            else
                force = along(0, 0, living.normal_speed[i] * rules.force_per_unit, key, id, tick);
            bodies.force_x[i] += force.x;
            bodies.force_y[i] += force.y;
        }
    });
}

} // namespace evod::simulation
