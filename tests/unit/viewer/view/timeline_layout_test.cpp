#include "client/viewer/view/timeline_layout.h"

#include <gmock/gmock.h>

namespace evod::viewer {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(TimeScale, TheEndsOfTheLineAreTheFirstAndLastTick) {
    const TimeScale scale{.first_tick = 100, .last_tick = 500, .left = 10, .width = 200};
    EXPECT_EQ(scale.x_of(100), 10);
    EXPECT_EQ(scale.x_of(500), 210);
    EXPECT_EQ(scale.x_of(300), 110);
    EXPECT_EQ(scale.tick_at(10), 100u);
    EXPECT_EQ(scale.tick_at(210), 500u);
    EXPECT_EQ(scale.tick_at(110.2), 300u) << "the nearest tick";
}

TEST(TimeScale, ClampsBeyondTheEnds) {
    const TimeScale scale{.first_tick = 100, .last_tick = 500, .left = 10, .width = 200};
    EXPECT_EQ(scale.x_of(7), 10);
    EXPECT_EQ(scale.x_of(1000), 210);
    EXPECT_EQ(scale.tick_at(-5), 100u);
    EXPECT_EQ(scale.tick_at(5000), 500u);
}

TEST(TimeScale, EveryTickIsFoundAtItsPixel) {
    const TimeScale scale{.first_tick = 3, .last_tick = 1003, .left = 18, .width = 764.5};
    for (std::uint64_t tick = 3; tick <= 1003; ++tick) {
        EXPECT_EQ(scale.tick_at(scale.x_of(tick)), tick);
    }
}

TEST(TimeScale, ARunOfOneTickIsAtTheLeft) {
    const TimeScale scale{.first_tick = 5, .last_tick = 5, .left = 10, .width = 200};
    EXPECT_EQ(scale.x_of(5), 10);
    EXPECT_EQ(scale.tick_at(150), 5u);
}

TEST(MarkedGenerations, AreRoundNumbersUpToTheMaximumCount) {
    EXPECT_THAT(marked_generations(1, 4, 8), ElementsAre(1, 2, 3, 4));
    EXPECT_THAT(marked_generations(1, 9, 4), ElementsAre(2, 4, 6, 8));
    EXPECT_THAT(marked_generations(1, 100, 5), ElementsAre(20, 40, 60, 80, 100));
    EXPECT_THAT(marked_generations(990, 1010, 2), ElementsAre(1000));
    EXPECT_THAT(marked_generations(1, 4, 0), IsEmpty());
    for (const std::size_t count_max : {1u, 2u, 3u, 7u, 12u}) {
        for (const std::uint64_t last : {1u, 2u, 30u, 999u, 123'456u}) {
            EXPECT_LE(marked_generations(1, last, count_max).size(), count_max) << last;
        }
    }
}

TEST(Labels, AreOmittedWhereTheyWouldOverlap) {
    const std::vector<Label> labels{{10, 20}, {25, 20}, {33, 10}, {40, 10}, {50, 30}};
    EXPECT_THAT(separate_labels(labels, 3), ElementsAre(0, 2, 4));
    EXPECT_THAT(separate_labels({}, 3), IsEmpty());
}

} // namespace
} // namespace evod::viewer
