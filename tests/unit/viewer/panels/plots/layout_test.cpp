#include "client/viewer/panels/plots/layout.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <numeric>

namespace evod::viewer {
namespace {

using testing::ElementsAre;

constexpr double none = std::numeric_limits<double>::quiet_NaN();

TEST(Ticks, AreRoundNumbersInsideTheRange) {
    EXPECT_THAT(ticks_in({0, 10}, 6).at, ElementsAre(0, 2, 4, 6, 8, 10));
    EXPECT_THAT(ticks_in({-1.2, 1.1}, 5).at, ElementsAre(-1, -0.5, 0, 0.5, 1));
    EXPECT_THAT(ticks_in({101, 299}, 2).at, ElementsAre(200));
    EXPECT_EQ(ticks_in({101, 299}, 2).step, 100);
    for (const Range range : {Range{0, 1e-300}, {-1e300, 1e300}, {1e6, 1e6 + 3e-4}, {0, 99'999}}) {
        for (const int count : {2, 5, 10}) {
            const auto ticks = ticks_in(range, count);
            EXPECT_LE(ticks.at.size(), static_cast<std::size_t>(count));
            for (const double tick : ticks.at) {
                EXPECT_GE(tick, range.min - 1e-6 * range.width());
                EXPECT_LE(tick, range.max + 1e-6 * range.width());
            }
        }
    }
    EXPECT_THAT(ticks_in({1, 3}, 9, 1).at, ElementsAre(1, 2, 3)) << "generations";
    EXPECT_THAT(ticks_in({1, 3000}, 4, 1).at, ElementsAre(1000, 2000, 3000));
    EXPECT_TRUE(ticks_in({3, 3}, 5).at.empty());
    EXPECT_TRUE(ticks_in({none, 3}, 5).at.empty());
}

TEST(Ticks, HaveTheDecimalsTheyNeed) {
    EXPECT_EQ(tick_label(1500, 500), "1,500");
    EXPECT_EQ(tick_label(-1'234'000, 1000), "−1,234,000");
    EXPECT_EQ(tick_label(0.25, 0.05), "0.25");
    EXPECT_EQ(tick_label(0, 0.5), "0.0");
    EXPECT_EQ(tick_label(2e20, 1e20), "2e+20");
}

TEST(Ranges, HaveRoomEvenForOneNumber) {
    EXPECT_EQ(with_room({0, 10}, 0.1), (Range{-1, 11}));
    EXPECT_GT(with_room({5, 5}, 0.1).width(), 0);
    EXPECT_GT(with_room({1e300, 1e300}, 0.1).width(), 0);
    const Range widest = with_room({-1.7e308, 1.7e308}, 0.1);
    EXPECT_TRUE(std::isfinite(widest.width()));
    EXPECT_EQ(range_of(std::vector<double>{none, 3, -2, none}), (Range{-2, 3}));
    EXPECT_EQ(range_of(std::vector<double>{none}), std::nullopt);
    EXPECT_EQ(joined(std::nullopt, Range{1, 2}), (Range{1, 2}));
    EXPECT_EQ(joined(Range{0, 1}, Range{-1, 0.5}), (Range{-1, 1}));
}

TEST(Ranges, ZoomAtAPointAndStayInside) {
    const Range whole{0, 100};
    EXPECT_EQ(zoomed({0, 100}, 0.25, 2, whole, 1), (Range{12.5, 62.5}));
    EXPECT_EQ(zoomed({0, 10}, 0.5, 0.1, whole, 1), (Range{0, 100}));
    EXPECT_EQ(zoomed({80, 100}, 1, 0.5, whole, 1), (Range{60, 100}));
    EXPECT_EQ(zoomed({40, 60}, 0.5, 1000, whole, 5), (Range{47.5, 52.5}));
    EXPECT_EQ(moved({40, 60}, 70, whole), (Range{80, 100}));
    EXPECT_EQ(moved({40, 60}, -70, whole), (Range{0, 20}));
}

struct LongSeries : testing::Test {
    LongSeries() : x(100'000), y(100'000) {
        std::iota(x.begin(), x.end(), 1.0);
        for (std::size_t i = 0; i < y.size(); ++i) {
            y[i] = std::sin(static_cast<double>(i) * 0.37);
        }
        y[54'321] = 9; // one peak in one generation
        y[54'329] = -9;
    }
    std::vector<double> x, y;
};

TEST_F(LongSeries, IsDrawnWithFewPointsAndKeepsItsPeaks) {
    const auto groups = groups_of(x, {1, 100'000}, 500);
    EXPECT_LE(groups.size(), 501u);
    EXPECT_EQ(groups.front().begin, 0u);
    EXPECT_EQ(groups.back().end, x.size());
    for (std::size_t i = 1; i < groups.size(); ++i) {
        ASSERT_EQ(groups[i].begin, groups[i - 1].end) << "nothing is left out";
    }
    const auto line = line_of(x, y, groups);
    EXPECT_LE(line.size(), 4 * groups.size());
    EXPECT_THAT(line, testing::Contains(testing::Field(&LinePoint::y, 9)));
    EXPECT_THAT(line, testing::Contains(testing::Field(&LinePoint::y, -9)));
    for (std::size_t i = 1; i < line.size(); ++i) {
        ASSERT_LE(line[i - 1].x, line[i].x);
    }
    const auto band = band_of(x, y, y, groups);
    EXPECT_EQ(band.size(), groups.size());
    EXPECT_THAT(band, testing::Contains(
                          testing::AllOf(testing::Field(&BandPoint::low, -9), testing::Field(&BandPoint::high, 9))));
}

TEST_F(LongSeries, ShowsEveryNumberWhenZoomedIn) {
    const auto groups = groups_of(x, {1000.5, 1010.5}, 500);
    ASSERT_EQ(groups.size(), 12u) << "ten, and one on either side so that the line reaches the edge";
    EXPECT_EQ(x[groups.front().begin], 1000);
    EXPECT_EQ(x[groups.back().begin], 1011);
    EXPECT_EQ(line_of(x, y, groups).size(), 12u);
}

TEST(Lines, AreSplitWhereANumberIsMissing) {
    const std::vector<double> x{1, 2, 3, 4}, y{5, none, 6, 7};
    const auto line = line_of(x, y, groups_of(x, {1, 4}, 100));
    ASSERT_EQ(line.size(), 4u);
    EXPECT_TRUE(std::isnan(line[1].y));
    EXPECT_EQ(line[2].y, 6);
    EXPECT_TRUE(line_of(x, std::vector<double>(4, none), groups_of(x, {1, 4}, 100)).empty());
    EXPECT_TRUE(groups_of({}, {0, 1}, 100).empty());
}

TEST(Lines, MeansIgnoreMissingNumbers) {
    const std::vector<double> y{5, none, 7};
    EXPECT_EQ(mean_of(y, {0, 3}), 6);
    EXPECT_EQ(mean_of(y, {1, 2}), 0);
}

TEST(Nearest, IsFoundOnBothSides) {
    const std::vector<double> x{1, 2, 10};
    EXPECT_EQ(nearest(x, -5), 0u);
    EXPECT_EQ(nearest(x, 1.4), 0u);
    EXPECT_EQ(nearest(x, 1.6), 1u);
    EXPECT_EQ(nearest(x, 7), 2u);
    EXPECT_EQ(nearest(x, 99), 2u);
    EXPECT_EQ(nearest({}, 1), std::nullopt);
}

TEST(Histogram, CountsEachNumberOnce) {
    EXPECT_THAT(histogram(std::vector<float>{0, 0.5f, 1, 2.5f, 4, 5}, {0, 4}, 4), ElementsAre(2, 1, 1, 1));
    EXPECT_THAT(histogram(std::vector<float>{3, 3, 4}, {3, 3}, 2), ElementsAre(2, 0));
}

TEST(RunningMeans, UseTheNumbersBeforeAndNoneAfter) {
    EXPECT_THAT(running_mean(std::vector<double>{1, 2, 3, 10}, 3), ElementsAre(1, 1.5, 2, 5));
    EXPECT_THAT(running_mean(std::vector<double>{1, 2, 3}, 1), ElementsAre(1, 2, 3));
    const auto means = running_mean(std::vector<double>{4, none, 8}, 2);
    EXPECT_EQ(means[0], 4);
    EXPECT_TRUE(std::isnan(means[1])) << "no generation, no mean";
    EXPECT_EQ(means[2], 8);
    EXPECT_TRUE(running_mean({}, 5).empty());
}

TEST(MarkGroups, JoinNearMarksAndOmitHiddenOnes) {
    const std::vector<Mark> marks{{1, ""}, {10, ""}, {10, ""}, {12, ""}, {14, ""}, {90, ""}};
    const auto groups = mark_groups(marks, {5, 50}, 4);
    ASSERT_EQ(groups.size(), 2u);
    EXPECT_EQ(groups[0].begin, 1u);
    EXPECT_EQ(groups[0].end, 4u) << "10, 10 and 12";
    EXPECT_EQ(groups[1].begin, 4u);
    EXPECT_EQ(groups[1].end, 5u);
    EXPECT_TRUE(mark_groups({}, {0, 1}, 1).empty());
}

TEST(NotePlace, IsBesideThePlotAndInTheWindow) {
    const Corner window{1280, 720};
    const auto covers = [&](Box plot, Corner size, float y) {
        const Corner at = note_place(plot, size, y, window);
        EXPECT_GE(at.x, 0);
        EXPECT_GE(at.y, 0);
        return at.x < plot.right && at.x + size.x > plot.left && at.y < plot.bottom && at.y + size.y > plot.top;
    };
    EXPECT_EQ(note_place({890, 400, 1268, 680}, {250, 120}, 500, window), (Corner{636, 440})) << "on the left";
    EXPECT_EQ(note_place({100, 400, 500, 680}, {250, 120}, 500, window), (Corner{504, 440})) << "or on the right";
    EXPECT_EQ(note_place({100, 400, 1200, 680}, {250, 120}, 500, window), (Corner{100, 276})) << "or above";
    EXPECT_EQ(note_place({100, 20, 1200, 300}, {250, 120}, 150, window), (Corner{100, 304})) << "or below";
    EXPECT_EQ(note_place({0, 0, 1280, 720}, {250, 120}, 150, window), (Corner{0, 600})) << "no room beside it";
    for (const float y : {0.0f, 5.0f, 400.0f, 715.0f}) {
        EXPECT_FALSE(covers({890, 0, 1268, 720}, {250, 120}, y)) << y;
    }
}

} // namespace
} // namespace evod::viewer
