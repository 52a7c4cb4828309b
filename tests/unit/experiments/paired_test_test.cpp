#include "server/experiments/paired_test.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace evod::experiments {
namespace {

using testing::DoubleNear;
using testing::ElementsAre;

// Student's own data: hours of sleep gained by ten patients with one drug over another ("The probable error of a mean",
// Biometrika 6, 1908). Its mean is 1.58, its deviation 1.2300; t = 4.0621, 95 % interval 0.7001 to 2.4599.
constexpr std::array gained{1.2, 2.4, 1.3, 1.3, 0.0, 1.0, 1.8, 0.8, 4.6, 1.4};
// Darwin's maize: by how many eighths of an inch the crossed plant of each of fifteen pairs was higher than the
// self-fertilised (Fisher 1935, "The Design of Experiments", III). Of the 2^15 patterns of signs 1726 have a sum at
// least as far from 0 as theirs, 314: p = 0.05267 (there, 21).
constexpr std::array maize{49.0, -67.0, 8.0, 16.0, 6.0, 23.0, 28.0, 41.0, 14.0, 29.0, 56.0, 24.0, 75.0, 60.0, -48.0};

TEST(PairedTest, StudentsIntervalMatchesHisData) {
    EXPECT_NEAR(mean_of(gained), 1.58, 1e-12);
    EXPECT_NEAR(deviation_of(gained), 1.2299, 1e-3);
    const Interval interval = student_interval(gained);
    EXPECT_NEAR(interval.low, 0.7001, 1e-4);
    EXPECT_NEAR(interval.high, 2.4599, 1e-4);
    EXPECT_TRUE(interval.contains(1.58));
    EXPECT_FALSE(interval.contains(0));
}

TEST(PairedTest, StudentsIntervalOfTwoHasOneDegreeOfFreedom) {
    // t(0.975, 1) = tan(0.475 π) = 12.7062; the standard error of 1 and 3 is 1.
    const Interval interval = student_interval(std::array{1.0, 3.0});
    EXPECT_NEAR(interval.low, 2 - 12.7062, 1e-4);
    EXPECT_NEAR(interval.high, 2 + 12.7062, 1e-4);
    const Interval narrow = student_interval(std::array{1.0, 3.0}, 0.5); // t(0.75, 1) = 1
    EXPECT_NEAR(narrow.low, 1, 1e-9);
    EXPECT_NEAR(narrow.high, 3, 1e-9);
}

TEST(PairedTest, HedgesCorrectsCohen) {
    // 1, 2, 3: mean 2, deviation 1, d = 2; two degrees of freedom, 1 − 3/7.
    EXPECT_NEAR(*hedges_g(std::array{1.0, 2.0, 3.0}), 2 * 4.0 / 7, 1e-12);
    EXPECT_NEAR(*hedges_g(std::array{-1.0, -2.0, -3.0}), -2 * 4.0 / 7, 1e-12);
    EXPECT_NEAR(*hedges_g(gained), 1.2846 * (1 - 3.0 / 35), 1e-3);
    EXPECT_FALSE(hedges_g(std::array{1.0, 2.0}));
    EXPECT_FALSE(hedges_g(std::array{0.0, 0.0, 0.0, 0.0}));
    EXPECT_FALSE(hedges_g(std::array{2.5, 2.5, 2.5}));
}

TEST(PairedTest, SignFlipsOfFewDifferencesMatchAHandCount) {
    // All of one sign: only they and their mirror image are as far out, 2 of 2^n.
    EXPECT_EQ(sign_flip_p(std::array{3.0}, {}), 1);
    EXPECT_EQ(sign_flip_p(std::array{3.0, 1.0}, {}), 0.5);
    EXPECT_EQ(sign_flip_p(std::array{3.0, 1.0, 0.5}, {}), 0.25);
    EXPECT_EQ(sign_flip_p(std::array{-3.0, -1.0, -0.5, -9.0}, {}), 0.125);
    // 3, 1, −1: sums are ±5, ±3 (twice each), ±1: 6 of 8 are at least 3 away.
    EXPECT_EQ(sign_flip_p(std::array{3.0, 1.0, -1.0}, {}), 0.75);
    // A difference of 0 has no sign.
    EXPECT_EQ(sign_flip_p(std::array{2.0, 0.0}, {}), 1);
    EXPECT_EQ(sign_flip_p(std::array{0.0, 0.0, 0.0}, {}), 1);
    // Tenths are not exact: the same three in another order must not count as nearer.
    EXPECT_EQ(sign_flip_p(std::array{0.1, 0.2, 0.3, -0.3}, {}), sign_flip_p(std::array{-0.3, 0.3, 0.2, 0.1}, {}));
    EXPECT_EQ(sign_flip_p(std::array{0.1, 0.2, 0.3, -0.3}, {}), sign_flip_p(std::array{1.0, 2.0, 3.0, -3.0}, {}));
}

TEST(PairedTest, SignFlipsOfDarwinsMaizeMatchFisher) {
    EXPECT_EQ(sign_flip_p(maize, {}), 1726.0 / 32768);
}

TEST(PairedTest, DrawnSignFlipsApproximateTheExactP) {
    // Twenty-one differences with the exact p-value of the first twenty and one of 0, which changes nothing. The share
    // found among 2^20 has a standard error of sqrt(p (1 − p))/1024 < 0.0005; six of them is met but in 2e-9 of seeds.
    std::vector<double> twenty;
    for (int i = 0; i < 20; ++i) {
        twenty.push_back((i % 3 == 0 ? -1.0 : 1.0) * (1 + i * 0.37));
    }
    std::vector<double> more = twenty;
    more.push_back(0);
    const double exact = sign_flip_p(twenty, {});
    ASSERT_GT(exact, 0.02);
    ASSERT_LT(exact, 0.6);
    const double drawn = sign_flip_p(more, base::Seed{281});
    EXPECT_NEAR(drawn, exact, 0.003);
    EXPECT_EQ(sign_flip_p(more, base::Seed{281}), drawn);
    EXPECT_NE(sign_flip_p(more, base::Seed{282}), drawn);
    // More than a word of signs; and never 0.
    EXPECT_EQ(sign_flip_p(std::vector<double>(70, 1.0), base::Seed{283}), least_sign_flip_p(70));
}

TEST(PairedTest, TheSmallestPIsThatOfEqualSigns) {
    for (const std::size_t count : {1, 2, 3, 8, 12, 20}) {
        std::vector<double> differences;
        for (std::size_t i = 0; i < count; ++i) {
            differences.push_back(1 + static_cast<double>(i));
        }
        EXPECT_EQ(sign_flip_p(differences, {}), least_sign_flip_p(count)) << count;
    }
    EXPECT_EQ(least_sign_flip_p(20), std::ldexp(1, -19));
}

TEST(PairedTest, HolmAdjustsStepByStep) {
    // Holm 1979: 0.01 · 4, 0.02 · 3, 0.03 · 2 (not below the one before), 0.5.
    EXPECT_THAT(holm(std::array{0.03, 0.01, 0.5, 0.02}), ElementsAre(DoubleNear(0.06, 1e-12), DoubleNear(0.04, 1e-12),
                                                                     DoubleNear(0.5, 1e-12), DoubleNear(0.06, 1e-12)));
    EXPECT_THAT(holm(std::array{0.4, 0.9, 0.6}), ElementsAre(1, 1, 1));
    EXPECT_THAT(holm(std::array{0.04}), ElementsAre(0.04));
    EXPECT_TRUE(holm({}).empty());
}

TEST(PairedTest, RejectsAtItsLevelWhereNothingDiffers) {
    // Law: of 2000 tests of eight symmetric differences, p <= 1/16 with chance 1/16 exactly; a normal 6 standard
    // deviations away has chance 2e-9.
    int alarms = 0;
    constexpr int tests = 2000;
    for (std::uint32_t test = 0; test < tests; ++test) {
        base::RandomStream random{{base::Seed{284}, base::Purpose::ScenarioTest, 0, 1}, test};
        std::vector<double> differences(8);
        for (double& difference : differences) {
            difference = random.gaussian();
        }
        alarms += sign_flip_p(differences, {}) <= 1.0 / 16;
    }
    EXPECT_NEAR(alarms, tests / 16.0, 6 * std::sqrt(tests * 15.0 / 256));
}

} // namespace
} // namespace evod::experiments
