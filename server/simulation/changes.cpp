#include "server/simulation/changes.h"

#include <utility>

namespace evod::simulation {

void Changes::add(std::uint64_t generation, base::Actor by, const parameters::RequestedParameters& before,
                  const parameters::RequestedParameters& after) {
    Change change{.generation = generation, .by = std::move(by), .values = {}};
    for (const parameters::ParameterDescription* parameter :
         parameters::parameters_that_differ(before.values, after.values)) {
        if (parameter->effect != base::Effect::Reset) {
            change.values.push_back(
                {std::string{parameter->name}, parameter->get(before.values), parameter->get(after.values)});
        }
    }
    if (change.values.empty()) {
        return;
    }
    value_count_ += change.values.size();
    all_.push_back(std::move(change));
    while (value_count_ > values_kept) {
        value_count_ -= all_.front().values.size();
        all_.pop_front();
    }
}

} // namespace evod::simulation
