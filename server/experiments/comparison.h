// Comparison: a world beside others that were run with the same seeds, and what can be told of the difference.
//
// What is compared is the rise: by how much the mean fitness of all organisms of a run rose from its first generation
// to its last. A replicate is a seed; the first generation of a seed has the same organisms in every arm that does not
// change how they are made, so differences are taken seed by seed.
//
// Threads      runs go to a pool, one a thread (trials.h).
// Determinism  the same arms, seed and counts give the same numbers to the last bit, whatever `jobs` is.
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

/// One of the worlds that are compared.
struct Arm {
    std::string name;
    parameters::Parameters parameters;  // valid; generation_limit is the only end they have
    parameters::Schedule schedule = {}; // in which faults_of() finds nothing
};

/// A generation of a run, all its islands together.
struct GenerationFitness {
    double mean = 0, best = 0;
    std::uint64_t organism_count = 0, alive_count = 0;
    friend bool operator==(const GenerationFitness&, const GenerationFitness&) = default;
};
using Course = std::vector<GenerationFitness>; // of one run, from generation 1 on

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
/// returns  shape (arms, replicates), each as many generations long as the arms' generation_limit; nothing if stopped()
///          came true.
std::optional<std::vector<std::vector<Course>>> run_arms(std::span<const Arm> arms, const RunsWanted& wanted);

/// What the world has over another arm.
struct Finding {
    std::vector<double> differences; // its rise less the other's, by replicate
    double mean = 0;
    Interval interval;                 // 95 %, of that mean
    std::optional<double> effect_size; // hedges_g()
    double p = 1;                      // sign_flip_p()
    double adjusted_p = 1;             // for all that the world is compared with
};

/// The first arm against each of the others.
///
/// courses  shape (arms >= 2, replicates >= 2), of at least one generation.
/// returns  shape (arms − 1).
std::vector<Finding> find_differences(std::span<const std::vector<Course>> courses, base::Seed seed);

/// A p-value below this is taken for a difference.
constexpr double significance = 0.05;

enum class Judgement { Above, Below, NotShown, CannotBeShown };
/// CannotBeShown: so few replicates, among `tests` tests, that no difference whatever could come below `significance`.
Judgement judge(const Finding& finding, std::size_t tests);

} // namespace evod::experiments
