// Comparison report: formats the results of `evod compare` as tables and sentences for the terminal.
//
// Threads  none.
#pragma once

#include "server/experiments/comparison.h"
#include "server/experiments/comparison_plan.h"

#include <span>
#include <string>
#include <vector>

namespace evod::commands {

/// Returns the number of decimals with which a table shows mean fitnesses, depending on the largest of them, or
/// numbers of intervals of worlds with births.
int decimals_for(std::span<const std::vector<experiments::Course>> courses);

/// The fitness of an arm over its replicates.
struct Rise {
    double first = 0, last = 0;     // mean fitness of the first and of the last generation
    double mean = 0;                // mean rise
    experiments::Interval interval; // 95 % confidence interval of the mean rise
    std::size_t extinct = 0;        // number of generations in which all organisms died
};
Rise rise_of_arm(const experiments::Arm& arm, std::span<const experiments::Course> courses);

/// Formats a table with the rise in mean fitness of every arm, that is, of each compared world; of worlds with births,
/// with their persistence.
///
/// courses  shape (arms, replicates).
std::string outcomes_text(const experiments::ComparisonPlan& plan,
                          std::span<const std::vector<experiments::Course>> courses, int decimals);
/// Formats a table that compares the first arm with every other arm.
///
/// findings  shape (arms − 1).
std::string findings_text(const experiments::ComparisonPlan& plan, std::span<const experiments::Finding> findings,
                          int decimals);
/// Formats the conclusions of the comparison, one line each.
std::string conclusions_text(const experiments::ComparisonPlan& plan,
                             std::span<const std::vector<experiments::Course>> courses,
                             std::span<const experiments::Finding> findings, int decimals);

} // namespace evod::commands
