#include "server/simulation/living.h"

#include <algorithm>
#include <limits>

namespace evod::simulation {
namespace {

template <class F>
void for_each_column(Living& living, F&& visit) {
    visit(living.health);
    visit(living.loss_per_tick);
    visit(living.normal_speed);
    visit(living.impulse);
    visit(living.food_radius);
    visit(living.poison_radius);
    visit(living.health_cap);
    visit(living.poisoned_tick);
}

/// Health lost in a tick: the rate times 1 + the costs of the genes, never below 0.
float loss_per_tick(const evolution::Chromosome& genes, const Parameters& p) {
    const auto share = [&](evolution::Gene gene) { return static_cast<double>(genes(gene)) / 100; };
    const auto square = [](double x) { return x * x; };
    const double factor = 1 + p.normal_speed_cost * (share(evolution::NormalSpeed) - 1) +
                          p.impulse_cost * (square(share(evolution::Impulse)) - 1) +
                          p.base_health_cost * (share(evolution::BaseHealth) - 1) +
                          p.food_radius_cost * (square(share(evolution::FoodRadius)) - 1) +
                          p.poison_radius_cost * (square(share(evolution::PoisonRadius)) - 1);
    return static_cast<float>(p.health_loss_per_s * p.tick_s * std::max(factor, 0.0));
}

} // namespace

void Living::clear() {
    for_each_column(*this, [](auto& column) { column.clear(); });
}

void Living::add(const evolution::Chromosome& genes, const Parameters& p) {
    health.push_back(genes(evolution::BaseHealth));
    loss_per_tick.push_back(simulation::loss_per_tick(genes, p));
    normal_speed.push_back(genes(evolution::NormalSpeed));
    impulse.push_back(genes(evolution::Impulse));
    food_radius.push_back(genes(evolution::FoodRadius));
    poison_radius.push_back(genes(evolution::PoisonRadius));
    health_cap.push_back(p.health_cap_per_size > 0
                             ? static_cast<float>(p.health_cap_per_size) * genes(evolution::BodySize)
                             : std::numeric_limits<float>::infinity());
    poisoned_tick.push_back(0);
}

void Living::keep_only(const std::vector<std::uint8_t>& keep) {
    for_each_column(*this, [&](auto& column) { physics::keep_flagged(column, keep); });
}

BodyShape body_shape(float body_size_gene, const Parameters& p) {
    return {body_size_gene * static_cast<float>(p.radius_per_unit_px),
            body_size_gene * static_cast<float>(p.mass_per_unit_kg)};
}

void Fate::begin_generation(std::size_t organisms) {
    lived_ticks.assign(organisms, 0);
    cause.assign(organisms, CauseOfDeath::Alive);
    food_eaten.assign(organisms, 0);
    poison_eaten.assign(organisms, 0);
}

} // namespace evod::simulation
