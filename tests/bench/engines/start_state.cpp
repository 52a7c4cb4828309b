#include "tests/bench/engines/start_state.h"

#include "server/base/assert.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace evod::bench {
namespace {

Model model_of(const parameters::Parameters& p) {
    return {.tick_s = p.tick_s,
            .damping = std::pow(p.damping, 60 * p.tick_s),
            .restitution = p.restitution,
            .max_speed = p.max_speed_px_s,
            .health_loss = p.health_loss_per_s * p.tick_s,
            .food_health = p.food_health,
            .poison_harm = p.poison_harm,
            .lookahead_s = p.steering_lookahead_s,
            .certain_impulse = p.flee_certain_impulse,
            .force_per_unit = p.force_per_unit,
            .item_radius = p.item_radius_px};
}

Vector place(physics::Coordinate x, physics::Coordinate y) {
    return {physics::to_px(x), physics::to_px(y)};
}

std::tuple<double, double> row_and_column(const Vector& place) {
    constexpr double cell = 200;
    return {std::floor(place.y / cell), std::floor(place.x / cell)};
}

} // namespace

StartState start_state(const simulation::World& world) {
    const parameters::Parameters& parameters = world.parameters().active;
    EVOD_ASSERT(parameters.flee_rule == parameters::FleeRule::Nearer);
    EVOD_ASSERT(parameters.respawn && parameters.respawn_s == 0);
    EVOD_ASSERT(parameters.obstacle_count + parameters.crate_count == 0);
    const simulation::Island& island = world.islands()[0];
    const evolution::GeneMatrix& genes = island.born().genes;
    StartState start{.model = model_of(parameters),
                     .width = physics::to_px(island.area().width),
                     .height = physics::to_px(island.area().height),
                     .organisms = std::vector<Born>(static_cast<std::size_t>(genes.cols())),
                     .items = {},
                     .food_count = island.food().size()};
    const physics::Circles& bodies = island.bodies();
    for (std::size_t i = 0; i < start.organisms.size(); ++i) {
        const auto gene = [&](evolution::Gene which) {
            return static_cast<double>(genes(which, static_cast<Eigen::Index>(bodies.id[i])));
        };
        start.organisms[bodies.id[i]] = {.place = place(bodies.x[i], bodies.y[i]),
                                         .radius = gene(evolution::BodySize) * parameters.radius_per_unit_px,
                                         .mass = gene(evolution::BodySize) * parameters.mass_per_unit_kg,
                                         .health = gene(evolution::BaseHealth),
                                         .normal_speed = gene(evolution::NormalSpeed),
                                         .impulse = gene(evolution::Impulse),
                                         .food_radius = gene(evolution::FoodRadius),
                                         .poison_radius = gene(evolution::PoisonRadius)};
    }
    for (const simulation::Items* kind : {&island.food(), &island.poison()}) {
        for (std::size_t item = 0; item < kind->size(); ++item) {
            start.items.push_back(place(kind->all()[item].x, kind->all()[item].y));
        }
    }
    return start;
}

StartState in_spatial_order(StartState start) {
    const auto before = [](const Vector& a, const Vector& b) { return row_and_column(a) < row_and_column(b); };
    std::stable_sort(start.organisms.begin(), start.organisms.end(),
                     [&](const Born& a, const Born& b) { return before(a.place, b.place); });
    const auto poison = start.items.begin() + static_cast<std::ptrdiff_t>(start.food_count);
    std::stable_sort(start.items.begin(), poison, before);
    std::stable_sort(poison, start.items.end(), before);
    return start;
}

} // namespace evod::bench
