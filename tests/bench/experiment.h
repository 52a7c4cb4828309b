// The experiments that benchmarks run: files of experiments/, at any population.
#pragma once

#include "server/parameters/experiment.h"

#include <cstdint>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>

namespace evod::bench {

/// The parameters of experiments/NAME.json; throws if there is no such file.
inline parameters::Parameters experiment(const std::string& name) {
    const std::string path = EVOD_EXPERIMENTS "/" + name + ".json";
    std::ifstream file{path};
    if (!file) {
        throw std::runtime_error{"cannot read " + path};
    }
    std::ostringstream text;
    text << file.rdbuf();
    return parameters::parse_experiment(text.str()).value().parameters;
}

/// The benchmark world: 46,080 px², 2.5 food and 1.5 poison to each organism.
inline parameters::Parameters bench_world(std::uint32_t organisms) {
    parameters::Parameters parameters = experiment("bench");
    parameters.population_size = organisms;
    return parameters;
}

/// The benchmark world with organisms that are steered by networks of 5-8-2: bearing and proximity of food and poison
/// and the bias, eight hidden neurons, two outputs.
inline parameters::Parameters bench_world(std::uint32_t organisms, evolution::Locomotion locomotion) {
    parameters::Parameters parameters = bench_world(organisms);
    parameters.controller = evolution::Controller::Network;
    parameters.brain_hidden = 8;
    parameters.locomotion = locomotion;
    return parameters;
}

} // namespace evod::bench
