#include "server/evolution/objectives.h"

#include "tests/unit/evolution/draws.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace evod::evolution {
namespace {

using testing::ElementsAre;
constexpr double infinite = std::numeric_limits<double>::infinity();

/// Few different numbers, so that many organisms are equal in an objective or in all.
std::vector<double> drawn(std::size_t organisms, std::size_t count, std::uint64_t seed) {
    base::RandomStream random = stream_of(seed);
    std::vector<double> numbers(organisms * count);
    for (double& number : numbers) {
        number = random.below(12) - 5.0;
    }
    return numbers;
}

bool dominates(std::span<const double> one, std::span<const double> other) {
    bool better = false, worse = false;
    for (std::size_t i = 0; i < one.size(); ++i) {
        better |= one[i] > other[i];
        worse |= one[i] < other[i];
    }
    return better && !worse;
}

TEST(Fronts, AreThoseOfTheDefinition) {
    for (const std::size_t count : {1u, 2u, 3u, 5u}) {
        for (const std::uint64_t seed : {931u, 932u, 933u}) {
            const std::vector<double> numbers = drawn(60, count, seed);
            const Objectives objectives{numbers, count};
            std::vector<std::size_t> front_of(60, 99);
            const auto found = fronts(objectives);
            for (std::size_t front = 0; front < found.size(); ++front) {
                for (const std::uint32_t organism : found[front]) {
                    ASSERT_EQ(front_of[organism], 99u) << "an organism is in two fronts";
                    front_of[organism] = front;
                }
            }
            for (std::uint32_t i = 0; i < 60; ++i) {
                std::size_t expected = 0; // one more than the last front with a dominator
                for (std::uint32_t j = 0; j < 60; ++j) {
                    if (dominates(objectives.of(j), objectives.of(i))) {
                        expected = std::max(expected, front_of[j] + 1);
                    }
                }
                EXPECT_EQ(front_of[i], expected) << count << " objectives, organism " << i;
            }
        }
    }
}

TEST(CrowdingDistances, AreTheSidesOfTheBoxBetweenNeighbours) {
    const std::vector<double> numbers{0, 10, 1, 6, 4, 4, 10, 0}; // a front of four
    const std::vector<std::uint32_t> front{3, 0, 2, 1};
    EXPECT_THAT(crowding_distances({numbers, 2}, front),
                ElementsAre(infinite, infinite, 9.0 / 10 + 6.0 / 10, 4.0 / 10 + 6.0 / 10));
}

TEST(CrowdingDistances, IgnoreAnObjectiveWithoutWidth) {
    const std::vector<double> numbers{7, 7, 7, 7};
    const std::vector<std::uint32_t> front{0, 1, 2, 3};
    EXPECT_THAT(crowding_distances({numbers, 1}, front), ElementsAre(infinite, 0, 0, infinite));
    EXPECT_THAT(crowding_distances({numbers, 1}, {}), ElementsAre());
}

TEST(Standing, IsByFrontThenByCrowding) {
    //                                0       1      2      3       4       5: dominated by 1
    const std::vector<double> numbers{0, 10, 1, 6, 4, 4, 10, 0, 4, 4, 0, 5};
    // In the first front: 0 and 3 are at its ends. 2 and 4 are equal, so each has a neighbour at no distance.
    const std::vector<double> standings = standing({numbers, 2});
    EXPECT_EQ(standings[0], 0);
    EXPECT_EQ(standings[3], 0);
    EXPECT_EQ(standings[1], -2);
    EXPECT_LT(standings[2], -2);
    EXPECT_LT(standings[4], -2);
    EXPECT_EQ(standings[5], -5);
}

TEST(Standing, OfOneObjectiveIsItsRank) {
    const std::vector<double> numbers{3, -1, 8, 5};
    EXPECT_THAT(standing({numbers, 1}), ElementsAre(-2, -3, 0, -1));
}

} // namespace
} // namespace evod::evolution
