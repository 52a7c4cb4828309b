// Parses any text as an experiment file. The result must be valid parameters that survive writing and reading, or a
// refusal.
#include "server/parameters/experiment.h"

#include <cstdlib>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace evod::parameters;
    const auto experiment = parse_experiment({reinterpret_cast<const char*>(data), size});
    if (!experiment) {
        return 0;
    }
    if (!validate(experiment->parameters).empty()) {
        std::abort();
    }
    const auto again =
        parse_experiment(to_experiment_text(experiment->parameters, Written::Differences, experiment->schedule));
    if (!again || !(again->parameters == experiment->parameters) || again->schedule != experiment->schedule) {
        std::abort();
    }
    const auto alone = parse_schedule(to_schedule_text(experiment->schedule));
    if (!alone || *alone != experiment->schedule || !faults_of(*alone, experiment->parameters).empty()) {
        std::abort();
    }
    return 0;
}
