// Comparison: runs several worlds with the same seeds and tests the differences of their rises.
//
// The rise of a run is the mean fitness of its organisms in the last generation minus that in the first. A replicate is
// a seed. The first generation of a seed has the same organisms in every arm that does not change how organisms are
// made, so the test pairs the runs by seed.
//
// Threads      runs are distributed to `jobs` threads, one run per thread at a time (trials.h).
// Determinism  the same arms, seed and counts give the same numbers to the last bit, for any `jobs`.
#pragma once

#include "server/base/random.h"
#include "server/experiments/paired_test.h"
#include "server/parameters/parameters.h"
#include "server/parameters/schedule.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace evod::experiments {

/// A world to compare.
struct Arm {
    std::string name;
    parameters::Parameters parameters;  // valid; generation_limit is their only termination criterion
    parameters::Schedule schedule = {}; // in which faults_of() finds nothing
};

/// A generation of a run, over all islands.
struct GenerationFitness {
    double mean = 0, best = 0;
    std::uint64_t organism_count = 0, alive_count = 0;
    friend bool operator==(const GenerationFitness&, const GenerationFitness&) = default;
};
using Course = std::vector<GenerationFitness>; // of one run, by generation from 1

double rise_of(const Course& course);

struct RunsWanted {
    base::Seed seed;
    std::uint32_t replicates = 20;                              // >= 2
    std::size_t jobs = 1;                                       // >= 1
    std::function<void(double share)> progress = [](double) {}; // called from several threads, one at a time
    std::function<bool()> stopped = [] { return false; };       // called from several threads at once
};

/// Runs every arm with every seed.
///
/// returns  shape (arms, replicates), each with generation_limit generations; nullopt after stopped() returned true.
std::optional<std::vector<std::vector<Course>>> run_arms(std::span<const Arm> arms, const RunsWanted& wanted);

/// The difference between the first arm and another.
struct Finding {
    std::vector<double> differences; // rise of the first arm minus rise of the other, by replicate
    double mean = 0;
    Interval interval;                 // 95 %, of the mean difference
    std::optional<double> effect_size; // hedges_g()
    double p = 1;                      // sign_flip_p()
    double adjusted_p = 1;             // for the number of tests (Holm)
};

/// Compares the first arm with each other.
///
/// courses  shape (arms >= 2, replicates >= 2), of at least one generation.
/// returns  shape (arms − 1).
std::vector<Finding> find_differences(std::span<const std::vector<Course>> courses, base::Seed seed);

/// The significance level of the tests.
constexpr double significance = 0.05;

enum class Judgement { Above, Below, NotShown, CannotBeShown };
/// CannotBeShown: there are too few replicates for `tests` tests: no difference could have an adjusted p below
/// `significance`.
Judgement judge(const Finding& finding, std::size_t tests);

} // namespace evod::experiments
