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

TEST(FreePlaces, AreAtTheSidesAndCoverNothing) {
    const Rectangle room{0, 50, 1000, 600};
    std::vector<Rectangle> taken;
    const auto add = [&](PlaceWanted wanted) {
        const auto place = free_place(wanted, room, taken, 10);
        taken.push_back(place.value_or(Rectangle{}));
        return place;
    };
    EXPECT_EQ(add({300, 250, true}), (Rectangle{690, 60, 300, 250}));
    EXPECT_EQ(add({200, 400, false}), (Rectangle{10, 60, 200, 400}));
    EXPECT_EQ(add({300, 300, true}), (Rectangle{690, 320, 300, 300})) << "below the first";
    EXPECT_EQ(add({200, 300, true}), (Rectangle{220, 60, 200, 300})) << "further in, because that is nearer to a side";
    EXPECT_EQ(add({250, 250, false}), (Rectangle{220, 370, 250, 250})) << "below that";
    EXPECT_EQ(add({400, 300, true}), std::nullopt);
    EXPECT_EQ(add({990, 300, true}), std::nullopt) << "wider than the room";
}

TEST(FreePlaces, ALargeScreenFitsSeveralPanels) {
    const Rectangle room = viewport_of(below_panel_strip(3840, 2160, 2), 2);
    std::vector<Rectangle> taken;
    for (const PlaceWanted& wanted : {PlaceWanted{920, 840, true},
                                      {800, 560, false},
                                      {1120, 1200, true},
                                      {760, 960, false},
                                      {760, 960, true},
                                      {1120, 920, false}}) {
        const auto place = free_place(wanted, room, taken, 16);
        ASSERT_TRUE(place) << taken.size();
        for (const Rectangle& other : taken) {
            EXPECT_TRUE(place->left >= other.left + other.width || other.left >= place->left + place->width ||
                        place->top >= other.top + other.height || other.top >= place->top + place->height);
        }
        taken.push_back(*place);
    }
}

} // namespace
} // namespace evod::viewer
