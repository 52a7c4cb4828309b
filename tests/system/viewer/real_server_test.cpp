// evoview against evod: its frames match the server's snapshots, and its keys command the world.
//
// Runs under Xvfb.
#include "tests/system/viewer/support/expected_frame.h"
#include "tests/system/viewer/support/person.h"
#include "tests/system/viewer/support/replay_of_world.h"

#include <gtest/gtest.h>

namespace evod::viewer {
namespace {

TEST(RealServer, ScreenshotsMatchTheServersSnapshots) {
    RealServer server{{"--seed", "7", "--speed", "max"}};
    server.make_world(
        {.name = "room",
         .parameters = {{"obstacle_count", count(6)}, {"crate_count", count(9)}, {"population_size", count(60)}}});
    for (const std::string world : {"default", "room"}) {
        constexpr std::uint64_t tick = 601;
        server.run_to(world, tick);
        const auto snapshot = snapshot_of(server, world);
        const TemporaryFolder folder;
        const std::string path = folder.file("frame.png");
        std::string arguments = "--server " + server.address();
        arguments.append(" --size 1680x720 --skin classic --world ").append(world);
        arguments.append(" --screenshot ").append(path);
        arguments.append(" --at-tick ").append(std::to_string(tick));
        const Ran ran = run_evoview(arguments);
        ASSERT_EQ(ran.status, 0) << ran.output;
        sf::Image image;
        ASSERT_TRUE(image.loadFromFile(path));
        const ExpectedFrame expected{*snapshot, camera_of_screenshot(snapshot->about, 1680, 720)};
        EXPECT_GT(expected.count(palette::background), 500'000u);
        // A ring of radius 4 px has dozens of fully covered pixels, a disc more.
        EXPECT_GT(expected.count(palette::organism), 10 * snapshot->entities->organisms.id.size());
        EXPECT_GT(expected.count(palette::food), 10 * snapshot->entities->food.id.size());
        EXPECT_GT(expected.count(palette::poison), 10 * snapshot->entities->poison.id.size());
        const auto mismatch = expected.compare(image);
        EXPECT_EQ(mismatch.count, 0u) << world << " " << mismatch.first;
    }
}

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
