// Experiment files: a JSON object of parameters by name, with optional "seed" and "description". Instead of a value a
// parameter may have an object of values by generation: "mutation_chance": {"1": 0.2, "30": 0.05}.
#pragma once

#include "client/ctl/registry.h"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace evod::ctl {

struct ExperimentFile {
    std::vector<v1::ParameterAssignment> parameters; // of generation 1
    std::vector<v1::ScheduledValue> schedule;        // of later ones
    std::optional<std::uint64_t> seed;
    std::string description;
};

/// As the server reads such a file: reference_population follows population_size where the file names only that.
Checked<ExperimentFile> parse_experiment(std::string_view text, const Registry& registry);

} // namespace evod::ctl
