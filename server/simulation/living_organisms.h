// LivingOrganisms: the living organisms as columns, and the life records of every organism that was born.
#pragma once

#include "server/base/column.h"
#include "server/base/state_hash.h"
#include "server/evolution/chromosome.h"
#include "server/parameters/model_parameters.h"
#include "server/physics/bodies.h"

#include <cstdint>
#include <span>
#include <vector>

namespace evod::simulation {

enum class CauseOfDeath : std::uint8_t { Alive, Starved, Poisoned, Removed, Eaten, Old };
enum class Species : std::uint8_t { Prey, Predator };

/// A heading is at most this far from 0, radians: π, and the error of a tick. The tick adds a turn of up to 629 rad
/// (the maxima of turn_rate_max_deg_s and tick_s), and then subtracts full turns. Rounding the sum to float, the
/// product of up to 100 turns, and float's 2π (2.5e-7 too great) contribute errors of up to 3.1e-5, 3.1e-5 and 2.5e-5.
constexpr float heading_max = 3.14159274f + 1e-4f;

/// Element i of every column belongs to the organism with body i; its id is the body's id. Columns are as long as those
/// of physics::Circles, including placeholders of dead organisms (void bodies).
struct LivingOrganisms {
    base::Column<float> health;                     // −infinity for placeholders of dead organisms
    base::Column<float> loss_per_tick;              // health that a tick of life costs
    base::Column<float> normal_speed, impulse;      // gene units
    base::Column<float> food_radius, poison_radius; // px; how far the organism perceives
    // Only for organisms with a network; otherwise empty.
    base::Column<float> heading;     // radians, −π … π
    base::Column<float> base_health; // gene units
    base::Column<float> weights;     // in the order of BrainColumns::weights
    // Only in colonies; otherwise empty. Ticks are those of the generation.
    base::Column<std::uint32_t> hunts_from; // a predator hunts again from this tick on; 0: it handles no prey
    base::Column<std::uint32_t> dies_in;    // the tick at whose end it dies of age; never_old: it does not

    static constexpr std::uint32_t never_old = ~0U;

    /// Removes all organisms.
    ///
    /// weight_count  the number of weights of each network; 0: the organisms have none.
    /// in_colony     whether there are the columns of colonies.
    void clear(std::uint32_t weight_count = 0, bool in_colony = false);
    bool in_colony() const { return in_colony_; }
    std::uint32_t weight_count() const { return weight_count_; }
    bool has_brains() const { return weight_count_ > 0; }
    /// resize() and put() work like those of physics::Circles.
    void resize(std::size_t size);
    void put(std::size_t body, const evolution::BodyGenes& genes, const parameters::Parameters& parameters);
    void put_brain(std::size_t body, std::span<const float> new_weights, float new_heading);
    void put_weights(std::size_t body, std::span<const float> new_weights);
    /// Returns the memory of the weights. Until clear(), nothing may read or write weights.
    void free_weights() { weights = base::Column<float>{}; }
    /// Returns the index in `weights` of the first weight of an organism; the next one is physics::lanes_max further.
    std::size_t first_weight(std::size_t body) const {
        constexpr std::size_t group = physics::lanes_max;
        return body / group * group * weight_count_ + body % group;
    }
    /// Works like physics::Circles::reorder(), but leaves the weights to put_weights().
    void reorder(const physics::Reordering& reordering);

  private:
    std::uint32_t weight_count_ = 0;
    bool in_colony_ = false;
};

/// Returns the limit above which a meal cannot raise health, > 0; infinity if there is no limit.
float health_cap(const evolution::BodyGenes& genes, const parameters::Parameters& parameters);

/// The radius and mass of an organism's body, which its gene body_size determines.
struct BodyShape {
    float radius_px, mass_kg;
};
BodyShape body_shape(float body_size_gene, const parameters::Parameters& parameters);

/// The kind of organisms in the state hash.
constexpr std::uint32_t organism_hash_kind = 1;
constexpr std::uint32_t heading_hash_kind = 8;
/// Returns an organism's part of the state hash. organism_kernels().hash and brain_kernels().hash compute the parts of
/// many organisms at once.
base::StateHash hash_of_organism(const physics::Circles& bodies, const LivingOrganisms& living, std::size_t body);

/// What happened to each organism that was born, by id.
struct LifeRecords {
    std::vector<std::uint32_t> lived_ticks; // ticks until death; 0 for living organisms
    std::vector<CauseOfDeath> cause;
    std::vector<std::uint32_t> food_eaten, poison_eaten; // a predator's food is prey
    std::vector<std::uint32_t> children;                 // in its whole life; only in colonies (colony.h)

    /// in_colony  whether children are counted.
    void begin_generation(std::size_t organisms, bool in_colony = false);
    /// Adds a living organism.
    void add(bool in_colony = false);
    friend bool operator==(const LifeRecords&, const LifeRecords&) = default;
};

} // namespace evod::simulation
