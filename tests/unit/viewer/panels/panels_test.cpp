#include "client/viewer/panels/panels.h"

#include "client/viewer/panels/page_panels.h"

#include <gtest/gtest.h>

namespace evod::viewer {
namespace {

TEST(Panels, TheSidebarShowsThePanelOfTheChosenTab) {
    Panels panels;
    EXPECT_TRUE(panels.shown(2)) << "Parameters, until the user chooses another tab";
    panels.show(4);
    EXPECT_TRUE(panels.shown(4));
    EXPECT_FALSE(panels.shown(2));
    panels.show("Worlds");
    EXPECT_TRUE(panels.shown(0));
    panels.show("no such panel");
    EXPECT_TRUE(panels.shown(0));
}

TEST(Panels, ACollapsedSidebarOpensForAPanel) {
    Panels panels;
    panels.toggle_sidebar();
    EXPECT_FALSE(panels.shown(2));
    EXPECT_EQ(panels.width(1280, 1), sidebar_collapsed);
    panels.show(3);
    EXPECT_TRUE(panels.shown(3));
    EXPECT_EQ(panels.width(1280, 1), sidebar_width);
}

TEST(Panels, ClosesTheDetachedPanelUsedLastFirst) {
    Panels panels;
    for (const std::size_t index : {4u, 1u}) {
        panels.set_detached(index, true);
    }
    panels.show(4);
    EXPECT_TRUE(panels.close_front());
    EXPECT_TRUE(panels.shown(4)) << "in the sidebar";
    EXPECT_TRUE(panels.shown(1)) << "still detached";
    EXPECT_TRUE(panels.close_front());
    EXPECT_FALSE(panels.close_front());
    EXPECT_TRUE(panels.shown(1));
    EXPECT_FALSE(panels.shown(4));
}

TEST(Panels, TheSidebarLeavesRoomForTheWorlds) {
    Panels panels;
    panels.set({.width = 3000});
    EXPECT_EQ(panels.width(1000, 1), 550);
    panels.set({.width = 10});
    EXPECT_EQ(panels.width(1280, 2), 2 * sidebar_width_min);
}

TEST(Panels, EachPanelKeyShowsAPanelOrLeadsToThePage) {
    const Panels panels;
    for (unsigned key = 2; key <= 11; ++key) {
        EXPECT_NE(panels.panel_at(key).has_value(), !page_panel_at(key).empty()) << "F" << key;
    }
    EXPECT_EQ(panels.panel_at(4), 2u);
    EXPECT_EQ(panels.key_of(2), "F4");
    EXPECT_EQ(panels.key_of(*panels.panel_at(10)), "F10") << "panels after one that is in the page keep their keys";
    EXPECT_EQ(panels.panel_at(12), std::nullopt);
}

TEST(Panels, AnUnknownStoredTabIsTheFirst) {
    Panels panels;
    panels.set({.tab = "no such panel"});
    EXPECT_TRUE(panels.shown(0));
}

TEST(Panels, TabAndDetachedPanelsSurviveANewSession) {
    Panels panels;
    panels.set_detached(1, true);
    panels.show(3);
    panels.begin_session();
    EXPECT_TRUE(panels.shown(1));
    EXPECT_TRUE(panels.shown(3));
    EXPECT_TRUE(panels.close_front());
}

} // namespace
} // namespace evod::viewer
