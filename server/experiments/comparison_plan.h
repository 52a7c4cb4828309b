// Comparison plan: the worlds that a comparison runs, from experiment files and changes to them.
#pragma once

#include "server/base/result.h"
#include "server/experiments/comparison.h"
#include "server/experiments/controls.h"

#include <cstdint>
#include <iosfwd>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace evod::experiments {

struct ComparisonRequest {
    std::vector<std::string> experiments = {}; // paths; with controls at most one, empty: the default world
    bool controls = false;
    /// >= 2; nullopt: generation_limit of the first, or default_generations.
    std::optional<std::uint32_t> generations = {};
    std::optional<std::uint64_t> seed = {}; // nullopt: the seed of the first experiment, or drawn_seed
    base::Seed drawn_seed = {};
    std::vector<std::string> changes = {}; // "name=value", made to all experiments
};
constexpr std::uint32_t default_generations = 60;

struct ComparisonPlan {
    std::vector<Arm> arms; // to run; the first is the world that the others are compared with
    std::vector<Control>
        controls; // of the first arm, also those that need no run; empty: other experiments are compared
    base::Seed seed;
    std::uint32_t generations;
};

/// Loads and validates the experiments, and makes their controls.
base::Result<ComparisonPlan> plan_comparison(const ComparisonRequest& request);

/// Writes the fitness of every run and generation as CSV.
///
/// courses  as run_arms() returns them for the arms of the plan.
void write_courses(std::ostream& out, const ComparisonPlan& plan, std::span<const std::vector<Course>> courses);

/// Writes the mean fitness over the replicates by arm and generation, with its 95 % confidence interval, as CSV: the
/// data of a plot.
void write_curves(std::ostream& out, const ComparisonPlan& plan, std::span<const std::vector<Course>> courses);

} // namespace evod::experiments
