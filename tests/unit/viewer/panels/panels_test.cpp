#include "client/viewer/panels/panels.h"

#include <gtest/gtest.h>

namespace evod::viewer {
namespace {

TEST(Panels, ClosesThePanelUsedLastFirst) {
    Panels panels;
    for (const std::size_t index : {4u, 1u, 2u, 0u}) {
        panels.toggle(index);
    }
    panels.toggle(2); // hidden by its own key
    EXPECT_TRUE(panels.close_front());
    EXPECT_FALSE(panels.shown(0));
    EXPECT_TRUE(panels.close_front());
    EXPECT_FALSE(panels.shown(1));
    EXPECT_TRUE(panels.shown(4));
    EXPECT_TRUE(panels.close_front());
    EXPECT_FALSE(panels.close_front());
}

TEST(Panels, VisiblePanelsSurviveANewSession) {
    Panels panels;
    panels.toggle(3);
    panels.show(panels.titles()[1]);
    panels.begin_session();
    EXPECT_TRUE(panels.close_front());
    EXPECT_FALSE(panels.shown(1));
    EXPECT_TRUE(panels.shown(3));
}

} // namespace
} // namespace evod::viewer
