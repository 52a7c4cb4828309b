#include "client/viewer/island/minimap.h"

#include <gtest/gtest.h>

namespace evod::viewer {
namespace {

TEST(Minimap, IsInTheLowerRightCornerInTheIslandsShape) {
    const MinimapPlace place = minimap_place({0, 40, 1000, 600}, 40'000, 10'000);
    EXPECT_DOUBLE_EQ(place.screen.width, MinimapPlace::side_pixels_max);
    EXPECT_DOUBLE_EQ(place.screen.height, MinimapPlace::side_pixels_max / 4);
    EXPECT_DOUBLE_EQ(place.screen.left + place.screen.width, 1000 - MinimapPlace::margin_pixels);
    EXPECT_DOUBLE_EQ(place.screen.top + place.screen.height, 640 - MinimapPlace::margin_pixels);
}

TEST(Minimap, GrowsWithTheScale) {
    const MinimapPlace place = minimap_place({0, 40, 1000, 600}, 40'000, 10'000, 2);
    EXPECT_DOUBLE_EQ(place.screen.width, 2 * MinimapPlace::side_pixels_max);
    EXPECT_DOUBLE_EQ(place.screen.left + place.screen.width, 1000 - 2 * MinimapPlace::margin_pixels);
    EXPECT_NEAR(place.to_world(place.screen.centre()).x, 20'000, 1e-9);
}

TEST(Minimap, ConvertsBetweenItsPointsAndTheWorlds) {
    const MinimapPlace place = minimap_place({0, 40, 1000, 600}, 10'000, 20'000);
    EXPECT_EQ(place.to_world({place.screen.left, place.screen.top}), (Point{0, 0}));
    const Point there = place.to_world(place.screen.centre());
    EXPECT_NEAR(there.x, 5'000, 1e-9);
    EXPECT_NEAR(there.y, 10'000, 1e-9);
    const Point back = place.to_screen(there);
    EXPECT_NEAR(back.x, place.screen.centre().x, 1e-9);
    EXPECT_NEAR(back.y, place.screen.centre().y, 1e-9);
}

TEST(Minimap, ClipsTheVisiblePartAtTheWalls) {
    const MinimapPlace place = minimap_place({0, 0, 1000, 600}, 18'000, 18'000); // 100 px per pixel
    const Rectangle frame = place.visible_part({-5'000, 9'000, 10'000, 90'000});
    EXPECT_NEAR(frame.left, place.screen.left, 1e-9);
    EXPECT_NEAR(frame.width, 50, 1e-9);
    EXPECT_NEAR(frame.top, place.screen.top + 90, 1e-9);
    EXPECT_NEAR(frame.height, 90, 1e-9);
}

TEST(Minimap, IsHiddenWhenTheWholeIslandIsVisible) {
    Camera camera;
    camera.set_viewport({0, 0, 1000, 600});
    camera.set_island(2'000, 1'000);
    EXPECT_TRUE(is_whole_island_visible(camera, 2'000, 1'000));
    camera.zoom_at({500, 300}, 2);
    EXPECT_FALSE(is_whole_island_visible(camera, 2'000, 1'000));
}

} // namespace
} // namespace evod::viewer
