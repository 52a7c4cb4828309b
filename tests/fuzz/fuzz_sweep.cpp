// Parses any text as a sweep file. The result must be valid cells with an end, the same each time, or a refusal.
#include "server/experiments/sweep_file.h"

#include <cstdlib>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace evod;
    const std::string_view text{reinterpret_cast<const char*>(data), size};
    const experiments::LoadExperiment load = [](const std::string& path) -> base::Result<parameters::Experiment> {
        if (path == "../default.json") {
            return parameters::Experiment{};
        }
        return refusal(base::RefusalCode::NotFound, path + ": there is none");
    };
    const auto sweep = experiments::parse_sweep(text, load);
    if (!sweep) {
        const base::Refusal refused = sweep.error();
        if (refused.message.empty() || refused.violations.size() > experiments::violations_max) {
            std::abort();
        }
        return 0;
    }
    if (sweep->cells.empty() || sweep->replicates == 0 || sweep->run_count() > experiments::Sweep::runs_max) {
        std::abort();
    }
    for (std::size_t cell = 0; cell < sweep->cells.size(); ++cell) {
        const parameters::Parameters parameters = sweep->parameters_of(cell);
        if (!validate(parameters).empty()) {
            std::abort();
        }
        if (parameters.generation_limit == 0 && parameters.stagnation_limit == 0 &&
            !parameters.stop_at_target_fitness && !parameters.stop_at_extinction) {
            std::abort();
        }
        for (std::size_t i = 0; i < sweep->swept.size(); ++i) { // the value in the table
            if (sweep->swept[i]->get(parameters) != sweep->cells[cell][i]) {
                std::abort();
            }
        }
    }
    const auto again = experiments::parse_sweep(text, load);
    if (!again || again->cells != sweep->cells) {
        std::abort();
    }
    return 0;
}
