// Living: the living organisms as columns, and the fate of every organism that was born.
#pragma once

#include "server/base/column.h"
#include "server/base/state_hash.h"
#include "server/evolution/chromosome.h"
#include "server/parameters/parameters.h"
#include "server/physics/bodies.h"

#include <cstdint>
#include <vector>

namespace evod::simulation {

enum class CauseOfDeath : std::uint8_t { Alive, Starved, Poisoned, Removed };

/// Element i of every column belongs to the organism with body i; its id is the body's id. Columns are as long as those
/// of physics::Circles, including placeholders of dead organisms (void bodies).
struct Living {
    base::Column<float> health;                     // −infinity for placeholders of dead organisms
    base::Column<float> loss_per_tick;              // health that a tick of life costs
    base::Column<float> normal_speed, impulse;      // gene units
    base::Column<float> food_radius, poison_radius; // px; how far the organism perceives

    void clear();
    /// resize() and put() work like those of physics::Circles.
    void resize(std::size_t size);
    void put(std::size_t body, const evolution::BodyGenes& genes, const parameters::Parameters& parameters);
    /// Works like physics::Circles::reorder().
    void reorder(const physics::Reordering& reordering);
};

/// Returns the limit above which a meal cannot raise health; infinity if there is no limit.
float health_cap(const evolution::BodyGenes& genes, const parameters::Parameters& parameters);

/// The radius and mass of an organism's body, which its gene body_size determines.
struct BodyShape {
    float radius_px, mass_kg;
};
BodyShape body_shape(float body_size_gene, const parameters::Parameters& parameters);

/// The kind of organisms in the state hash.
constexpr std::uint32_t organism_hash_kind = 1;
/// Returns an organism's part of the state hash. organism_kernels().hash computes the parts of many organisms at once.
base::StateHash hash_of_organism(const physics::Circles& bodies, const Living& living, std::size_t body);

/// What happened to each organism that was born, by id.
struct Fate {
    std::vector<std::uint32_t> lived_ticks; // ticks until death; 0 for living organisms
    std::vector<CauseOfDeath> cause;
    std::vector<std::uint32_t> food_eaten, poison_eaten;

    void begin_generation(std::size_t organisms);
    /// Adds a living organism.
    void add();
    friend bool operator==(const Fate&, const Fate&) = default;
};

} // namespace evod::simulation
