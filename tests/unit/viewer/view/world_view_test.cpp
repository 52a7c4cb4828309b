#include "client/viewer/view/world_view.h"

#include "client/viewer/drawing/window_layout.h"
#include "tests/unit/core/fake_server.h"

#include <gtest/gtest.h>

namespace evod::viewer {
namespace {

TEST(WorldView, HasOneTileUntilAllIslandsAreShown) {
    core::FakeServer server;
    WorldView view{{.connection = server.options(), .world = "default", .island = 2}};
    view.lay_out({0, 0, 1000, 600}, true, 1);
    EXPECT_EQ(view.place(), (Rectangle{0, 0, 1000, 600}));
    EXPECT_EQ(view.timeline_place().height, 0) << "a live world has no time line";
    ASSERT_EQ(view.tiles().size(), 1u);
    EXPECT_EQ(view.tiles()[0].island, 2u);
    EXPECT_EQ(view.camera().viewport(), viewport_of(1000, 600));
    EXPECT_EQ(&view.camera_at({500, 300}), &view.camera());
    EXPECT_EQ(&view.camera_at({-5, -5}), &view.camera());
    EXPECT_EQ(&view.island_view_of(view.tiles()[0]), &view.island_view);
}

} // namespace
} // namespace evod::viewer
