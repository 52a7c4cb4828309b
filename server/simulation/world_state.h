// World state: the state of a world during a generation, without the parts that can be derived from the generation's
// beginning. A world at the beginning of the generation that restores this state continues the run bit for bit.
//
// It omits data that can be derived from seed, parameters and the bred organisms (bodies, boxes, sizes, chromosomes),
// and caches (near pairs, views of items, the order in memory).
//
// Determinism  columns are in order of id, so equal worlds have equal states, even if they store organisms in different
//              orders.
#pragma once

#include "server/base/column.h"
#include "server/parameters/model_parameters.h"
#include "server/physics/bodies.h"
#include "server/simulation/items.h"
#include "server/simulation/living_organisms.h"
#include "server/simulation/statistics.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace evod::simulation {

struct Moment {
    std::uint64_t tick = 0;            // ticks since the run began
    std::uint64_t generation = 1;      // 1 for the first
    std::uint64_t generation_tick = 0; // ticks since the generation began
    double simulated_s = 0;            // sum of the lengths of all ticks

    friend bool operator==(const Moment&, const Moment&) = default;
};

/// What has happened on the island in this generation so far.
struct IslandCounts {
    std::uint64_t food_eaten = 0, poison_eaten = 0;
    std::uint32_t starved_count = 0, poisoned_count = 0;
    std::uint64_t too_fast_count = 0, speed_limit_count = 0;

    friend bool operator==(const IslandCounts&, const IslandCounts&) = default;
};

/// What has happened in a colony (colony.h) on the island in this generation so far, per species.
struct ColonyCounts {
    std::uint64_t living_sum = 0;                                // living organisms, summed over the ticks
    std::uint32_t first = 0, lowest = 0;                         // living at the beginning; fewest after any tick
    std::uint32_t living = 0;                                    // now
    std::uint32_t born = 0;                                      // children
    std::uint32_t refused = 0;                                   // births refused, because population_max was reached
    std::uint32_t without_room = 0;                              // births refused, because no place was free
    std::uint32_t starved = 0, poisoned = 0, eaten = 0, old = 0; // deaths

    friend bool operator==(const ColonyCounts&, const ColonyCounts&) = default;
};

/// Meals cannot raise health above this value: a meal gives at most 10,000, which is lost to rounding if it is added to
/// so large a float.
constexpr float health_reachable = 0x1p38f;

/// Whether an organism can have these genes, whatever their bounds were when it was born.
bool can_live_with(evolution::ConstGenes genes);
/// Whether these are chromosomes of organisms with bodies, one after the other.
bool are_chromosomes(std::span<const float> genes, std::size_t gene_count);

/// Whether a tick can have left a body, which has x, y, velocity_x and velocity_y, on an island of this size.
template <class Body>
bool can_move(const Body& body, physics::Coordinate width, physics::Coordinate height, float max_speed_px_s) {
    // Every tick limits the speeds at its end, so a greater speed can only be a rounding error.
    const float speed_max = max_speed_px_s * 1.001f;
    return body.x >= 0 && body.x <= width && body.y >= 0 && body.y <= height &&
           body.velocity_x * body.velocity_x + body.velocity_y * body.velocity_y <= speed_max * speed_max;
}

/// The number of entities of each kind on an island at the beginning of a generation. It determines the shape of the
/// island's state, together with the numbers of placed entities.
struct IslandShape {
    std::uint32_t genes = evolution::body_gene_count; // number of genes of each organism
    std::uint32_t organisms = 0;                      // number of organisms that were born
    bool has_bodies = true;                           // if false, the other parts are empty
    bool has_headings = false;                        // whether the controller is network
    bool is_colony = false;                           // whether the state has the parts of colonies
    std::uint32_t crates = 0, food = 0, poison = 0;

    friend bool operator==(const IslandShape&, const IslandShape&) = default;
};

struct IslandState {
    struct Organism {
        physics::Coordinate x = 0, y = 0;
        float velocity_x = 0, velocity_y = 0; // px/s
        float health = 0;
        friend bool operator==(const Organism&, const Organism&) = default;
    };
    struct Crate {
        physics::Coordinate x = 0, y = 0;
        float velocity_x = 0, velocity_y = 0; // px/s
        friend bool operator==(const Crate&, const Crate&) = default;
    };
    /// An organism that was placed or born in this generation.
    struct Placed {
        std::vector<float> genes;
        std::uint32_t tick;                      // it was placed or born after this tick of the generation
        evolution::Parents parents = {~0U, ~0U}; // of a child, the ids of its parents in this generation
        friend bool operator==(const Placed&, const Placed&) = default;
    };
    LifeRecords life_records; // of the organisms that were born, then of those that were placed
    IslandCounts counts;
    std::vector<Placed> placed;                       // in order of id
    std::uint32_t placed_food = 0, placed_poison = 0; // numbers of placed items; they come last in food and poison
    base::Column<Organism> organisms;                 // all zeros for dead organisms; empty if there are no bodies
    base::Column<float> headings;                     // radians, by id; 0 for dead organisms; empty without networks
    std::vector<Crate> crates;
    base::Column<Items::Item> food, poison;
    // The rest only in colonies.
    std::array<ColonyCounts, 2> colony{};          // per species
    std::vector<std::uint32_t> hunts_from;         // by id: tick of the generation; 0 if it handles no prey
    std::array<std::vector<float>, 2> latest_born; // per species, with shuffle_births: the chromosomes of latest births

    friend bool operator==(const IslandState&, const IslandState&) = default;
};

/// What clients have given for the organisms of an island after the last tick of a generation, in order of id.
struct Rating {
    std::vector<double> fitness; // `objectives` numbers of each organism, one organism after another
    // The repaired chromosomes of the rated organisms, one after another; empty: none was repaired.
    std::vector<float> genes = {};
    friend bool operator==(const Rating&, const Rating&) = default;
};

struct WorldState {
    Moment moment;
    parameters::ParameterSet parameters;
    std::vector<IslandState> islands;
    std::vector<GenerationStatistics> ended; // at the end of a generation: one per island; otherwise empty
    // After the last tick of a generation, if its fitness comes from clients: for each island, what clients have given
    // so far. Otherwise empty.
    std::vector<Rating> ratings = {};
};

/// Returns whether a state of the beginning of a generation differs from `begun` only by what commands have placed and
/// removed. Island::check() has accepted both states.
bool differ_only_by_commands(const IslandState& begun, const IslandState& state);

} // namespace evod::simulation
