// Experiment files: a flat JSON object of parameters by their registry names, with optional "seed" and "description".
#pragma once

#include "server/base/random.h"
#include "server/base/result.h"
#include "server/simulation/parameters.h"

#include <optional>
#include <string>
#include <string_view>

namespace evod::simulation {

struct Experiment {
    Parameters parameters;
    std::optional<base::Seed> seed;
    std::string description;
};

/// Reads the text of an experiment file; what it does not name has its default, but reference_population, which follows
/// population_size. Violations name the field with its line: "mutation_chance (line 4)".
base::Result<Experiment> parse_experiment(std::string_view text);

enum class Written { Differences, Everything }; // from the defaults
/// The parameters as an experiment file, one a line, in registry order.
std::string to_experiment_text(const Parameters& parameters, Written written = Written::Differences);

} // namespace evod::simulation
