#include "client/viewer/drawing/camera.h"

#include <gmock/gmock.h>
#include <rapidcheck/gtest.h>

namespace evod::viewer {
namespace {

using testing::DoubleNear;

constexpr Rectangle viewport{0, 40, 1280, 640};

Camera fitted(double width, double height) {
    Camera camera;
    camera.set_viewport(viewport);
    camera.set_island(width, height);
    return camera;
}

void expect_near(Point a, Point b, double tolerance) {
    EXPECT_THAT(a.x, DoubleNear(b.x, tolerance));
    EXPECT_THAT(a.y, DoubleNear(b.y, tolerance));
}

TEST(Camera, CentresTheFittedIslandInTheViewport) {
    const Camera camera = fitted(1280, 720);
    EXPECT_DOUBLE_EQ(camera.zoom(), (640 - 2 * (6 + 6)) / 720.0); // the height limits the zoom
    expect_near(camera.to_screen({640, 360}), {640, 360}, 1e-9);
    EXPECT_GE(camera.to_screen({0, 0}).y - Camera::wall_pixels, viewport.top);
    EXPECT_LE(camera.to_screen({1280, 720}).y + Camera::wall_pixels, viewport.top + viewport.height);
}

TEST(Camera, FitsTheWidthOfAWideIsland) {
    EXPECT_DOUBLE_EQ(fitted(10'000, 100).zoom(), (1280 - 24) / 10'000.0);
}

TEST(Camera, StaysFittedThroughResizesUntilMoved) {
    Camera camera = fitted(1280, 720);
    camera.set_viewport({0, 40, 640, 320});
    EXPECT_DOUBLE_EQ(camera.zoom(), (320 - 24) / 720.0);
    camera.pan({10, 0});
    const double zoom = camera.zoom();
    camera.set_viewport(viewport);
    EXPECT_DOUBLE_EQ(camera.zoom(), zoom);
    EXPECT_FALSE(camera.fitted());
    camera.fit();
    EXPECT_DOUBLE_EQ(camera.zoom(), (640 - 24) / 720.0);
}

TEST(Camera, FitsANewIslandSizeButNotTheSameSize) {
    Camera camera = fitted(1280, 720);
    camera.zoom_at({100, 100}, 3);
    const Point centre = camera.centre();
    camera.set_island(1280, 720);
    EXPECT_EQ(camera.centre(), centre);
    camera.set_island(2000, 2000);
    EXPECT_TRUE(camera.fitted());
    EXPECT_EQ(camera.centre(), (Point{1000, 1000}));
}

TEST(Camera, APanMovesTheIslandByThatManyPixels) {
    Camera camera = fitted(1280, 720);
    camera.zoom_at({640, 360}, 4);
    const Point before = camera.to_screen({600, 300});
    camera.pan({25, -10});
    expect_near(camera.to_screen({600, 300}), {before.x + 25, before.y - 10}, 1e-9);
}

TEST(Camera, TheViewportStaysOnTheIsland) {
    Camera camera = fitted(1280, 720);
    camera.pan({1e7, -1e7});
    EXPECT_EQ(camera.centre(), (Point{640, 360})) << "the whole island is visible";
    camera.zoom_at({640, 360}, 4);
    camera.pan({1e7, -1e7});
    const double around = (Camera::wall_pixels + Camera::margin_pixels) / camera.zoom();
    expect_near({camera.visible().left, camera.visible().top + camera.visible().height}, {-around, 720 + around}, 1e-9);
    camera.set_viewport({0, 0, 300, 300});
    camera.pan({0, 1e7});
    camera.set_viewport(viewport);
    EXPECT_GE(camera.visible().top, -around - 1e-9) << "also in a larger window";
}

RC_GTEST_PROP(Camera, ZoomingKeepsThePointUnderTheCursor, ()) {
    Camera camera = fitted(1280, 720);
    const Point cursor{double(*rc::gen::inRange(300, 980)), double(*rc::gen::inRange(200, 500))};
    camera.zoom_at({640, 360}, *rc::gen::inRange(4, 8));
    const Point held = camera.to_world(cursor);
    camera.zoom_at(cursor, *rc::gen::element(0.7, 1.2, 1.9));
    const Rectangle seen = camera.visible();
    // Unless the viewport was clamped to the island.
    RC_PRE(seen.left > 0 && seen.left + seen.width < 1280 && seen.top > 0 && seen.top + seen.height < 720);
    const Point now = camera.to_world(cursor);
    RC_ASSERT(std::abs(now.x - held.x) < 1e-6);
    RC_ASSERT(std::abs(now.y - held.y) < 1e-6);
}

RC_GTEST_PROP(Camera, ScreenAndWorldAreInverse, ()) {
    Camera camera = fitted(*rc::gen::inRange(1, 300'000), *rc::gen::inRange(1, 300'000));
    camera.zoom_at({double(*rc::gen::inRange(0, 1280)), double(*rc::gen::inRange(0, 720))}, *rc::gen::inRange(1, 1000));
    const Point screen{double(*rc::gen::inRange(-100, 1400)), double(*rc::gen::inRange(-100, 800))};
    const Point back = camera.to_screen(camera.to_world(screen));
    RC_ASSERT(std::abs(back.x - screen.x) < 1e-6);
    RC_ASSERT(std::abs(back.y - screen.y) < 1e-6);
}

TEST(Camera, ZoomStaysWithinItsLimits) {
    Camera camera = fitted(1280, 720);
    const double whole = camera.zoom();
    camera.zoom_at({640, 360}, 1e9);
    EXPECT_DOUBLE_EQ(camera.zoom(), Camera::zoom_max);
    camera.zoom_at({640, 360}, 1e-9);
    EXPECT_DOUBLE_EQ(camera.zoom(), whole / 2);
}

TEST(Camera, ReturnsTheVisibleRectangle) {
    Camera camera = fitted(1000, 1000);
    const Rectangle seen = camera.visible();
    EXPECT_TRUE(seen.contains({0, 0}));
    EXPECT_TRUE(seen.contains({1000, 1000}));
    camera.zoom_at(viewport.centre(), 10);
    EXPECT_FALSE(camera.visible().contains({0, 0}));
    EXPECT_TRUE(camera.visible().contains({500, 500}));
}

TEST(Camera, CentresOnAPointOfTheIsland) {
    Camera camera;
    camera.set_viewport({0, 0, 1000, 500});
    camera.set_island(1000, 500);
    camera.zoom_at({500, 250}, 10);
    const double zoom = camera.zoom();
    camera.look_at({100, 200});
    EXPECT_EQ(camera.centre(), (Point{100, 200}));
    EXPECT_EQ(camera.zoom(), zoom);
    EXPECT_FALSE(camera.fitted());
    camera.look_at({3, 500}); // in a corner, which the viewport does not leave
    const double around = (Camera::wall_pixels + Camera::margin_pixels) / zoom;
    expect_near({camera.visible().left, camera.visible().top + camera.visible().height}, {-around, 500 + around}, 1e-9);
}

TEST(CameraScale, WallsAndMarginsGrowWithTheScale) {
    Camera camera;
    camera.set_viewport({0, 0, 1000, 500}, 2);
    camera.set_island(1000, 100);
    EXPECT_DOUBLE_EQ(camera.to_screen({0, 0}).x, 2 * (Camera::wall_pixels + Camera::margin_pixels));
}

} // namespace
} // namespace evod::viewer
