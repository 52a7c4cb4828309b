// Termination: when a run is over, and why. None of the criteria holds unless a parameter asks for it.
//
// Owner        World; asked once when a generation has ended.
// Determinism  a function of the generations' best fitness alone; Progress is part of a world's state.
#pragma once

#include "server/evolution/parameters.h"

#include <cstdint>

namespace evod::evolution {

/// What came of a run. The order is that of precedence: if several criteria hold, the first of them is the outcome.
enum class Outcome {
    Running,         // none holds
    TargetFitness,   // an organism reached target_fitness, and stop_at_target_fitness is on
    Extinction,      // everyone on every island died, and stop_at_extinction is on
    Stagnation,      // the best fitness was not beaten for stagnation_limit generations
    GenerationLimit, // generation_limit generations are over
};

/// What the criteria look at, over all islands of a world.
struct Progress {
    std::uint64_t generations = 0; // that are over
    std::uint64_t stagnant = 0;    // since the last that beat best_fitness; 0 if the last one did
    double best_fitness = 0;       // of all generations that are over; without meaning before the first
    double last_best_fitness = 0;  // of the last generation
    bool last_died_out = false;    // whether everyone died in it
    friend bool operator==(const Progress&, const Progress&) = default;
};

/// How the generation that has just ended went, over all islands.
struct GenerationResult {
    double best_fitness; // finite
    bool died_out;       // nobody was alive at the end on any island
};

/// The progress after one more generation. A tie with the best so far is no improvement; the first generation is one.
Progress advance(Progress progress, const GenerationResult& result);

/// The outcome after the last generation of `progress`; Running if none is over yet.
Outcome outcome(const Progress& progress, const Parameters& parameters);

} // namespace evod::evolution
