// Living: the organisms that are alive, as columns; and what became of all that were born.
#pragma once

#include "server/base/column.h"
#include "server/base/state_hash.h"
#include "server/evolution/chromosome.h"
#include "server/parameters/parameters.h"
#include "server/physics/bodies.h"

#include <cstdint>
#include <vector>

namespace evod::simulation {

enum class CauseOfDeath : std::uint8_t { Alive, Starved, Poisoned };

/// Index i of every column is the organism with body i; its id is that body's. Columns are as long as those of the
/// bodies, void ones included.
struct Living {
    base::Column<float> health;                     // −infinity for what is void
    base::Column<float> loss_per_tick;              // health that living costs
    base::Column<float> normal_speed, impulse;      // gene units
    base::Column<float> food_radius, poison_radius; // px; how far it sees

    void clear();
    /// As physics::Circles::resize and put.
    void resize(std::size_t size);
    void put(std::size_t body, const evolution::Chromosome& genes, const parameters::Parameters& parameters);
    /// Those that are left, as physics::Circles::reorder.
    void reorder(const physics::Reordering& reordering);
};

/// Health that a meal cannot bring an organism above; infinite for none.
float health_cap(const evolution::Chromosome& genes, const parameters::Parameters& parameters);

/// Radius and mass of the body grown from a chromosome, px and kg.
struct BodyShape {
    float radius_px, mass_kg;
};
BodyShape body_shape(float body_size_gene, const parameters::Parameters& parameters);

/// What organisms are called in the state hash.
constexpr std::uint32_t organism_hash_kind = 1;
/// What an organism adds to the state hash; for many at once, organism_kernels().hash.
base::StateHash hash_of_organism(const physics::Circles& bodies, const Living& living, std::size_t body);

/// What became of each organism that was born, by id.
struct Fate {
    std::vector<std::uint32_t> lived_ticks; // until death; 0 for the living
    std::vector<CauseOfDeath> cause;
    std::vector<std::uint32_t> food_eaten, poison_eaten;

    void begin_generation(std::size_t organisms);
    friend bool operator==(const Fate&, const Fate&) = default;
};

} // namespace evod::simulation
