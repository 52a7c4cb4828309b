#include "server/experiments/comparison_plan.h"

#include "tests/unit/recording/recorded_run.h"

#include <gmock/gmock.h>

#include <fstream>
#include <sstream>

namespace evod::experiments {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::vector<std::string> names_of(const ComparisonPlan& plan) {
    std::vector<std::string> names;
    for (const Arm& arm : plan.arms) {
        names.push_back(arm.name);
    }
    return names;
}

class ComparisonPlanTest : public testing::Test {
  protected:
    std::string file(const std::string& name, const std::string& text) {
        const std::string path = folder_.path() + "/" + name;
        std::ofstream{path} << text;
        return path;
    }

  private:
    const recording::TemporaryFolder folder_;
};

TEST_F(ComparisonPlanTest, HasAnArmPerControlThatCanDiffer) {
    const auto plan = plan_comparison({.controls = true, .drawn_seed = {9}, .changes = {"poison_count=0"}});
    ASSERT_TRUE(plan) << to_text(plan.error());
    EXPECT_THAT(names_of(*plan), ElementsAre("default", "random_selection", "mutation_off", "shuffled_fitness"));
    ASSERT_EQ(plan->controls.size(), 4u);
    EXPECT_EQ(plan->controls[2].cannot_differ, "there is no poison");
    EXPECT_EQ(plan->seed, base::Seed{9});
    EXPECT_EQ(plan->generations, default_generations);
    EXPECT_EQ(plan->arms[3].parameters.generation_limit, default_generations);
}

TEST_F(ComparisonPlanTest, WorldsWithBirthsHaveTheirOwnControls) {
    const auto plan = plan_comparison({.controls = true, .changes = {"reproduction=births"}});
    ASSERT_TRUE(plan) << to_text(plan.error());
    EXPECT_THAT(names_of(*plan), ElementsAre("default", "mutation_off", "unselected_parents"));
    EXPECT_TRUE(plan->arms[2].parameters.shuffle_births);
    const std::string births = file("births.json", R"({"reproduction": "births"})"), bred = file("bred.json", "{}");
    EXPECT_THAT(to_text(plan_comparison({.experiments = {births, bred}}).error()),
                HasSubstr("bred: reproduction differs from that of births"));
}

TEST_F(ComparisonPlanTest, NumbersFilesOfTheSameName) {
    const std::string path = file("a.json", R"({"generation_limit": 7, "seed": 3})");
    const auto plan = plan_comparison({.experiments = {path, path}});
    ASSERT_TRUE(plan) << to_text(plan.error());
    EXPECT_THAT(names_of(*plan), ElementsAre("a", "a_2"));
    EXPECT_EQ(plan->generations, 7u);
    EXPECT_EQ(plan->seed, base::Seed{3});
    EXPECT_TRUE(plan->controls.empty());
}

TEST_F(ComparisonPlanTest, AScheduleCanMakeAControlDiffer) {
    const std::string path = file("a.json", R"({"poison_count": 0, "poison_harm": {"1": 0, "5": 20}})");
    const auto plan = plan_comparison({.experiments = {path}, .controls = true, .generations = 8});
    ASSERT_TRUE(plan) << to_text(plan.error());
    EXPECT_EQ(plan->controls[2].cannot_differ, "");
    EXPECT_TRUE(plan->arms[0].schedule.holds("poison_harm"));
    EXPECT_FALSE(plan->arms[3].schedule.holds("poison_harm"));
}

TEST_F(ComparisonPlanTest, NeedsControlsOrTwoExperiments) {
    const std::string path = file("a.json", "{}");
    const auto refused = [](const ComparisonRequest& request) { return to_text(plan_comparison(request).error()); };
    EXPECT_THAT(refused({}), HasSubstr("give --controls, or two or more experiments"));
    EXPECT_THAT(refused({.experiments = {path}}), HasSubstr("give --controls"));
    EXPECT_THAT(refused({.experiments = {path, path}, .controls = true}), HasSubstr("got 2 experiments, allowed one"));
    EXPECT_THAT(refused({.controls = true, .generations = 1}), HasSubstr("got 1, allowed at least 2"));
    EXPECT_THAT(refused({.controls = true, .changes = {"food=1"}}), HasSubstr("--set food"));
}

TEST(ComparisonCurves, AreMeansWithTheirIntervals) {
    ComparisonPlan plan{.arms = {{"world", {}}}, .controls = {}, .seed = {1}, .generations = 1};
    const std::vector<std::vector<Course>> courses{{{{.mean = 1}}, {{.mean = 3}}}};
    std::ostringstream out;
    write_curves(out, plan, courses);
    EXPECT_THAT(out.str(), HasSubstr("arm,generation,mean,low,high\nworld,1,2,-10.706"));
}

TEST(ComparisonCourses, HaveARowPerRunAndGeneration) {
    ComparisonPlan plan{.arms = {{"world", {}}}, .controls = {}, .seed = {7}, .generations = 1};
    const std::vector<std::vector<Course>> courses{{{{.mean = 1.5, .best = 2, .organism_count = 5, .alive_count = 4}}}};
    std::ostringstream out;
    write_courses(out, plan, courses);
    EXPECT_EQ(out.str(), "arm,replicate,seed,generation,fitness_mean,fitness_best,organism_count,alive_count\n"
                         "world,0,1590899994837747,1,1.5,2,5,4\n");
}

} // namespace
} // namespace evod::experiments
