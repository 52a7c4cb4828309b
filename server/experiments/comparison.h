// Comparison: runs several worlds with the same seeds and tests whether they differ: worlds whose generations are bred,
// in their rises in fitness; worlds with births, in the numbers of intervals for which their species live.
//
// Each compared world is an arm; each seed is a replicate. The rise of a run is the mean fitness of its organisms in
// the last generation minus the mean fitness in the first one. With the same seed, all arms begin with the same
// organisms, unless an arm changes how organisms are created. So the test pairs the runs by seed.
//
// Threads      `jobs` threads share the runs; each thread does one run at a time (trials.h).
// Determinism  the same arms, seed and counts give the same numbers to the last bit, for any value of `jobs`.
#pragma once

#include "server/base/random.h"
#include "server/experiments/paired_test.h"
#include "server/experiments/persistence.h"
#include "server/parameters/model_parameters.h"
#include "server/parameters/schedule.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace evod::experiments {

/// One of the worlds that are compared.
struct Arm {
    std::string name;
    parameters::Parameters parameters;  // valid; generation_limit is the only termination criterion
    parameters::Schedule schedule = {}; // a schedule in which faults_of() finds no faults
};

/// The fitness in one generation of a run, over all islands.
struct GenerationFitness {
    double mean = 0, best = 0;
    std::uint64_t organism_count = 0, alive_count = 0;
    SpeciesOfInterval species = {}; // only of worlds with births
    friend bool operator==(const GenerationFitness&, const GenerationFitness&) = default;
};
/// One run, by generation; the first element is generation 1. A course of a world with births ends with the prey.
using Course = std::vector<GenerationFitness>;

double rise_of(const Course& course);
/// The species of a course of a world with births.
std::vector<SpeciesOfInterval> species_of(const Course& course);
/// What is compared: rise_of(), or intervals_lived() of a course of a world with births.
double outcome_of(const Course& course);

struct RunsWanted {
    base::Seed seed;
    std::uint32_t replicates = 20;                              // >= 2
    std::size_t jobs = 1;                                       // >= 1
    std::function<void(double share)> progress = [](double) {}; // called by several threads, but never at the same time
    std::function<bool()> stopped = [] { return false; };       // called by several threads at the same time
};

/// Runs every arm with every seed.
///
/// returns  shape (arms, replicates); each element has generation_limit generations, or fewer of a world with births
///          without prey. nullopt after stopped() returned true.
std::optional<std::vector<std::vector<Course>>> run_arms(std::span<const Arm> arms, const RunsWanted& wanted);

/// The difference between the first arm and one other arm.
struct Finding {
    std::vector<double> differences; // by replicate: outcome_of() the first arm minus that of the other arm
    double mean = 0;
    Interval interval;                 // 95 % confidence interval of the mean difference
    std::optional<double> effect_size; // result of hedges_g()
    double p = 1;                      // result of sign_flip_p()
    double adjusted_p = 1;             // p adjusted for the number of tests (Holm)
};

/// Compares the first arm with every other arm.
///
/// courses  shape (arms >= 2, replicates >= 2); each element has at least one generation.
/// returns  shape (arms − 1).
std::vector<Finding> find_differences(std::span<const std::vector<Course>> courses, base::Seed seed);

/// The significance level of the tests.
constexpr double significance = 0.05;

enum class Judgement { Above, Below, NotShown, CannotBeShown };
/// Judges a finding. CannotBeShown means that there are too few replicates for this number of tests: even the largest
/// difference could not have an adjusted p below `significance`.
Judgement judge(const Finding& finding, std::size_t tests);

} // namespace evod::experiments
