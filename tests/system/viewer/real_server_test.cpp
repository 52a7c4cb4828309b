// evoview against evod: what it draws is what the server says, and its keys command the world.
//
// Runs under Xvfb.
#include "tests/system/viewer/support/expected_picture.h"
#include "tests/system/viewer/support/past_of_world.h"
#include "tests/system/viewer/support/person.h"

#include <gtest/gtest.h>

namespace evod::viewer {
namespace {

TEST(RealServer, EveryPixelOfAScreenshotIsWhatTheServerSays) {
    RealServer server{{"--seed", "7", "--speed", "max"}};
    server.make_world(
        {.name = "room",
         .parameters = {{"obstacle_count", count(6)}, {"crate_count", count(9)}, {"population_size", count(60)}}});
    for (const std::string world : {"default", "room"}) {
        constexpr std::uint64_t tick = 601;
        server.run_to(world, tick);
        const auto picture = picture_of(server, world);
        const TemporaryFolder folder;
        const std::string path = folder.file("picture.png");
        std::string arguments = "--server " + server.address();
        arguments.append(" --world ").append(world).append(" --screenshot ").append(path);
        arguments.append(" --at-tick ").append(std::to_string(tick));
        const Ran ran = run_evoview(arguments);
        ASSERT_EQ(ran.status, 0) << ran.output;
        sf::Image image;
        ASSERT_TRUE(image.loadFromFile(path));
        const ExpectedPicture expected{*picture, camera_of(picture->about, 1280, 720)};
        EXPECT_GT(expected.count(palette::background), 500'000u);
        // A ring of radius 4 px has dozens of whole pixels, a disc more.
        EXPECT_GT(expected.count(palette::organism), 10 * picture->organisms.id.size());
        EXPECT_GT(expected.count(palette::food), 10 * picture->food.id.size());
        EXPECT_GT(expected.count(palette::poison), 10 * picture->poison.id.size());
        const auto mismatch = expected.compare(image);
        EXPECT_EQ(mismatch.count, 0u) << world << " " << mismatch.first;
    }
}

TEST(RealServer, KeysCommandTheWorld) {
    RealServer server{{"--seed", "7"}};
    Process evoview{EVOVIEW, {"--server", server.address(), "--size", "800x500"}};
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

TEST(RealServer, TheWindowStandsInTheMiddleOfTheScreen) {
    for (const std::string scale : {"1", "4"}) {
        Process evoview{EVOVIEW, {"--start", "--scale", scale}};
        Person person;
        ASSERT_TRUE(person.finds_window());
        const Person::Place whole = person.whole_screen();
        const int width = scale == "1" ? 1280 : whole.width, height = scale == "1" ? 720 : whole.height;
        const Person::Place middle{(whole.width - width) / 2, (whole.height - height) / 2, width, height};
        EXPECT_TRUE(Person::looks_until([&] { return person.finds_place() == middle; })) << "at scale " << scale;
    }
}

TEST(RealServer, NothingIsSaidToRunOnceItIsGone) {
    RealServer server{{"--seed", "7"}};
    Process evoview{EVOVIEW, {"--server", server.address(), "--size", "1000x500"}};
    Person person;
    ASSERT_TRUE(person.finds_window());
    ASSERT_TRUE(person.sees(palette::organism));
    const auto says_that_it_runs = [&](bool it_does) {
        return Person::looks_until([&] {
            const sf::Image seen = person.looks();
            return seen.getSize().x > 0 && (count(seen, palette::running) > 0) == it_does;
        });
    };
    person.press(XK_space);
    ASSERT_TRUE(says_that_it_runs(true));
    server.end();
    EXPECT_TRUE(says_that_it_runs(false));
    EXPECT_TRUE(person.sees(palette::organism)) << "the last picture stays";
}

} // namespace
} // namespace evod::viewer
