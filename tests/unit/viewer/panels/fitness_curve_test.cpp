#include "client/viewer/panels/fitness_curve.h"

#include <gtest/gtest.h>

namespace evod::viewer {
namespace {

TEST(FitnessCurve, AShortHistoryIsDrawnWhole) {
    const std::vector<FitnessHistory::Generation> three{{1, 5, 2}, {2, 9, 3}, {4, 7, 4}};
    const auto drawn = reduced(three, 300);
    ASSERT_EQ(drawn.size(), 3u);
    EXPECT_EQ(drawn[1].best, 9);
    EXPECT_TRUE(reduced({}, 300).empty());
}

TEST(FitnessCurve, ALongHistoryKeepsItsPeaks) {
    std::vector<FitnessHistory::Generation> many;
    for (std::uint64_t number = 1; number <= 10'000; ++number) {
        many.push_back({number, number == 4321 ? 99.0 : 1.0, static_cast<double>(number % 2)});
    }
    const auto drawn = reduced(many, 100);
    ASSERT_EQ(drawn.size(), 100u);
    EXPECT_EQ(drawn.back().number, 10'000u);
    EXPECT_EQ(drawn[43].best, 99);
    EXPECT_EQ(drawn[43].mean, 0.5);
}

} // namespace
} // namespace evod::viewer
