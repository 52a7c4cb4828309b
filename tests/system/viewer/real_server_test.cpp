// evoview against evod: what it draws is what the server says, and its keys command the world.
//
// Runs under Xvfb.
#include "tests/system/viewer/expected_picture.h"
#include "tests/system/viewer/person.h"
#include "tests/system/viewer/processes.h"

#include <gtest/gtest.h>

namespace evod::viewer {
namespace {

TEST(RealServer, EveryPixelOfAScreenshotIsWhatTheServerSays) {
    RealServer server{{"--seed", "7", "--speed", "max"}};
    evod::v1::Request create, speed, run;
    create.mutable_create_world()->set_name("room");
    create.mutable_create_world()->set_seed(7);
    for (const auto& [name, count] : {std::pair{"obstacle_count", 6u}, {"crate_count", 9u}, {"population_size", 60u}}) {
        auto& parameter = *create.mutable_create_world()->add_parameters();
        parameter.set_name(name);
        parameter.mutable_value()->set_count(count);
    }
    server.ask(create);
    speed.mutable_set_speed()->set_world("room");
    speed.mutable_set_speed()->mutable_speed()->set_max(true);
    server.ask(speed);
    for (const std::string world : {"default", "room"}) {
        constexpr std::uint64_t tick = 601;
        run.mutable_run_until_tick()->set_world(world);
        run.mutable_run_until_tick()->set_tick(tick);
        server.ask(run);
        evod::v1::SubscribeSnapshots subscription;
        subscription.set_world(world);
        subscription.set_rate_hz(60);
        const auto pictures = server.connection->subscribe(subscription);
        std::shared_ptr<const wire::Picture> picture;
        ASSERT_TRUE(comes_true([&] {
            const auto newer = server.connection->take_picture(pictures);
            picture = newer ? newer : picture;
            return picture && picture->about.tick() == tick;
        }));
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
    const auto becomes = [&](auto condition) { return comes_true([&] { return condition(server.state()); }); };

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

} // namespace
} // namespace evod::viewer
