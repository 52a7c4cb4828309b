// Brain layout: inputs, outputs and weights of the neural networks that steer organisms, made from the parameters.
//
// A network has one hidden layer. Every hidden neuron is connected with every input, and every output with every hidden
// neuron; with brain_bias, each of them is also connected with a constant 1. Its weights are genes, which follow the
// body genes in the chromosome, in this order: for each hidden neuron the weights of its inputs and then its bias; then
// for each output the weights of its hidden neurons and then its bias.
//
// Threads      none; plain data.
#pragma once

#include "server/evolution/brain_input.h"
#include "server/evolution/ga_parameters.h"

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace evod::evolution {

/// The names of the inputs, by BrainInput.
constexpr std::array<std::string_view, brain_inputs_max> brain_input_names = {
    "food_bearing", "food_proximity", "poison_bearing", "poison_proximity", "speed", "health", "wall_proximity"};

/// The shape of the networks of a world. It is empty if the controller is not `network`, or without has_body_genes().
struct BrainLayout {
    std::vector<BrainInput> inputs;
    std::uint32_t hidden_count = 0;
    std::vector<std::string_view> output_names;
    bool has_bias = false;

    std::uint32_t weight_count() const {
        return hidden_count * (static_cast<std::uint32_t>(inputs.size()) + has_bias) +
               static_cast<std::uint32_t>(output_names.size()) * (hidden_count + has_bias);
    }
    friend bool operator==(const BrainLayout&, const BrainLayout&) = default;
};

BrainLayout brain_layout(const Parameters& parameters);

/// The weights of a network as genes.
struct BrainGenes {
    unsigned count = 0; // 0: organisms have no network
    double limit = 0;   // weights stay within ± limit
    double initial = 0; // weights of the first generation are uniform within ± initial
};
BrainGenes brain_genes(const Parameters& parameters);

/// Returns a name for each weight, in chromosome order: "hidden3<food_bearing", "hidden3<bias", "turn<hidden3". The
/// first hidden neuron is hidden1.
std::vector<std::string> brain_gene_names(const Parameters& parameters);

} // namespace evod::evolution
