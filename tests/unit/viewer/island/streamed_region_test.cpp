#include "client/viewer/island/streamed_region.h"

#include <gtest/gtest.h>

namespace evod::viewer {
namespace {

using namespace std::chrono_literals;

struct StreamedRegionTest : testing::Test {
    StreamedRegionTest() {
        camera.set_viewport({0, 0, 1000, 500});
        camera.set_island(100'000, 50'000);
        camera.zoom_at({500, 250}, 100); // the middle 1000 px
        camera.zoom_at({500, 250}, 1000 / camera.visible().height / 2);
    }
    std::optional<evod::v1::View> update(std::chrono::milliseconds after,
                                         evod::v1::Detail detail = evod::v1::DETAIL_FULL) {
        return region.update(camera, detail, StreamedRegion::Clock::time_point{} + 10s + after);
    }
    static bool covers(const evod::v1::Region& region, const Rectangle& seen) {
        return region.left_px() <= seen.left && region.top_px() <= seen.top &&
               region.left_px() + region.width_px() >= seen.left + seen.width &&
               region.top_px() + region.height_px() >= seen.top + seen.height;
    }
    Camera camera;
    StreamedRegion region;
};

TEST_F(StreamedRegionTest, IsLargerThanTheVisiblePart) {
    const auto view = update(0ms);
    ASSERT_TRUE(view);
    EXPECT_EQ(view->detail(), evod::v1::DETAIL_FULL);
    EXPECT_TRUE(covers(view->region(), camera.visible()));
    EXPECT_LE(view->region().width_px(), 2.1 * camera.visible().width);
    EXPECT_FALSE(update(1s));
    camera.pan({100, 0}); // still inside
    EXPECT_FALSE(update(2s));
}

TEST_F(StreamedRegionTest, FollowsTheCameraAtALimitedRate) {
    ASSERT_TRUE(update(0ms));
    camera.pan({10'000, 0});
    EXPECT_FALSE(update(StreamedRegion::interval / 2));
    camera.pan({10'000, 0});
    const auto view = update(StreamedRegion::interval);
    ASSERT_TRUE(view) << "the last position is requested in the end";
    EXPECT_TRUE(covers(view->region(), camera.visible()));
}

TEST_F(StreamedRegionTest, ChangesWithTheDetailAndShrinksAfterZoomingIn) {
    ASSERT_TRUE(update(0ms));
    const auto density = update(1s, evod::v1::DETAIL_DENSITY);
    ASSERT_TRUE(density);
    EXPECT_EQ(density->detail(), evod::v1::DETAIL_DENSITY);
    camera.zoom_at({500, 250}, 2);
    EXPECT_FALSE(update(2s, evod::v1::DETAIL_DENSITY));
    camera.zoom_at({500, 250}, 4);
    const auto less = update(3s, evod::v1::DETAIL_DENSITY);
    ASSERT_TRUE(less);
    EXPECT_LT(less->region().width_px(), density->region().width_px() / 4);
}

} // namespace
} // namespace evod::viewer
