#include "client/viewer/world/healthiest.h"

#include "tests/unit/codec/px_column.h"

#include <gtest/gtest.h>

#include <initializer_list>
#include <memory>
#include <numeric>
#include <vector>

namespace evod::viewer {
namespace {

TEST(Healthiest, AreOrderedByHealthThenById) {
    const auto snapshot = codec::snapshot_with(
        {.id = {1, 3, 7}, .x = {}, .y = {}, .width = {}, .height = codec::px_column({50, 80, 80})});
    EXPECT_EQ(healthiest(snapshot->organisms, 2), (std::vector<std::size_t>{1, 2}));
    EXPECT_EQ(healthiest(snapshot->organisms, 9), (std::vector<std::size_t>{1, 2, 0}));
}

TEST(HealthRanking, FollowsTheSnapshot) {
    const auto snapshot_of = [](std::initializer_list<float> health) {
        auto snapshot = std::make_shared<codec::ReceivedSnapshot>();
        codec::Column ids(health.size());
        std::iota(ids.begin(), ids.end(), 0U);
        snapshot->entities =
            codec::snapshot_with({.id = ids, .x = {}, .y = {}, .width = {}, .height = codec::px_column(health)});
        return snapshot;
    };
    HealthRanking ranking;
    const auto of = [&](const std::shared_ptr<const codec::ReceivedSnapshot>& snapshot, std::size_t count) {
        const auto indices = ranking.of(snapshot, count);
        return std::vector<std::size_t>{indices.begin(), indices.end()};
    };
    const auto two = snapshot_of({1, 2}), six = snapshot_of({9, 1, 3, 5, 7, 2});
    EXPECT_TRUE(of(nullptr, 3).empty());
    EXPECT_EQ(of(two, 3), (std::vector<std::size_t>{1, 0}));
    EXPECT_EQ(of(six, HealthRanking::named_count), (std::vector<std::size_t>{0, 4, 3}));
    EXPECT_EQ(of(six, HealthRanking::ranked_count), (std::vector<std::size_t>{0, 4, 3, 2, 5}));
    EXPECT_TRUE(of(nullptr, 3).empty());
}

} // namespace
} // namespace evod::viewer
