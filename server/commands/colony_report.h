// Colony report: formats how the species of worlds with births persisted, for `evod run` and `evod compare`.
//
// Threads  none.
#pragma once

#include "server/experiments/comparison.h"
#include "server/experiments/comparison_plan.h"
#include "server/experiments/persistence.h"

#include <boost/json/object.hpp>

#include <cstdio>
#include <span>
#include <string>
#include <vector>

namespace evod::commands {

/// One line for each species that came in a run.
std::string persistence_text(std::span<const experiments::SpeciesOfInterval> intervals);
/// The same for programs: an object with one member for each species.
boost::json::object persistence_object(std::span<const experiments::SpeciesOfInterval> intervals);

/// How one species persisted in the replicates of an arm.
struct ArmPersistence {
    std::size_t runs = 0, extinct = 0; // runs in which it came, and in which it then died out
    // Means over the runs in which it came; the lowest number of all of them.
    double count_mean = 0, count_deviation = 0, born_mean = 0;
    std::uint64_t lowest_count = 0;
};
ArmPersistence persistence_of_arm(std::span<const experiments::Course> courses, std::size_t species);

/// Formats a table with the persistence of every arm of a comparison of worlds with births.
///
/// courses  shape (arms, replicates).
std::string persistence_table(const experiments::ComparisonPlan& plan,
                              std::span<const std::vector<experiments::Course>> courses);
/// Formats the conclusions about the controls of a world with births, one line each.
///
/// findings  shape (arms − 1).
std::string persistence_verdict(const experiments::ComparisonPlan& plan,
                                std::span<const std::vector<experiments::Course>> courses,
                                std::span<const experiments::Finding> findings);

/// Returns a text as std::snprintf() formats it.
template <class... Values>
std::string formatted(const char* format, Values... values) {
    std::string text(static_cast<std::size_t>(std::snprintf(nullptr, 0, format, values...)), '\0');
    std::snprintf(text.data(), text.size() + 1, format, values...);
    return text;
}
/// The width of the column of names in the tables of a comparison.
int name_width_of(const experiments::ComparisonPlan& plan);

} // namespace evod::commands
