// Organism kernels: the steps of every tick for several organisms at once.
//
// Determinism  each organism is computed independently. The kernels are compiled for several sets of instructions,
//              which give the same bits (base/instructions.h).
#pragma once

#include "server/simulation/items_kernels.h"

#include <cstddef>
#include <cstdint>

namespace evod::simulation {

/// What organisms know about the items of one kind: their views, which perception.h describes.
struct ViewColumns {
    float* others;       // every item except the nearest is at least this far away, px
    std::int32_t *x, *y; // position of the nearest item
    const float* radius; // px; how far organisms perceive
    float item_radius;   // px
};

/// The columns of organisms, by the index of the body (physics::Circles). They include placeholders of dead organisms,
/// and are padded to full vectors. Columns that a kernel does not read may be nullptr.
struct OrganismColumns {
    const std::int32_t *x, *y;
    const float *velocity_x, *velocity_y;
    const float* body_radius = nullptr;
    const std::uint32_t* id;
    float* health; // −infinity for placeholders of dead organisms
    const float *loss_per_tick = nullptr, *normal_speed, *impulse = nullptr;
    std::int32_t *seen_x = nullptr, *seen_y = nullptr; // where the organism was when its views were last updated
    ViewColumns food{}, poison{};
    // With predators: all bits set if the poison seen is a predator, from which an organism may always flee; else 0.
    const std::int32_t* is_hunted = nullptr;
};

struct ChoiceRules {
    bool always_flee;
    float lookahead_s;
    float certain_impulse;
    float force_per_unit;
    std::uint32_t pair_counter, pair_key; // counter and key of base::RandomKey::pair(), for the tick
};

/// Indices found in a range, in ascending order; has room for the whole range.
struct FoundIndices {
    std::uint32_t* indices;
    std::size_t count = 0;
};

/// What an organism does in a tick. The protocol uses the same numbers.
enum class Choice : std::uint8_t { None, Wander, Seek, Flee, Steer };

struct HashWords {
    std::uint64_t low, high;
};

struct OrganismKernels {
    // Kernels process whole vectors: `begin` must be a multiple of physics::lanes_max, and up to lanes_max − 1 elements
    // after `end`, which are padding, are processed too.

    /// Finds the organisms whose view is stale, which means that their element of `others` is negative.
    void (*find_stale)(const float* others, std::size_t begin, std::size_t end, FoundIndices& stale);
    /// Updates the views of the organisms of [0, end), which are at x, y, after items have changed. A view becomes
    /// stale if another item may now be the nearest.
    void (*notice)(const std::int32_t* x, const std::int32_t* y, const ViewColumns& view, const ItemChange* changes,
                   std::size_t change_count, std::size_t end);
    /// Subtracts the health that a tick costs, and chooses forces by the rules of behaviour.h. Views must not be stale.
    /// force_x, force_y  forces on the organisms from `begin` on, padded; kg px/s². Element 0 is for organism `begin`.
    void (*choose)(const OrganismColumns& columns, std::size_t begin, std::size_t end, const ChoiceRules& rules,
                   float* force_x, float* force_y);
    /// Makes the same choice as choose(), but does not subtract health, and also reports the choice.
    /// choices  receives one Choice per organism, indexed like the forces.
    void (*predict)(const OrganismColumns& columns, std::size_t begin, std::size_t end, const ChoiceRules& rules,
                    float* force_x, float* force_y, std::int32_t* choices);
    /// Updates views to the present positions of the organisms: their `others` are reduced by the distance moved, and
    /// become −1 if another item may now be the nearest. Finds the organisms that may touch items: every organism that
    /// does, and some that do not.
    void (*follow)(const OrganismColumns& columns, std::size_t begin, std::size_t end, FoundIndices& at_food,
                   FoundIndices& at_poison);
    /// Returns the sum of base::hash_of() over the organisms that are not void. Finds, among them, the organisms whose
    /// health is at most 0.
    HashWords (*hash)(const OrganismColumns& columns, std::uint32_t kind, std::size_t begin, std::size_t end,
                      FoundIndices& dying);
};

/// Returns the kernels for the instruction set in use (base/instructions.h).
const OrganismKernels& organism_kernels();

} // namespace evod::simulation
