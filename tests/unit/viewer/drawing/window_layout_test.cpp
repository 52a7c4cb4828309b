#include "client/viewer/drawing/window_layout.h"

#include <gtest/gtest.h>

namespace evod::viewer {
namespace {

TEST(Layout, OneWorldHasTheWholeWindow) {
    const auto columns = side_by_side({0, 0, 1281, 720}, 1);
    ASSERT_EQ(columns.size(), 1u);
    EXPECT_EQ(columns[0].width, 1281);
    EXPECT_EQ(columns[0].height, 720);
}

TEST(Layout, TwoWorldsShareTheWidthInWholePixels) {
    const auto columns = side_by_side({0, 10, 1281, 720}, 2);
    ASSERT_EQ(columns.size(), 2u);
    EXPECT_EQ(columns[0].left, 0);
    EXPECT_EQ(columns[0].width, 639);
    EXPECT_EQ(columns[1].left, 639 + gap_pixels);
    EXPECT_EQ(columns[1].left + columns[1].width, 1281);
    EXPECT_EQ(columns[1].top, 10);
    EXPECT_EQ(columns[1].height, 720);
}

TEST(Layout, ATinyWindowGivesEveryWorldAPixel) {
    for (const Rectangle& column : side_by_side({0, 0, 1, 1}, 2)) {
        EXPECT_GE(column.width, 1);
    }
}

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

TEST(Layout, TheSidebarIsNeitherNarrowNorMostOfTheWindow) {
    EXPECT_EQ(sidebar_pixels(400, 1280), 400);
    EXPECT_EQ(sidebar_pixels(1, 1280), sidebar_width_min);
    EXPECT_EQ(sidebar_pixels(900, 1280), 704);
    EXPECT_EQ(sidebar_pixels(800, 3840, 2), 800);
    EXPECT_EQ(sidebar_pixels(1, 3840, 2), 2 * sidebar_width_min);
    EXPECT_LT(sidebar_pixels(400, 200), 200) << "narrower than the minimum, so that the world keeps its share";
}

} // namespace
} // namespace evod::viewer
