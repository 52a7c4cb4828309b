// Organism kernels: what every organism does in every tick, several organisms at once.
//
// Determinism  per organism; compiled for two sets of instructions, with the same bits (base/instructions.h).
#pragma once

#include <cstddef>
#include <cstdint>

namespace evod::simulation {

/// What organisms know of the items of one kind; see Sight.
struct ViewColumns {
    float* others;       // px
    std::int32_t *x, *y; // of the nearest item
    const float* radius; // px; how far organisms see
    float item_radius;   // px
};

/// Columns by body index, padded to whole lanes; of void bodies too (physics::Circles).
struct OrganismColumns {
    const std::int32_t *x, *y;
    const float *velocity_x, *velocity_y;
    const float* body_radius;
    const std::uint32_t* id;
    float* health; // −infinity for void bodies
    const float *loss_per_tick, *normal_speed, *impulse;
    std::int32_t *seen_x, *seen_y; // where the organism was when its views were last brought up to date
    ViewColumns food, poison;
};

struct ChoiceRules {
    bool always_flee;
    float lookahead_s;
    float certain_impulse;
    float force_per_unit;
    std::uint32_t pair_counter, pair_key; // of base::RandomKey, for the tick
};

/// Indices found in a range, in rising order; room for as many as the range holds.
struct FoundIndices {
    std::uint32_t* indices;
    std::size_t count = 0;
};

/// What an organism does in a tick; the numbers are those of the protocol.
enum class Choice : std::uint8_t { None, Wander, Seek, Flee };

struct HashWords {
    std::uint64_t low, high;
};

struct OrganismKernels {
    // begin is a multiple of physics::lanes_max; up to lanes_max − 1 void bodies beyond `end` are gone through too.

    /// Those whose view is not good any more: others < 0.
    void (*find_stale)(const float* others, std::size_t begin, std::size_t end, FoundIndices& stale);
    /// The loss of health that living costs; then the choice, from views that are good: see behaviour.h.
    /// force_x, force_y  of the organisms from `begin` on, padded; kg px/s².
    void (*choose)(const OrganismColumns& columns, std::size_t begin, std::size_t end, const ChoiceRules& rules,
                   float* force_x, float* force_y);
    /// The same choice without the loss, and which it was: nothing is changed.
    /// choices  as the forces; a Choice each.
    void (*foretell)(const OrganismColumns& columns, std::size_t begin, std::size_t end, const ChoiceRules& rules,
                     float* force_x, float* force_y, std::int32_t* choices);
    /// Brings views up to date with where the organisms now are: their `others` become less by the way since, and −1
    /// where the nearest item may be another. Finds who may touch items: all that do, and others.
    void (*follow)(const OrganismColumns& columns, std::size_t begin, std::size_t end, FoundIndices& at_food,
                   FoundIndices& at_poison);
    /// The sum of base::hash_of() of the living, and those of them whose health is at most 0.
    HashWords (*hash)(const OrganismColumns& columns, std::uint32_t kind, std::size_t begin, std::size_t end,
                      FoundIndices& dying);
};

/// Those for the instructions in use.
const OrganismKernels& organism_kernels();

} // namespace evod::simulation
