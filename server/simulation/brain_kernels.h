// Brain kernels: the networks of several organisms at once, from what they sense to what they do.
//
// A network has one hidden layer; evolution/brain_layout.h states its inputs and the order of its weights. A neuron is
// tanh of the sum of its weighted inputs, which are added in the order of the weights.
//
// Determinism  each organism is computed independently. The kernels are compiled for several sets of instructions,
//              which give the same bits (base/instructions.h).
#pragma once

#include "server/evolution/brain_input.h"
#include "server/simulation/organism_kernels.h"

namespace evod::simulation {

/// The columns that only organisms with a network have, by the index of the body.
struct BrainColumns {
    // For each group of lanes_max organisms, one row of lanes_max elements per weight: weight w of organism
    // lanes_max · g + k is element (weight_count · g + w) · lanes_max + k.
    const float* weights;
    float* heading; // radians, −π … π
    const float* base_health;
};

struct SteeringRules {
    const evolution::BrainInput* inputs;
    std::uint32_t input_count, hidden_count, weight_count;
    bool has_bias;
    bool is_kinematic;
    float force_per_unit;       // newtonian: kg px/s² per gene unit
    float speed_change;         // kinematic: px/s per tick at the output 1
    float turn;                 // radians per tick at the output 1
    float max_speed;            // px/s
    std::int32_t width, height; // size of the area, units
};

struct BrainKernels {
    // Kernels process whole vectors: `begin` must be a multiple of physics::lanes_max, and up to lanes_max − 1 elements
    // after `end`, which are padding, are processed too.

    /// Subtracts the health that a tick costs, turns the organisms, and computes what they do. Views must not be stale.
    /// out_x, out_y  newtonian: the force on each organism, kg px/s²; kinematic: its new velocity, px/s. Padded;
    ///               element 0 is for organism `begin`.
    void (*steer)(const OrganismColumns& columns, const BrainColumns& brains, std::size_t begin, std::size_t end,
                  const SteeringRules& rules, float* out_x, float* out_y);
    /// Computes the same as steer(), but does not change health and headings.
    ///
    /// neurons  receives the inputs, hidden neurons and outputs of the networks: neuron n of organism begin + k is
    ///          element n · lanes_max + k. At most lanes_max organisms then. May be nullptr.
    void (*predict)(const OrganismColumns& columns, const BrainColumns& brains, std::size_t begin, std::size_t end,
                    const SteeringRules& rules, float* out_x, float* out_y, float* neurons);
    /// Returns the sum of hash_of_heading() over the organisms that are not void.
    HashWords (*hash)(const OrganismColumns& columns, const float* heading, std::uint32_t kind, std::size_t begin,
                      std::size_t end);
};

/// Returns the kernels for the instruction set in use (base/instructions.h).
const BrainKernels& brain_kernels();

} // namespace evod::simulation
