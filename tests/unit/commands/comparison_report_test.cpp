#include "server/commands/comparison_report.h"

#include <gmock/gmock.h>

namespace evod::commands {
namespace {

using experiments::Course;
using testing::HasSubstr;
using testing::Not;

/// Two replicates of two generations for each arm; arm i rises by i * 10 on average.
std::vector<std::vector<Course>> courses_of(std::size_t arms) {
    std::vector<std::vector<Course>> courses(arms);
    for (std::size_t arm = 0; arm < arms; ++arm) {
        for (const double noise : {-1.0, 1.0}) {
            const double rise = 10 * static_cast<double>(arm) + noise;
            courses[arm].push_back({{.mean = 100, .best = 200, .organism_count = 5, .alive_count = 5},
                                    {.mean = 100 + rise, .best = 200, .organism_count = 5, .alive_count = arm}});
        }
    }
    return courses;
}

experiments::ComparisonPlan plan_of(std::vector<std::string> names) {
    experiments::ComparisonPlan plan{.arms = {}, .controls = {}, .seed = {1}, .generations = 2};
    for (std::string& name : names) {
        plan.arms.push_back({std::move(name), {}});
    }
    return plan;
}

TEST(ComparisonReport, ShowsAsManyDecimalsAsTheFitnessNeeds) {
    const auto decimals = [](double fitness) {
        return decimals_for(std::vector<std::vector<Course>>{{{{.mean = fitness}}}});
    };
    EXPECT_EQ(decimals(100), 1);
    EXPECT_EQ(decimals(-5), 2);
    EXPECT_EQ(decimals(0.3), 4);
}

TEST(ComparisonReport, ARowGivesTheRiseAndTheChanges) {
    auto plan = plan_of({"world", "other"});
    plan.arms[1].parameters.poison_harm = 0;
    const std::string text = outcomes_text(plan, courses_of(2), 1);
    EXPECT_THAT(text, HasSubstr("\nworld                100.0     100.0       0.0  -12.7 to +12.7             2\n"));
    EXPECT_THAT(text, HasSubstr("\nother                100.0     110.0     +10.0  -2.7 to +22.7              0  "
                                "poison_harm=0\n"));
}

TEST(ComparisonReport, AControlThatWasNotRunHasAReason) {
    auto plan = plan_of({"world"});
    plan.controls.push_back({experiments::ControlKind::HarmlessPoison, "harmless_poison", {}, "there is no poison"});
    EXPECT_THAT(outcomes_text(plan, courses_of(1), 1), HasSubstr("harmless_poison  is not run: there is no poison\n"));
}

TEST(ComparisonReport, ConcludesOnEachOtherWorld) {
    const auto plan = plan_of({"world", "better", "same"});
    std::vector<experiments::Finding> findings(2);
    for (experiments::Finding& finding : findings) {
        finding.differences.assign(20, 0.0);
    }
    findings[0].mean = -7.5;
    findings[0].adjusted_p = 0.01;
    findings[1].mean = 0.5;
    findings[1].adjusted_p = 0.6;
    const std::string text = conclusions_text(plan, courses_of(3), findings, 1);
    EXPECT_EQ(text, "world rises less than better, by 7.5 (adjusted p = 0.01).\n"
                    "No difference between world and same is shown (adjusted p = 0.6).\n");
    EXPECT_THAT(findings_text(plan, findings, 1), HasSubstr("\nbetter                 -7.5  0.0 to 0.0"));
}

} // namespace
} // namespace evod::commands
