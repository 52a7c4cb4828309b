#include "server/evolution/termination.h"

#include "server/base/assert.h"

#include <cmath>

namespace evod::evolution {

Progress advance(Progress progress, const GenerationResult& result) {
    EVOD_ASSERT(std::isfinite(result.best_fitness));
    const bool improved = progress.generations == 0 || result.best_fitness > progress.best_fitness;
    return {.generations = progress.generations + 1,
            .stagnant = improved ? 0 : progress.stagnant + 1,
            .best_fitness = improved ? result.best_fitness : progress.best_fitness,
            .last_best_fitness = result.best_fitness,
            .last_died_out = result.died_out};
}

bool has_died_out(const LivingSpecies& living, const Parameters& parameters) {
    return living.prey == 0 || (parameters.stop_at_extinction && living.predators_have_come && living.predators == 0);
}

Outcome outcome(const Progress& progress, const Parameters& parameters, bool has_births) {
    if (progress.generations == 0) {
        return Outcome::Running;
    }
    if (parameters.stop_at_target_fitness && progress.last_best_fitness >= parameters.target_fitness) {
        return Outcome::TargetFitness;
    }
    if ((parameters.stop_at_extinction || has_births) && progress.last_died_out) {
        return Outcome::Extinction;
    }
    if (parameters.stagnation_limit > 0 && progress.stagnant >= parameters.stagnation_limit) {
        return Outcome::Stagnation;
    }
    if (parameters.generation_limit > 0 && progress.generations >= parameters.generation_limit) {
        return Outcome::GenerationLimit;
    }
    return Outcome::Running;
}

} // namespace evod::evolution
