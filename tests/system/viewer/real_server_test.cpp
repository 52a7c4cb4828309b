// evoview against evod: its frames match the server's snapshots, and its keys command the world.
//
// Runs under Xvfb.
#include "tests/system/viewer/support/expected_frame.h"
#include "tests/system/viewer/support/person.h"
#include "tests/system/viewer/support/replay_of_world.h"

#include <gtest/gtest.h>

namespace evod::viewer {
namespace {

TEST(RealServer, KeysCommandTheWorld) {
    RealServer server{{"--seed", "7"}};
    Process evoview{EVOVIEW, {"--server", server.address(), "--size", "800x500", "--skin", "classic"}};
    Person person;
    ASSERT_TRUE(person.finds_window());
    ASSERT_TRUE(person.sees(palette::organism));
    const auto becomes = [&](auto condition) { return wait_until([&] { return condition(server.state()); }); };

    person.press(XK_space);
    EXPECT_TRUE(becomes([](const auto& world) { return world.state() == evod::v1::RUN_STATE_RUNNING; }));
    person.press(XK_space);
    EXPECT_TRUE(becomes([](const auto& world) { return world.state() == evod::v1::RUN_STATE_PAUSED; }));
    const std::uint64_t tick = server.state().tick();
    person.press(XK_period);
    EXPECT_TRUE(becomes([&](const auto& world) { return world.tick() == tick + 1; }));
    person.press(XK_period, true);
    EXPECT_TRUE(becomes(
        [&](const auto& world) { return world.tick() == tick + 61 && world.state() == evod::v1::RUN_STATE_PAUSED; }));
    person.press(XK_equal, true);
    EXPECT_TRUE(becomes([](const auto& world) { return world.speed().real_time_factor() == 2; }));
    person.press(XK_m);
    EXPECT_TRUE(becomes([](const auto& world) { return world.speed().max(); }));
    person.press(XK_minus);
    EXPECT_TRUE(becomes([](const auto& world) { return world.speed().real_time_factor() == 2; }));
    EXPECT_EQ(server.state().tick(), tick + 61);
    person.press(XK_q);
    EXPECT_EQ(evoview.wait(), 0);
}

TEST(RealServer, TheWindowOpensInTheMiddleOfTheScreen) {
    for (const std::string scale : {"1", "4"}) {
        Process evoview{EVOVIEW, {"localhost:1", "--scale", scale}};
        Person person;
        ASSERT_TRUE(person.finds_window());
        const Person::Place whole = person.whole_screen();
        const int width = scale == "1" ? 1280 : whole.width, height = scale == "1" ? 720 : whole.height;
        const Person::Place middle{(whole.width - width) / 2, (whole.height - height) / 2, width, height};
        EXPECT_TRUE(Person::looks_until([&] { return person.finds_place() == middle; })) << "at scale " << scale;
    }
}

TEST(RealServer, ShowsNoRunningStateWithoutAServer) {
    RealServer server{{"--seed", "7"}};
    Process evoview{EVOVIEW, {"--server", server.address(), "--size", "1000x500", "--skin", "classic"}};
    Person person;
    ASSERT_TRUE(person.finds_window());
    ASSERT_TRUE(person.sees(palette::organism));
    const auto shows_running = [&](bool expected) {
        return Person::looks_until([&] {
            const sf::Image seen = person.looks();
            return seen.getSize().x > 0 && (count(seen, palette::running) > 0) == expected;
        });
    };
    person.press(XK_space);
    ASSERT_TRUE(shows_running(true));
    server.end();
    EXPECT_TRUE(shows_running(false));
    EXPECT_TRUE(person.sees(palette::organism)) << "the last snapshot is still shown";
}

} // namespace
} // namespace evod::viewer
