#include "server/commands/colony_report.h"

#include <gmock/gmock.h>

namespace evod::commands {
namespace {

using experiments::Course;
using experiments::SpeciesOfInterval;
using testing::HasSubstr;
using testing::Not;

/// A run of 4 intervals with 10 prey; the predators come in the second one, and are gone after `predators` intervals.
Course course_of(std::size_t predators) {
    Course course;
    for (std::size_t i = 0; i < 4; ++i) {
        course.push_back({.mean = 1, .best = 2, .organism_count = 12, .alive_count = 10});
        course.back().species[0] = {true, 10, 8, 5, 9.5};
        const bool alive = i >= 1 && i < predators;
        course.back().species[1] = {i >= 1, alive ? 3U : 0U, alive ? 2U : 0U, 1, 3};
    }
    return course;
}

experiments::ComparisonPlan plan_with_controls() {
    experiments::ComparisonPlan plan{.arms = {}, .controls = {}, .seed = {1}, .generations = 4};
    parameters::Parameters world;
    world.reproduction = parameters::Reproduction::Births;
    plan.arms.push_back({"world", world});
    for (const experiments::ControlKind kind : experiments::controls_of_births) {
        plan.controls.push_back(control_of(world, kind));
        plan.arms.push_back({plan.controls.back().name, plan.controls.back().parameters});
    }
    return plan;
}

TEST(ColonyReport, HasALineForEachSpeciesThatCame) {
    EXPECT_EQ(persistence_text(species_of(course_of(4))),
              "prey: alive after interval 4; 9.5 living on average (deviation 0.0), lowest 8, 5.0 births per interval\n"
              "predators: alive after interval 4; 3.0 living on average (deviation 0.0), lowest 2, 1.0 births per "
              "interval\n");
    EXPECT_THAT(persistence_text(species_of(course_of(3))), HasSubstr("predators: extinct in interval 4;"));
    Course prey_alone = course_of(4);
    prey_alone.resize(1);
    EXPECT_THAT(persistence_text(species_of(prey_alone)), Not(HasSubstr("predators")));
    EXPECT_EQ(persistence_text({}), "");
    const auto object = persistence_object(species_of(course_of(3)));
    EXPECT_EQ(object.at("predators").as_object().at("extinct_in").as_uint64(), 4u);
    EXPECT_TRUE(object.at("prey").as_object().at("extinct_in").is_null());
}

TEST(ColonyReport, ATableHasTheRunsThatPersisted) {
    const auto plan = plan_with_controls();
    const std::vector<std::vector<Course>> courses{
        {course_of(4), course_of(4)}, {course_of(4), course_of(2)}, {course_of(2), course_of(3)}};
    const std::string text = persistence_table(plan, courses);
    EXPECT_THAT(text, HasSubstr("\nworld                  2 of 2        4.0  9.5 (0.0) 8            3.0 (0.0) 2"));
    EXPECT_THAT(text, HasSubstr("\nmutation_off           1 of 2        3.0  "));
    EXPECT_THAT(text, HasSubstr("\nunselected_parents     0 of 2        2.5  "));
    EXPECT_THAT(text, HasSubstr("shuffle_births=true\n"));
}

TEST(ColonyReport, ConcludesOnMutationAndSelection) {
    const auto plan = plan_with_controls();
    const std::vector<std::vector<Course>> courses{{course_of(4)}, {course_of(4)}, {course_of(2)}};
    std::vector<experiments::Finding> findings(2);
    for (experiments::Finding& finding : findings) {
        finding.differences.assign(20, 0.0);
    }
    findings[1].mean = 2;
    findings[1].adjusted_p = 0.01;
    EXPECT_EQ(persistence_verdict(plan, courses, findings),
              "Is it a colony? In 1 of 1 runs, every species lived for all 4 intervals.\n"
              "Mutation: without it, 1 of 1 runs persist (adjusted p = 1): an effect on persistence is not shown.\n"
              "Selection: with unselected parents, 0 of 1 runs persist (adjusted p = 0.01): selection keeps the colony "
              "alive.\n");
}

} // namespace
} // namespace evod::commands
