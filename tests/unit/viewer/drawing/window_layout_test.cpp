#include "client/viewer/drawing/window_layout.h"

#include <gtest/gtest.h>

namespace evod::viewer {
namespace {

TEST(Layout, TilesAreAsLargeAsPossible) {
    // Eight islands of 16:9: in 1280 × 650, three in a row are 425 wide and 214 high; four would be smaller.
    const auto wide = in_tiles({0, 38, 1280, 650}, 8, 16.0 / 9);
    ASSERT_EQ(wide.size(), 8u);
    EXPECT_EQ(wide[1].left, wide[0].left + wide[0].width + gap_pixels);
    EXPECT_EQ(wide[2].top, wide[0].top);
    EXPECT_EQ(wide[3].top, wide[0].top + wide[0].height + gap_pixels);
    EXPECT_EQ(wide[3].left, wide[0].left);
    // Square islands in a narrow, high place are stacked.
    const auto high = in_tiles({0, 0, 200, 1000}, 4, 1);
    EXPECT_EQ(high[3].left, 0);
    EXPECT_GT(high[3].top, high[2].top);
}

TEST(Layout, TilesStayInsideAndDoNotOverlap) {
    const Rectangle place{7, 38, 801, 453};
    for (const std::size_t count : {1u, 2u, 3u, 5u, 8u, 13u, 64u}) {
        const auto all = in_tiles(place, count, 1.5);
        ASSERT_EQ(all.size(), count);
        for (std::size_t i = 0; i < count; ++i) {
            EXPECT_GE(all[i].left, place.left);
            EXPECT_GE(all[i].top, place.top);
            EXPECT_LE(all[i].left + all[i].width, place.left + place.width);
            EXPECT_LE(all[i].top + all[i].height, place.top + place.height);
            for (std::size_t j = 0; j < i; ++j) {
                const bool apart = all[j].left + all[j].width <= all[i].left ||
                                   all[i].left + all[i].width <= all[j].left ||
                                   all[j].top + all[j].height <= all[i].top || all[i].top + all[i].height <= all[j].top;
                EXPECT_TRUE(apart) << i << " and " << j << " of " << count;
            }
        }
    }
}

TEST(Layout, TheSidebarLeavesRoomForTheWorld) {
    EXPECT_EQ(sidebar_pixels(1280), 400);
    EXPECT_EQ(sidebar_pixels(3840, 2), 800);
    EXPECT_EQ(sidebar_pixels(200), 110);
}

} // namespace
} // namespace evod::viewer
