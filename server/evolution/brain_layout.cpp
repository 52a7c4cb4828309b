#include "server/evolution/brain_layout.h"

#include "server/evolution/gene_layout.h"

#include <span>

namespace evod::evolution {

BrainLayout brain_layout(const Parameters& p) {
    if (p.controller == Controller::Rules || !has_body_genes(p)) {
        return {};
    }
    BrainLayout layout{.inputs = {},
                       .hidden_count = p.brain_hidden,
                       .output_names = {p.locomotion == Locomotion::Kinematic ? "acceleration" : "thrust", "turn"},
                       .has_bias = p.brain_bias};
    const auto add = [&](bool wanted, BrainInput input) {
        if (wanted) {
            layout.inputs.push_back(input);
        }
    };
    add(p.sense_food, BrainInput::FoodBearing);
    add(p.sense_food && !p.sense_bearing_only, BrainInput::FoodProximity);
    add(p.sense_poison, BrainInput::PoisonBearing);
    add(p.sense_poison && !p.sense_bearing_only, BrainInput::PoisonProximity);
    add(p.sense_speed, BrainInput::Speed);
    add(p.sense_health, BrainInput::Health);
    add(p.sense_wall, BrainInput::WallProximity);
    return layout;
}

BrainGenes brain_genes(const Parameters& p) {
    return {brain_layout(p).weight_count(), p.brain_weight_limit, p.brain_weight_initial};
}

std::vector<std::string> brain_gene_names(const Parameters& p) {
    const BrainLayout layout = brain_layout(p);
    std::vector<std::string> inputs, hidden;
    for (const BrainInput input : layout.inputs) {
        inputs.emplace_back(brain_input_names[static_cast<std::size_t>(input)]);
    }
    for (std::uint32_t neuron = 1; neuron <= layout.hidden_count; ++neuron) {
        hidden.push_back("hidden" + std::to_string(neuron));
    }
    std::vector<std::string> names;
    const auto add_neuron = [&](const std::string& neuron, std::span<const std::string> sources) {
        for (const std::string& source : sources) {
            names.push_back(neuron + "<" + source);
        }
        if (layout.has_bias) {
            names.push_back(neuron + "<bias");
        }
    };
    for (const std::string& neuron : hidden) {
        add_neuron(neuron, inputs);
    }
    for (const std::string_view output : layout.output_names) {
        add_neuron(std::string{output}, hidden);
    }
    return names;
}

} // namespace evod::evolution
