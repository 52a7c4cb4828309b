#include "server/streaming/subscription.h"

#include <gtest/gtest.h>

namespace evod::streaming {
namespace {

TEST(Subscription, WithoutFieldsIsPlainAndOfAllIslands) {
    const SnapshotSubscription subscription = to_subscription({}, "w", 7, 60);
    EXPECT_EQ(subscription.world, "w");
    EXPECT_EQ(subscription.island, std::nullopt);
    EXPECT_EQ(subscription.island_count, 7u);
    EXPECT_EQ(subscription.rate_hz, 60);
    EXPECT_EQ(subscription.codec, v1::CODEC_PLAIN);
    EXPECT_EQ(subscription.unacknowledged_max, std::nullopt);
    EXPECT_EQ(subscription.form(), Form::Plain);
    EXPECT_FALSE(subscription.view);
    EXPECT_FALSE(subscription.bandwidth);
}

TEST(Subscription, GetsHeadingsAndSpeciesOnlyOnRequest) {
    v1::SubscribeSnapshots request;
    EXPECT_EQ(to_subscription(request, "w", 1, 60).with, OptionalColumns{});
    request.set_headings(true);
    EXPECT_EQ(to_subscription(request, "w", 1, 60).with, OptionalColumns{.headings = true});
    request.set_species(true);
    EXPECT_EQ(to_subscription(request, "w", 1, 60).with, (OptionalColumns{.headings = true, .species = true}));
}

TEST(Subscription, OfOneIslandCountsOne) {
    v1::SubscribeSnapshots request;
    request.set_island(0);
    request.set_unacknowledged_max(0);
    const SnapshotSubscription subscription = to_subscription(request, "w", 7, 60);
    EXPECT_EQ(subscription.island, 0u);
    EXPECT_EQ(subscription.island_count, 1u);
    EXPECT_EQ(subscription.unacknowledged_max, 0u);
}

TEST(Subscription, DeltasWithAViewAreTiles) {
    v1::SubscribeSnapshots request;
    request.set_codec(v1::CODEC_DELTA);
    EXPECT_EQ(to_subscription(request, "w", 1, 60).form(), Form::Whole);
    request.mutable_view();
    const SnapshotSubscription subscription = to_subscription(request, "w", 1, 60);
    EXPECT_EQ(subscription.form(), Form::Tiles);
    EXPECT_EQ(subscription.view->detail(), v1::DETAIL_FULL) << "the detail of a view that names none";
    EXPECT_FALSE(subscription.bandwidth);
}

TEST(Subscription, AViewMayLimitTheBandwidthForATime) {
    SnapshotSubscription subscription;
    v1::View view;
    view.set_bytes_per_s_max(10'000);
    subscription.set_view(view);
    EXPECT_TRUE(subscription.bandwidth);
    view.clear_bytes_per_s_max();
    subscription.set_view(view);
    EXPECT_FALSE(subscription.bandwidth);
}

} // namespace
} // namespace evod::streaming
