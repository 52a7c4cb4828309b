#include "client/viewer/drawing/widgets.h"

#include <gtest/gtest.h>

namespace evod::viewer {
namespace {

constexpr Point apply{10, 20}, discard{80, 20}; // corners of widgets

TEST(Spots, TheMouseLingersAfterHalfASecond) {
    Spots spots;
    EXPECT_FALSE(spots.lingers(apply, 1.0, false));
    EXPECT_FALSE(spots.lingers(apply, 1.2, false));
    EXPECT_FALSE(spots.lingers(apply, 1.4, false));
    EXPECT_TRUE(spots.lingers(apply, 1.6, false));
    EXPECT_FALSE(spots.lingers(discard, 1.7, false)) << "the mouse has just moved there";
}

TEST(Spots, AfterAClickTheMouseMustLeaveFirst) {
    Spots spots;
    for (double now_s = 1; now_s < 1.6; now_s += 0.1) {
        spots.lingers(apply, now_s, false);
    }
    EXPECT_TRUE(spots.lingers(apply, 1.6, false));
    EXPECT_FALSE(spots.lingers(apply, 1.7, true));
    for (double now_s = 1.8; now_s < 5; now_s += 0.1) {
        EXPECT_FALSE(spots.lingers(apply, now_s, false)) << now_s;
    }
    spots.lingers(discard, 5, false);
    spots.lingers(apply, 5.1, false);
    spots.lingers(apply, 5.3, false);
    spots.lingers(apply, 5.5, false);
    EXPECT_TRUE(spots.lingers(apply, 5.7, false));
}

TEST(Spots, AnOpenDropDownListsItsChoices) {
    Spots spots;
    spots.begin_panel("Plots");
    spots.add("Fit", discard);
    spots.add_drop_down("compare", apply);
    spots.add_choice("compare", "nothing", apply);
    spots.add_choice("compare", "world b", discard);
    EXPECT_EQ(spots.choices("compare"), nullptr) << "not drawn yet";
    spots.begin_frame();
    for (const char* name : {"compare", "Plots/compare"}) {
        ASSERT_NE(spots.choices(name), nullptr);
        EXPECT_EQ(*spots.choices(name), (std::vector<std::string>{"nothing", "world b"}));
    }
    EXPECT_EQ(spots.find("Plots/compare: world b"), discard);
    EXPECT_EQ(spots.choices("Fit"), nullptr) << "a button";
}

} // namespace
} // namespace evod::viewer
