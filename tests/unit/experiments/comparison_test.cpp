#include "server/experiments/comparison.h"

#include "server/base/inline_executor.h"
#include "server/experiments/controls.h"
#include "server/experiments/trials.h"
#include "server/simulation/world.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <vector>

namespace evod::experiments {
namespace {

parameters::Parameters small_world() {
    parameters::Parameters world;
    world.population_size = 12;
    world.island_count = 2;
    world.generation_s = 2;
    world.food_count = 60;
    world.stop_at_extinction = true;
    return of_fixed_length(world, 6);
}

std::vector<Arm> small_arms() {
    std::vector<Arm> arms{{"world", small_world()}};
    for (const ControlKind kind : all_controls) {
        arms.push_back({"", control_of(small_world(), kind).parameters});
    }
    return arms;
}

TEST(Comparison, IsTheSameWithAnyNumberOfJobs) {
    const std::vector<Arm> arms = small_arms();
    const auto reference = run_arms(arms, {.seed = base::Seed{291}, .replicates = 4});
    ASSERT_TRUE(reference);
    const std::vector<Finding> expected = find_differences(*reference, base::Seed{291});
    for (const std::size_t jobs : {2, 3, 16}) {
        const auto courses = run_arms(arms, {.seed = base::Seed{291}, .replicates = 4, .jobs = jobs});
        ASSERT_TRUE(courses);
        EXPECT_EQ(*courses, *reference);
        const std::vector<Finding> findings = find_differences(*courses, base::Seed{291});
        for (std::size_t i = 0; i < expected.size(); ++i) {
            EXPECT_EQ(findings[i].p, expected[i].p);
        }
    }
    EXPECT_NE(*run_arms(arms, {.seed = base::Seed{292}, .replicates = 4}), *reference);
}

TEST(Comparison, RunsEachArmWithTheSeedsOfTheReplicates) {
    const std::vector<Arm> arms = small_arms();
    const auto courses = run_arms(arms, {.seed = base::Seed{293}, .replicates = 3, .jobs = 2});
    ASSERT_TRUE(courses);
    ASSERT_EQ(courses->size(), 5u);
    base::InlineExecutor executor;
    for (std::size_t arm = 0; arm < 5; ++arm) {
        for (std::uint32_t replicate = 0; replicate < 3; ++replicate) {
            simulation::World world{arms[arm].parameters, replicate_seed(base::Seed{293}, replicate)};
            while (world.outcome() == evolution::Outcome::Running) {
                world.advance_tick(executor);
            }
            const Course& course = (*courses)[arm][replicate];
            ASSERT_EQ(course.size(), 6u);
            for (std::size_t i = 0; i < 6; ++i) {
                const auto& islands = world.history()[i];
                EXPECT_NEAR(course[i].mean, (islands[0].fitness_mean + islands[1].fitness_mean) / 2, 1e-9);
                EXPECT_EQ(course[i].best, std::max(islands[0].fitness_best, islands[1].fitness_best));
                EXPECT_EQ(course[i].alive_count, islands[0].alive_count + islands[1].alive_count);
                EXPECT_EQ(course[i].organism_count, 24u);
            }
            // The first generation is the same in all arms, except with harmless poison.
            if (arm != 3) {
                EXPECT_EQ(course[0], (*courses)[0][replicate][0]);
            }
        }
    }
}

TEST(Comparison, ReturnsNothingAfterItIsStopped) {
    std::atomic<int> shares = 0;
    double last = 0;
    RunsWanted wanted{.seed = base::Seed{294}, .replicates = 3, .jobs = 2};
    wanted.progress = [&](double share) {
        EXPECT_GT(share, last);
        last = share;
        ++shares;
    };
    ASSERT_TRUE(run_arms(small_arms(), wanted));
    EXPECT_EQ(shares, 3 * 5 * 6);
    EXPECT_EQ(last, 1);
    shares = 0;
    last = 0;
    wanted.stopped = [&] { return shares >= 20; };
    EXPECT_FALSE(run_arms(small_arms(), wanted));
    EXPECT_LT(last, 1);
}

Course course_of(double first, double last) {
    return {{.mean = first, .best = 0, .organism_count = 1, .alive_count = 1},
            {.mean = 99, .best = 0, .organism_count = 1, .alive_count = 1},
            {.mean = last, .best = 0, .organism_count = 1, .alive_count = 1}};
}

TEST(Findings, PairTheRisesBySeed) {
    // Rises of the world 10, 20, 30, 40; of the first other 9, 18, 27, 36 (less by 1, 2, 3, 4), of the second 20 each.
    std::vector<std::vector<Course>> courses(3);
    for (int i = 1; i <= 4; ++i) {
        courses[0].push_back(course_of(5, 5 + 10 * i));
        courses[1].push_back(course_of(i, i + 9 * i));
        courses[2].push_back(course_of(-20, 0));
    }
    const std::vector<Finding> found = find_differences(courses, {});
    ASSERT_EQ(found.size(), 2u);
    EXPECT_EQ(found[0].differences, (std::vector<double>{1, 2, 3, 4}));
    EXPECT_EQ(found[0].mean, 2.5);
    EXPECT_NEAR(*found[0].effect_size, 2.5 / std::sqrt(5.0 / 3) * (1 - 3.0 / 11), 1e-12);
    EXPECT_NEAR(found[0].interval.low, 2.5 - 3.18245 * std::sqrt(5.0 / 12), 1e-4); // t(0.975, 3)
    EXPECT_EQ(found[0].p, 0.125);
    EXPECT_EQ(found[1].differences, (std::vector<double>{-10, 0, 10, 20}));
    EXPECT_EQ(found[1].p, 0.75); // of ±10 ±10 ±20 three in four come to 20 or more
    EXPECT_EQ(found[0].adjusted_p, 0.25);
    EXPECT_EQ(found[1].adjusted_p, 0.75);
}

TEST(Findings, AreJudgedByTheAdjustedP) {
    Finding finding{.differences = std::vector<double>(20), .mean = 3, .interval = {}, .effect_size = {}};
    finding.p = 0.01;
    finding.adjusted_p = 0.04;
    EXPECT_EQ(judge(finding, 4), Judgement::Above);
    finding.mean = -3;
    EXPECT_EQ(judge(finding, 4), Judgement::Below);
    finding.adjusted_p = 0.05;
    EXPECT_EQ(judge(finding, 4), Judgement::NotShown);
    finding.differences.resize(5); // 2/2^5 is above 0.05 even alone
    EXPECT_EQ(judge(finding, 1), Judgement::CannotBeShown);
    finding.differences.resize(6);
    EXPECT_EQ(judge(finding, 1), Judgement::NotShown);
    EXPECT_EQ(judge(finding, 4), Judgement::CannotBeShown);
}

} // namespace
} // namespace evod::experiments
