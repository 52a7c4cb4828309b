#include "client/viewer/panes/tour.h"

#include <gtest/gtest.h>

namespace evod::viewer {
namespace {

using Key = sf::Keyboard;

TEST(Tour, EndsAfterItsLastCallout) {
    Tour tour;
    EXPECT_FALSE(tour.handle(Key::Right)) << "not shown";
    tour.start();
    int presses = 0;
    while (tour.shown()) {
        ASSERT_TRUE(tour.handle(presses % 2 == 0 ? Key::Right : Key::Enter));
        ASSERT_LE(++presses, 6) << "a tour of a minute";
    }
    EXPECT_GE(presses, 4);
    EXPECT_FALSE(tour.handle(Key::Escape));
}

TEST(Tour, EscSkipsItAndOtherKeysPass) {
    Tour tour;
    tour.start();
    EXPECT_TRUE(tour.handle(Key::Left)) << "stays at the first callout";
    EXPECT_FALSE(tour.handle(Key::Space));
    EXPECT_TRUE(tour.shown());
    EXPECT_TRUE(tour.handle(Key::Escape));
    EXPECT_FALSE(tour.shown());
}

} // namespace
} // namespace evod::viewer
