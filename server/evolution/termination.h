// Termination: when a run is over, and why. Every criterion is off unless a parameter turns it on.
//
// Owner        World; called once at the end of each generation.
// Determinism  the outcome depends only on Progress, which is part of a world's state, and on the parameters.
#pragma once

#include "server/evolution/ga_parameters.h"

#include <cstdint>

namespace evod::evolution {

/// The outcome of a run, in order of precedence: if several criteria hold, the first of them is the outcome.
enum class Outcome {
    Running,         // no criterion holds
    TargetFitness,   // an organism reached target_fitness, and stop_at_target_fitness is on
    Extinction,      // the last generation died out, and stop_at_extinction is on or the world has births
    Stagnation,      // stagnation_limit generations did not improve the best fitness
    GenerationLimit, // generation_limit generations are over
};

/// The input of the criteria, over all islands of a world.
struct Progress {
    std::uint64_t generations = 0; // ended generations
    std::uint64_t stagnant = 0;    // generations since the last one that improved best_fitness; 0 if the last one did
    double best_fitness = 0;       // best fitness of all ended generations; meaningless before the first has ended
    double last_best_fitness = 0;  // best fitness of the last ended generation
    bool last_died_out = false;    // GenerationResult::died_out of it
    friend bool operator==(const Progress&, const Progress&) = default;
};

/// The result of the generation that has just ended, over all islands.
struct GenerationResult {
    double best_fitness; // finite
    bool died_out;       // no organism was alive at the end, on any island; with births: has_died_out()
};

/// The organisms of a world with births that are alive at the end of an interval, on all islands.
struct LivingSpecies {
    std::uint64_t prey = 0, predators = 0;
    bool predators_have_come = false; // whether the world has had predators
};

/// Returns whether a world with births has died out: no prey is alive; or, if stop_at_extinction is on, no predator is
/// alive any more.
bool has_died_out(const LivingSpecies& living, const Parameters& parameters);

/// Returns the progress after one more generation. Only a fitness above the best so far is an improvement, except that
/// the first generation always counts as one.
Progress advance(Progress progress, const GenerationResult& result);

/// Returns the outcome after the last generation of `progress`; Running if no generation has ended yet.
///
/// has_births  whether the world has births; no generation is then bred after one that died out.
Outcome outcome(const Progress& progress, const Parameters& parameters, bool has_births = false);

} // namespace evod::evolution
