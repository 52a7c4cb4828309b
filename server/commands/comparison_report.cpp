#include "server/commands/comparison_report.h"

#include "server/commands/colony_report.h"
#include "server/experiments/verdict.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

namespace evod::commands {
namespace {

using namespace experiments;

std::string interval_text(const Interval& interval, int decimals) {
    return signed_text(interval.low, decimals) + " to " + signed_text(interval.high, decimals);
}

std::vector<double> rises_of(std::span<const Course> courses) {
    std::vector<double> rises;
    for (const Course& course : courses) {
        rises.push_back(rise_of(course));
    }
    return rises;
}

std::string rise_row(const ComparisonPlan& plan, const Arm& arm, std::span<const Course> courses, int decimals) {
    const Rise rise = rise_of_arm(arm, courses);
    std::string row = formatted("%-*s %9.*f %9.*f %9s  %-20s %7zu  ", name_width_of(plan), arm.name.c_str(), decimals,
                                rise.first, decimals, rise.last, signed_text(rise.mean, decimals).c_str(),
                                interval_text(rise.interval, decimals).c_str(), rise.extinct) +
                      changes_between(plan.arms[0].parameters, arm.parameters);
    row.erase(row.find_last_not_of(' ') + 1);
    return row + "\n";
}

/// Formats the conclusion about two worlds, neither of which is a control of the other.
std::string conclusion_about(const Arm& world, const Arm& other, const Finding& finding, std::size_t tests,
                             int decimals) {
    const std::string by = signed_text(std::abs(finding.mean), decimals).substr(finding.mean != 0 ? 1 : 0);
    const std::string p = formatted(" (adjusted p = %.2g).", finding.adjusted_p);
    const bool has_births = parameters::has_births(world.parameters);
    switch (judge(finding, tests)) {
    case Judgement::Above:
        return world.name + (has_births ? " lives longer than " : " rises more than ") + other.name + ", by " + by +
               (has_births ? " intervals" : "") + p;
    case Judgement::Below:
        return world.name + (has_births ? " lives less long than " : " rises less than ") + other.name + ", by " + by +
               (has_births ? " intervals" : "") + p;
    case Judgement::CannotBeShown:
        return "There are too few replicates to show a difference between " + world.name + " and " + other.name + ".";
    case Judgement::NotShown:
        break;
    }
    return "No difference between " + world.name + " and " + other.name + " is shown" + p;
}

} // namespace

int decimals_for(std::span<const std::vector<Course>> courses) {
    if (courses.front().front().front().species[0].has_come) {
        return 1; // intervals
    }
    double greatest = 0;
    for (const std::vector<Course>& of_arm : courses) {
        for (const Course& course : of_arm) {
            greatest = std::max({greatest, std::abs(course.front().mean), std::abs(course.back().mean)});
        }
    }
    return greatest >= 20 ? 1 : greatest >= 2 ? 2 : 4;
}

Rise rise_of_arm(const Arm& arm, std::span<const Course> courses) {
    std::vector<double> first, last;
    std::size_t extinct = 0;
    for (const Course& course : courses) {
        first.push_back(course.front().mean);
        last.push_back(course.back().mean);
        extinct += static_cast<std::size_t>(std::ranges::count(course, 0u, &GenerationFitness::alive_count));
    }
    if (!parameters::has_bodies(arm.parameters)) {
        extinct = 0; // no organism can die if fitness is a function of the chromosome alone
    }
    const std::vector<double> rises = rises_of(courses);
    return {mean_of(first), mean_of(last), mean_of(rises), student_interval(rises), extinct};
}

std::string outcomes_text(const ComparisonPlan& plan, std::span<const std::vector<Course>> courses, int decimals) {
    if (plan.has_births()) {
        return persistence_table(plan, courses);
    }
    const int name_width = name_width_of(plan);
    std::string text = formatted("%-*s %9s %9s %9s  %-20s %7s  %s\n", name_width, "world", "first", "last", "rise",
                                 "95 % interval", "extinct", "changes");
    for (std::size_t arm = 0; arm < courses.size(); ++arm) {
        text += rise_row(plan, plan.arms[arm], courses[arm], decimals);
    }
    for (const Control& control : plan.controls) {
        if (!control.cannot_differ.empty()) {
            text += formatted("%-*s is not run: %s\n", name_width, control.name.c_str(), control.cannot_differ.c_str());
        }
    }
    return text;
}

std::string findings_text(const ComparisonPlan& plan, std::span<const Finding> findings, int decimals) {
    const int name_width = name_width_of(plan);
    std::string text = formatted("%s of %s minus %s of the other world, seed by seed\n%-*s %10s  %-20s %7s %9s %9s\n",
                                 plan.has_births() ? "intervals lived" : "rise", plan.arms[0].name.c_str(),
                                 plan.has_births() ? "those" : "the rise", name_width, "other", "difference",
                                 "95 % interval", "g", "p", "adjusted");
    for (std::size_t i = 0; i < findings.size(); ++i) {
        const Finding& finding = findings[i];
        text += formatted(
            "%-*s %10s  %-20s %7s %9.2g %9.2g\n", name_width, plan.arms[i + 1].name.c_str(),
            signed_text(finding.mean, decimals).c_str(), interval_text(finding.interval, decimals).c_str(),
            finding.effect_size ? signed_text(*finding.effect_size, 2).c_str() : "-", finding.p, finding.adjusted_p);
    }
    return text;
}

std::string conclusions_text(const ComparisonPlan& plan, std::span<const std::vector<Course>> courses,
                             std::span<const Finding> findings, int decimals) {
    std::string text;
    if (plan.controls.empty()) {
        for (std::size_t i = 0; i < findings.size(); ++i) {
            text += conclusion_about(plan.arms[0], plan.arms[i + 1], findings[i], findings.size(), decimals) + "\n";
        }
        return text;
    }
    if (plan.has_births()) {
        return persistence_verdict(plan, courses, findings);
    }
    std::vector<ControlResult> weighed;
    std::size_t next = 0; // index of the next finding; controls that cannot differ have no finding
    for (const Control& control : plan.controls) {
        weighed.push_back(
            {control, control.cannot_differ.empty() ? std::optional{findings[next++]} : std::optional<Finding>{}});
    }
    const std::vector<double> rises = rises_of(courses[0]);
    for (const std::string& sentence : verdict(mean_of(rises), student_interval(rises), weighed, decimals)) {
        text += sentence + "\n";
    }
    return text;
}

} // namespace evod::commands
