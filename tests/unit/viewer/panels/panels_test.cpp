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

TEST(Panels, EachPanelKeyShowsAPanelOrLeadsToThePage) {
    const Panels panels;
    for (unsigned key = 2; key <= 11; ++key) {
        EXPECT_NE(panels.panel_at(key).has_value(), !page_panel_at(key).empty()) << "F" << key;
    }
    EXPECT_EQ(panels.panel_at(4), 2u);
    EXPECT_EQ(panels.key_of(2), "F4");
    EXPECT_EQ(panels.panel_at(12), std::nullopt);
}

} // namespace
} // namespace evod::viewer
