#include "client/viewer/island/labels.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <vector>

namespace evod::viewer {
namespace {

constexpr Rectangle walls{0, 0, 1'000, 1'000};
constexpr double height = 14;

std::vector<std::optional<Point>> placed(const std::vector<HealthLabel>& labels,
                                         const std::vector<HealthLabel>& organisms = {}) {
    return place_labels(labels, organisms, height, walls);
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
    EXPECT_EQ(corners[0]->y, 275);
    EXPECT_EQ(corners[1]->y, 315);
    EXPECT_EQ(corners[2]->y, 275) << "far from the others";
}

TEST(Labels, AreLeftOutIfOthersAreAtBothPlaces) {
    const auto corners = placed({{{500, 300}, 10, 24}, {{505, 300}, 10, 24}, {{510, 300}, 10, 24}});
    EXPECT_EQ(corners[1]->y, 311);
    EXPECT_EQ(corners[2], std::nullopt);
}

TEST(Labels, MoveBelowWhereTheyWouldCoverAnOrganism) {
    const HealthLabel labelled{{500, 300}, 10, 24}, above{{505, 280}, 10, 0}, below{{505, 320}, 10, 0};
    EXPECT_EQ(placed({labelled}, {labelled, above})[0]->y, 311);
    EXPECT_EQ(placed({labelled}, {labelled, below})[0]->y, 275);
    EXPECT_EQ(placed({labelled}, {labelled, above, below})[0]->y, 275) << "above if both places are taken";
}

TEST(Labels, OfADenseCrowdNeverOverlap) {
    std::vector<HealthLabel> labels;
    for (int i = 0; i < 60; ++i) {
        labels.push_back({{30.0 + 15 * i, 500}, 10, 24});
    }
    const auto corners = placed(labels);
    std::size_t placed_count = 0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        placed_count += corners[i].has_value();
        for (std::size_t k = 0; k < i && corners[i]; ++k) {
            EXPECT_FALSE(corners[k] && corners[i]->y == corners[k]->y && corners[i]->x - corners[k]->x < 24);
        }
    }
    EXPECT_GE(placed_count, 50u) << "they alternate between above and below";
}

} // namespace
} // namespace evod::viewer
