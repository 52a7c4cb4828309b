#include "client/viewer/island/labels.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace evod::viewer {
namespace {

constexpr Rectangle walls{0, 0, 1'000, 1'000};
constexpr double height = 14;

std::vector<Point> placed(const std::vector<HealthLabel>& labels) {
    return place_labels(labels, height, walls);
}

TEST(Labels, AreCentredAboveTheirOrganisms) {
    EXPECT_THAT(placed({{{500, 300}, 10, 24}}), testing::ElementsAre(Point{488, 275}));
}

TEST(Labels, StayInsideTheWalls) {
    const auto corners = placed({{{5, 5}, 10, 24}, {{995, 500}, 10, 24}});
    EXPECT_EQ(corners[0], (Point{1, 16})) << "below, and beside the left wall";
    EXPECT_EQ(corners[1], (Point{975, 475}));
}

TEST(Labels, MoveBelowWhereTheyWouldOverlap) {
    const auto corners = placed({{{500, 300}, 10, 24}, {{510, 304}, 10, 24}, {{600, 300}, 10, 24}});
    EXPECT_EQ(corners[0].y, 275);
    EXPECT_EQ(corners[1].y, 315);
    EXPECT_EQ(corners[2].y, 275) << "far from the others";
}

TEST(Labels, AreAboveIfBothPlacesOverlap) {
    const auto corners = placed({{{500, 300}, 10, 24}, {{505, 300}, 10, 24}, {{510, 300}, 10, 24}});
    EXPECT_EQ(corners[1].y, 311);
    EXPECT_EQ(corners[2].y, 275);
}

TEST(Labels, OfADenseCrowdOverlapLessThanWithoutPlacing) {
    std::vector<HealthLabel> labels;
    for (int i = 0; i < 60; ++i) {
        labels.push_back({{30.0 + 15 * i, 500}, 10, 24});
    }
    const auto corners = placed(labels);
    std::size_t overlaps = 0;
    for (std::size_t i = 1; i < corners.size(); ++i) {
        overlaps += corners[i].y == corners[i - 1].y && corners[i].x - corners[i - 1].x < 24;
    }
    EXPECT_EQ(overlaps, 0u) << "they alternate between above and below";
}

} // namespace
} // namespace evod::viewer
