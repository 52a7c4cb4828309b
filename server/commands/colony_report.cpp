#include "server/commands/colony_report.h"

#include <boost/json/array.hpp>

#include <algorithm>
#include <cmath>

namespace evod::commands {
namespace {

using namespace experiments;

constexpr const char* species_names[] = {"prey", "predators"};

/// Mean intervals that all species of an arm lived; runs that lived all of them count with their number.
double mean_lived(std::span<const Course> courses) {
    std::vector<double> lived;
    for (const Course& course : courses) {
        lived.push_back(outcome_of(course));
    }
    return mean_of(lived);
}

std::size_t persisted_count(std::span<const Course> courses, std::uint32_t intervals) {
    return static_cast<std::size_t>(
        std::ranges::count_if(courses, [&](const Course& course) { return outcome_of(course) >= intervals; }));
}

/// "103.2 (8.1) 82"; empty if the species never came.
std::string numbers_text(const ArmPersistence& species) {
    return species.runs == 0 ? std::string{}
                             : formatted("%.1f (%.1f) %llu", species.count_mean, species.count_deviation,
                                         static_cast<unsigned long long>(species.lowest_count));
}

std::string born_text(const ArmPersistence& prey, const ArmPersistence& predators) {
    return formatted("%.1f", prey.born_mean) + (predators.runs == 0 ? "" : formatted(" + %.1f", predators.born_mean));
}

} // namespace

std::string persistence_text(std::span<const SpeciesOfInterval> intervals) {
    std::string text;
    for (std::size_t species = 0; species < std::size(species_names); ++species) {
        const auto persistence = persistence_of(intervals, species);
        if (!persistence) {
            continue;
        }
        const std::uint64_t end = persistence->extinct_in.value_or(intervals.size());
        text +=
            formatted("%s: %s %llu; %.1f living on average (deviation %.1f), lowest %llu, %.1f births per interval\n",
                      species_names[species], persistence->extinct_in ? "extinct in interval" : "alive after interval",
                      static_cast<unsigned long long>(end), persistence->count_mean, persistence->count_deviation,
                      static_cast<unsigned long long>(persistence->lowest_count), persistence->born_mean);
    }
    return text;
}

boost::json::object persistence_object(std::span<const SpeciesOfInterval> intervals) {
    boost::json::object object;
    for (std::size_t species = 0; species < std::size(species_names); ++species) {
        if (const auto persistence = persistence_of(intervals, species)) {
            const auto& gone = persistence->extinct_in;
            object[species_names[species]] = {
                {"arrived_in", persistence->arrived_in},     {"extinct_in", gone ? boost::json::value(*gone) : nullptr},
                {"count_mean", persistence->count_mean},     {"count_deviation", persistence->count_deviation},
                {"lowest_count", persistence->lowest_count}, {"born_mean", persistence->born_mean}};
        }
    }
    return object;
}

ArmPersistence persistence_of_arm(std::span<const Course> courses, std::size_t species) {
    ArmPersistence arm;
    for (const Course& course : courses) {
        const auto persistence = persistence_of(species_of(course), species);
        if (!persistence) {
            continue;
        }
        arm.lowest_count =
            arm.runs == 0 ? persistence->lowest_count : std::min(arm.lowest_count, persistence->lowest_count);
        ++arm.runs;
        arm.extinct += persistence->extinct_in ? 1 : 0;
        arm.count_mean += persistence->count_mean;
        arm.count_deviation += persistence->count_deviation;
        arm.born_mean += persistence->born_mean;
    }
    if (arm.runs > 0) {
        const auto runs = static_cast<double>(arm.runs);
        arm.count_mean /= runs;
        arm.count_deviation /= runs;
        arm.born_mean /= runs;
    }
    return arm;
}

std::string persistence_table(const ComparisonPlan& plan, std::span<const std::vector<Course>> courses) {
    const int width = name_width_of(plan);
    std::string text = formatted("%-*s %12s %8s  %-22s %-22s %-16s %s\n", width, "world", "persisted", "lived",
                                 "prey (sd) lowest", "predators (sd) lowest", "births", "changes");
    for (std::size_t arm = 0; arm < courses.size(); ++arm) {
        const ArmPersistence prey = persistence_of_arm(courses[arm], 0),
                             predators = persistence_of_arm(courses[arm], 1);
        std::string row =
            formatted("%-*s %5zu of %-3zu %8.1f  %-22s %-22s %-16s ", width, plan.arms[arm].name.c_str(),
                      persisted_count(courses[arm], plan.generations), courses[arm].size(), mean_lived(courses[arm]),
                      numbers_text(prey).c_str(), numbers_text(predators).c_str(), born_text(prey, predators).c_str()) +
            changes_between(plan.arms[0].parameters, plan.arms[arm].parameters);
        row.erase(row.find_last_not_of(' ') + 1);
        text += row + "\n";
    }
    for (const Control& control : plan.controls) {
        if (!control.cannot_differ.empty()) {
            text += formatted("%-*s is not run: %s\n", width, control.name.c_str(), control.cannot_differ.c_str());
        }
    }
    return text;
}

std::string persistence_verdict(const ComparisonPlan& plan, std::span<const std::vector<Course>> courses,
                                std::span<const Finding> findings) {
    const auto persisted_text = [&](std::size_t arm) {
        return formatted("%zu of %zu runs", persisted_count(courses[arm], plan.generations), courses[arm].size());
    };
    std::string text = formatted("Is it a colony? In %s, every species lived for all %u intervals.\n",
                                 persisted_text(0).c_str(), plan.generations);
    std::size_t next = 0; // index of the next finding; controls that cannot differ have no finding
    for (const Control& control : plan.controls) {
        const bool is_mutation = control.kind == ControlKind::MutationOff;
        const std::string subject = is_mutation ? "Mutation: " : "Selection: ";
        if (!control.cannot_differ.empty()) {
            text += subject + control.cannot_differ + ".\n";
            continue;
        }
        const Finding& finding = findings[next++];
        const std::string other = persisted_text(next);
        text += subject + (is_mutation ? "without it, " : "with unselected parents, ") + other + " persist" +
                formatted(" (adjusted p = %.2g): ", finding.adjusted_p);
        switch (judge(finding, findings.size())) {
        case Judgement::Above:
            text += is_mutation ? "new variety helps the colony to persist.\n" : "selection keeps the colony alive.\n";
            break;
        case Judgement::Below:
            text +=
                is_mutation ? "new variety makes the colony die sooner.\n" : "selection makes the colony die sooner.\n";
            break;
        case Judgement::NotShown:
        case Judgement::CannotBeShown:
            text += "an effect on persistence is not shown.\n";
            break;
        }
    }
    return text;
}

int name_width_of(const ComparisonPlan& plan) {
    std::size_t width = 16;
    for (const Arm& arm : plan.arms) {
        width = std::max(width, arm.name.size());
    }
    return static_cast<int>(width);
}

} // namespace evod::commands
