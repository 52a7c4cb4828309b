// Any text as an expression of an observation: a finite number or none, the same each time, or a refusal.
#include "server/parameters/model_parameters.h"
#include "server/simulation/observation.h"

#include <cmath>
#include <cstdlib>

namespace {

evod::simulation::History two_generations() {
    evod::simulation::History history;
    for (std::uint64_t generation = 1; generation <= 2; ++generation) {
        std::vector<evod::simulation::GenerationStatistics> rows(2);
        for (std::uint32_t island = 0; island < 2; ++island) {
            rows[island].generation = generation;
            rows[island].island = island;
            rows[island].fitness_mean = 3.0 * static_cast<double>(generation) - island;
        }
        history.emplace_back(std::move(rows));
    }
    return history;
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace evod;
    static const parameters::Parameters parameters;
    static const simulation::ObservedColumns columns{parameters};
    static const simulation::History history = two_generations();
    const auto parsed =
        simulation::Observation::parse({reinterpret_cast<const char*>(data), size}, columns, "observe.expressions[0]");
    if (!parsed) {
        const base::Refusal refused = parsed.error();
        if (refused.violations.size() != 1 || refused.violations[0].allowed.empty() ||
            refused.violations[0].got.empty()) {
            std::abort();
        }
        return 0;
    }
    std::uint64_t steps = simulation::Observation::steps_max, steps_again = steps;
    const auto value = parsed->value({history, parameters}, steps);
    if (steps == 0 || (value && !std::isfinite(*value)) || value != parsed->value({history, parameters}, steps_again)) {
        std::abort();
    }
    return 0;
}
