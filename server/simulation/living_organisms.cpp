#include "server/simulation/living_organisms.h"

#include "server/base/assert.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace evod::simulation {
namespace {

/// Calls visit(column, value) for every column, with the value of a void organism in that column.
template <class F>
void for_each_column(LivingOrganisms& living, F&& visit) {
    visit(living.health, -std::numeric_limits<float>::infinity());
    visit(living.loss_per_tick, 0.0f);
    visit(living.normal_speed, 0.0f);
    visit(living.impulse, 0.0f);
    visit(living.food_radius, 0.0f);
    visit(living.poison_radius, 0.0f);
    if (living.has_brains()) {
        visit(living.heading, 0.0f);
        visit(living.base_health, 0.0f);
    }
    if (living.in_colony()) {
        visit(living.hunts_from, 0u);
        visit(living.dies_in, LivingOrganisms::never_old);
    }
}

/// Returns the health lost per tick: the rate times 1 + the costs of the genes, never below 0.
float loss_per_tick(const evolution::BodyGenes& genes, const parameters::Parameters& p) {
    const auto share = [&](evolution::Gene gene) { return static_cast<double>(genes(gene)) / 100; };
    const auto square = [](double x) { return x * x; };
    const double factor = 1 + p.body_size_cost * (share(evolution::BodySize) - 1) +
                          p.normal_speed_cost * (share(evolution::NormalSpeed) - 1) +
                          p.impulse_cost * (square(share(evolution::Impulse)) - 1) +
                          p.base_health_cost * (share(evolution::BaseHealth) - 1) +
                          p.food_radius_cost * (square(share(evolution::FoodRadius)) - 1) +
                          p.poison_radius_cost * (square(share(evolution::PoisonRadius)) - 1);
    return static_cast<float>(p.health_loss_per_s * p.tick_s * std::max(factor, 0.0));
}

} // namespace

void LivingOrganisms::clear(std::uint32_t weight_count, bool in_colony) {
    for_each_column(*this, [](auto& column, auto) { column.clear(); });
    weights.clear();
    weight_count_ = weight_count;
    in_colony_ = in_colony;
}

void LivingOrganisms::resize(std::size_t size) {
    for_each_column(*this, [&](auto& column, auto filling) {
        column.resize(size, filling);
        column.resize(physics::padded(size), filling);
    });
    weights.resize(physics::padded(size) * weight_count_);
}

void LivingOrganisms::put(std::size_t body, const evolution::BodyGenes& genes, const parameters::Parameters& p) {
    EVOD_ASSERT(body < health.size());
    health[body] = genes(evolution::BaseHealth);
    loss_per_tick[body] = simulation::loss_per_tick(genes, p);
    normal_speed[body] = genes(evolution::NormalSpeed);
    impulse[body] = genes(evolution::Impulse);
    food_radius[body] = genes(evolution::FoodRadius);
    poison_radius[body] = genes(evolution::PoisonRadius);
    if (has_brains()) {
        base_health[body] = genes(evolution::BaseHealth);
    }
}

void LivingOrganisms::put_brain(std::size_t body, std::span<const float> new_weights, float new_heading) {
    EVOD_ASSERT(std::abs(new_heading) <= heading_max);
    heading[body] = new_heading;
    put_weights(body, new_weights);
}

void LivingOrganisms::put_weights(std::size_t body, std::span<const float> new_weights) {
    EVOD_ASSERT(new_weights.size() == weight_count_);
    float* place = weights.data() + first_weight(body);
    for (const float weight : new_weights) {
        *place = weight;
        place += physics::lanes_max;
    }
}

void LivingOrganisms::reorder(const physics::Reordering& reordering) {
    for_each_column(*this, [&](auto& column, auto filling) { reordering.apply(column, filling); });
    weights.resize(physics::padded(reordering.size()) * weight_count_);
}

float health_cap(const evolution::BodyGenes& genes, const parameters::Parameters& p) {
    if (p.health_cap_per_size <= 0) {
        return std::numeric_limits<float>::infinity();
    }
    // A tiny limit rounds to 0. A meal leaves the living alive, so their health stays above 0.
    return std::max(static_cast<float>(p.health_cap_per_size) * genes(evolution::BodySize),
                    std::numeric_limits<float>::denorm_min());
}

BodyShape body_shape(float body_size_gene, const parameters::Parameters& p) {
    EVOD_ASSERT(body_size_gene > 0);
    return {body_size_gene * static_cast<float>(p.radius_per_unit_px),
            body_size_gene * static_cast<float>(p.mass_per_unit_kg)};
}

base::StateHash hash_of_organism(const physics::Circles& bodies, const LivingOrganisms& living, std::size_t body) {
    base::StateHash hash = base::hash_of({.kind = organism_hash_kind,
                                          .id = bodies.id[body],
                                          .a = static_cast<std::uint32_t>(bodies.x[body]),
                                          .b = static_cast<std::uint32_t>(bodies.y[body]),
                                          .c = std::bit_cast<std::uint32_t>(bodies.velocity_x[body]),
                                          .d = std::bit_cast<std::uint32_t>(bodies.velocity_y[body]),
                                          .e = std::bit_cast<std::uint32_t>(living.health[body])});
    if (living.has_brains()) {
        hash += base::hash_of({.kind = heading_hash_kind,
                               .id = bodies.id[body],
                               .a = std::bit_cast<std::uint32_t>(living.heading[body]),
                               .b = 0,
                               .c = 0,
                               .d = 0,
                               .e = 0});
    }
    return hash;
}

void LifeRecords::begin_generation(std::size_t organisms, bool in_colony) {
    lived_ticks.assign(organisms, 0);
    cause.assign(organisms, CauseOfDeath::Alive);
    food_eaten.assign(organisms, 0);
    poison_eaten.assign(organisms, 0);
    children.assign(in_colony ? organisms : 0, 0);
}

void LifeRecords::add(bool in_colony) {
    lived_ticks.push_back(0);
    cause.push_back(CauseOfDeath::Alive);
    food_eaten.push_back(0);
    poison_eaten.push_back(0);
    if (in_colony) {
        children.push_back(0);
    }
}

} // namespace evod::simulation
