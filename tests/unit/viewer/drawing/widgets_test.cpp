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

TEST(WidgetPositions, AnOpenDropDownListsItsChoices) {
    WidgetPositions positions;
    positions.begin_panel("Plots");
    positions.add("Fit", discard);
    positions.add_drop_down("compare", apply);
    positions.add_choice("compare", "nothing", apply);
    positions.add_choice("compare", "world b", discard);
    EXPECT_EQ(positions.choices("compare"), nullptr) << "not drawn yet";
    positions.begin_frame();
    for (const char* name : {"compare", "Plots/compare"}) {
        ASSERT_NE(positions.choices(name), nullptr);
        EXPECT_EQ(*positions.choices(name), (std::vector<std::string>{"nothing", "world b"}));
    }
    EXPECT_EQ(positions.find("Plots/compare: world b"), discard);
    EXPECT_EQ(positions.choices("Fit"), nullptr) << "a button";
}

} // namespace
} // namespace evod::viewer
