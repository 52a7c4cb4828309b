#include "client/viewer/drawing/widgets.h"

#include <gtest/gtest.h>

namespace evod::viewer {
namespace {

constexpr Point apply{10, 20}, discard{80, 20}; // corners of widgets

TEST(WidgetPositions, TheMouseRestsAfterHalfASecond) {
    WidgetPositions positions;
    EXPECT_FALSE(positions.mouse_rests(apply, 1.0, false));
    EXPECT_FALSE(positions.mouse_rests(apply, 1.2, false));
    EXPECT_FALSE(positions.mouse_rests(apply, 1.4, false));
    EXPECT_TRUE(positions.mouse_rests(apply, 1.6, false));
    EXPECT_FALSE(positions.mouse_rests(discard, 1.7, false)) << "the mouse has just moved there";
}

TEST(WidgetPositions, AfterAClickTheMouseMustLeaveFirst) {
    WidgetPositions positions;
    for (double now_s = 1; now_s < 1.6; now_s += 0.1) {
        positions.mouse_rests(apply, now_s, false);
    }
    EXPECT_TRUE(positions.mouse_rests(apply, 1.6, false));
    EXPECT_FALSE(positions.mouse_rests(apply, 1.7, true));
    for (double now_s = 1.8; now_s < 5; now_s += 0.1) {
        EXPECT_FALSE(positions.mouse_rests(apply, now_s, false)) << now_s;
    }
    positions.mouse_rests(discard, 5, false);
    positions.mouse_rests(apply, 5.1, false);
    positions.mouse_rests(apply, 5.3, false);
    positions.mouse_rests(apply, 5.5, false);
    EXPECT_TRUE(positions.mouse_rests(apply, 5.7, false));
}

MarkedWidget widget(const char* name, Point centre, unsigned id) {
    return {.name = name, .place = {centre.x, centre.y, 0, 0}, .id = id};
}

TEST(WidgetPositions, AnOpenDropDownListsItsChoices) {
    WidgetPositions positions;
    positions.begin_panel("Plots");
    MarkedWidget compare = widget("compare", apply, 1);
    compare.kind = MarkedWidget::Kind::DropDown;
    positions.add(compare);
    positions.add_choice("compare", "nothing", "", widget("", apply, 2));
    positions.add_choice("compare", "world b", "world_b", widget("", discard, 3));
    EXPECT_TRUE(positions.find("compare").empty()) << "not drawn yet";
    positions.end_frame(0);
    for (const char* name : {"compare", "Plots/compare"}) {
        ASSERT_EQ(positions.find(name).size(), 1u);
        EXPECT_EQ(positions.find(name).front()->choices, (std::vector<std::string>{"nothing", "world b"}));
    }
    for (const char* name : {"Plots/compare: world b", "compare: world_b"}) {
        ASSERT_EQ(positions.find(name).size(), 1u);
        EXPECT_EQ(positions.find(name).front()->centre(), discard);
    }
}

TEST(WidgetPositions, WidgetsOfOneNameAreAllFound) {
    WidgetPositions positions;
    positions.begin_panel("left");
    positions.add(widget("Pause", apply, 1));
    positions.begin_panel("Sidebar");
    positions.add(widget("Pause", discard, 2));
    positions.add_alias("Stop");
    positions.end_frame(0);
    ASSERT_EQ(positions.find("Pause").size(), 2u);
    EXPECT_EQ(positions.find("Pause").back()->full_name(), "Sidebar/Pause");
    EXPECT_EQ(positions.find("left/Pause").size(), 1u);
    ASSERT_EQ(positions.find("Sidebar/Stop").size(), 1u);
    EXPECT_EQ(positions.find("Stop").front()->full_name(), "Sidebar/Pause");
    EXPECT_TRUE(positions.find("left/Stop").empty());
}

TEST(WidgetPositions, ANoteBelongsToTheWidgetBeforeIt) {
    WidgetPositions positions;
    positions.add(widget("Apply", apply, 1));
    positions.explain(1, "There are no edits");
    positions.explain(2, "of a widget without a name");
    positions.end_frame(5);
    EXPECT_EQ(positions.find("Apply").front()->note, "There are no edits");
    EXPECT_EQ(positions.hovered(), 5u);
}

TEST(WidgetPositions, AWidgetIsRevealedInOneFrame) {
    WidgetPositions positions;
    EXPECT_FALSE(positions.is_wanted("seed"));
    positions.reveal("Run/seed");
    EXPECT_FALSE(positions.is_wanted("seed")) << "of no panel";
    positions.begin_panel("Run");
    EXPECT_TRUE(positions.is_wanted("seed"));
    positions.end_frame(0);
    positions.begin_panel("Run");
    EXPECT_FALSE(positions.is_wanted("seed"));
}

} // namespace
} // namespace evod::viewer
