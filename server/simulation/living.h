// Living: the organisms that are alive, as columns; and what became of all that were born.
#pragma once

#include "server/evolution/chromosome.h"
#include "server/physics/bodies.h"
#include "server/simulation/parameters.h"

#include <cstdint>
#include <vector>

namespace evod::simulation {

enum class CauseOfDeath : std::uint8_t { Alive, Starved, Poisoned };

/// Index i of every column is the organism with body i; its id is its birth order.
struct Living {
    std::vector<float> health;
    std::vector<float> loss_per_tick;              // health that living costs
    std::vector<float> normal_speed, impulse;      // gene units
    std::vector<float> food_radius, poison_radius; // px; how far it sees
    std::vector<float> health_cap;                 // at a meal; infinite for none
    std::vector<std::uint32_t> poisoned_tick;      // of the generation, in which it last ate poison; 0 for never

    std::size_t size() const { return health.size(); }
    void clear();
    void add(const evolution::Chromosome& genes, const Parameters& parameters);
    /// Keeps the organisms whose flag is set, in their order. keep: shape (size).
    void keep_only(const std::vector<std::uint8_t>& keep);
};

/// Radius and mass of the body grown from a chromosome, px and kg.
struct BodyShape {
    float radius_px, mass_kg;
};
BodyShape body_shape(float body_size_gene, const Parameters& parameters);

/// What became of each organism that was born, by id.
struct Fate {
    std::vector<std::uint32_t> lived_ticks; // until death; 0 for the living
    std::vector<CauseOfDeath> cause;
    std::vector<std::uint32_t> food_eaten, poison_eaten;

    void begin_generation(std::size_t organisms);
};

} // namespace evod::simulation
