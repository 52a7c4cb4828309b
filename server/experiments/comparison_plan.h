// Comparison plan: derives the worlds of a comparison from experiment files and changes.
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
    // Paths of experiment files; empty: the default world. With `controls`, there is at most one path.
    std::vector<std::string> experiments = {};
    bool controls = false;
    /// Number of generations, >= 2. nullopt: the generation_limit of the first experiment, or default_generations.
    std::optional<std::uint32_t> generations = {};
    std::optional<std::uint64_t> seed = {}; // nullopt: the seed of the first experiment, or drawn_seed
    base::Seed drawn_seed = {};
    std::vector<std::string> changes = {}; // texts of the form "name=value", applied to all experiments
};
constexpr std::uint32_t default_generations = 60;

struct ComparisonPlan {
    std::vector<Arm> arms; // the worlds to run; the first is compared with all others
    // The controls of the first arm, including those that need no run; empty: different experiments are compared.
    std::vector<Control> controls;
    base::Seed seed;
    std::uint32_t generations;

    /// Whether the worlds have births; either all arms have, or none.
    bool has_births() const { return parameters::has_births(arms[0].parameters); }
};

/// Loads and validates the experiments, and creates their controls.
base::Result<ComparisonPlan> plan_comparison(const ComparisonRequest& request);

/// Writes the fitness of every run and generation as CSV.
///
/// courses  as run_arms() returns them for the arms of the plan.
void write_courses(std::ostream& out, const ComparisonPlan& plan, std::span<const std::vector<Course>> courses);

/// Writes the data of a plot as CSV: the mean fitness over the replicates, by arm and generation, with its 95 %
/// confidence interval; of worlds with births, the mean number of prey in the place of the mean fitness.
void write_curves(std::ostream& out, const ComparisonPlan& plan, std::span<const std::vector<Course>> courses);

} // namespace evod::experiments
