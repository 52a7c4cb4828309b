// evoview --screenshot against a server of the test's own: every pixel is what the picture says.
//
// Runs under Xvfb.
#include "client/viewer/overlay.h"
#include "tests/system/viewer/expected_picture.h"
#include "tests/system/viewer/playing_server.h"
#include "tests/system/viewer/processes.h"

#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <tuple>

namespace evod::viewer {
namespace {

struct ScreenshotTest : testing::Test {
    TemporaryFolder folder;
    std::string path = folder.file("picture.png");
};

constexpr std::int32_t px = 1 << 12; // in the fixed point of the columns

/// One of everything that can be told apart, on an island of another shape than the window's.
evod::v1::SnapshotFrame known_picture() {
    const std::array<std::uint32_t, 4> ids{0, 3, 4, 9};
    const std::array<std::int32_t, 4> x{100 * px, 300 * px + px / 3, 500 * px, 790 * px};
    const std::array<std::int32_t, 4> y{100 * px, 450 * px, 300 * px + px / 2, 590 * px};
    const std::array<float, 4> radius{10, 20, 4, 10}, health{100, 63.2f, 0.4f, 7};
    const std::array<std::uint32_t, 3> food_ids{1, 2, 5}, poison_ids{0, 1, 8};
    const std::array<std::int32_t, 3> food_x{4 * px, 300 * px, 640 * px}, food_y{4 * px, 450 * px, 200 * px};
    const std::array<std::int32_t, 3> poison_x{700 * px, 205 * px, 415 * px}, poison_y{100 * px, 300 * px, 505 * px};
    const std::array<std::int32_t, 1> crate_x{200 * px}, crate_y{200 * px}, rock_x{600 * px}, rock_y{450 * px};
    const std::array<float, 1> crate_half{15}, rock_width{60}, rock_height{25};
    evod::v1::SnapshotFrame frame;
    wire::encode({.width_px = 800,
                  .height_px = 600,
                  .organisms = {ids, x, y, radius, health},
                  .food = {food_ids, food_x, food_y},
                  .poison = {poison_ids, poison_x, poison_y},
                  .crates = {crate_x, crate_y, crate_half, crate_half},
                  .obstacles = {rock_x, rock_y, rock_width, rock_height}},
                 frame);
    frame.set_world("default");
    frame.set_run_id("00112233445566778899aabbccddeeff");
    frame.set_island_count(1);
    frame.set_tick(36'034);
    frame.set_generation(16);
    frame.set_simulated_s(600.56);
    frame.set_state(evod::v1::RUN_STATE_RUNNING);
    frame.mutable_speed()->set_real_time_factor(4);
    frame.set_ticks_per_s(240);
    frame.set_item_radius_px(5);
    frame.mutable_live()->set_organism_count(50);
    frame.mutable_live()->set_alive_count(4);
    frame.mutable_live()->set_health_mean(42.65);
    frame.mutable_live()->set_food_eaten(312);
    frame.mutable_live()->set_poison_eaten(45);
    return frame;
}

TEST_F(ScreenshotTest, EveryPixelIsWhatThePictureSays) {
    const auto picture = known_picture();
    for (const auto& [size, width, height] : {std::tuple{"1280x720", 1280u, 720u}, {"641x479", 641u, 479u}}) {
        PlayingServer server{picture};
        const Ran ran = run_evoview("--server " + server.address() + " --size " + size + " --screenshot " + path +
                                    " --at-tick 36000 --timeout 20");
        ASSERT_EQ(ran.status, 0) << ran.output;
        EXPECT_EQ(server.command_count(), 0u) << "a screenshot only watches";
        sf::Image image;
        ASSERT_TRUE(image.loadFromFile(path));
        ASSERT_EQ(image.getSize(), (sf::Vector2u{width, height}));
        const ExpectedPicture expected{wire::decode(picture).value(), camera_of(picture, width, height)};
        for (const Colour colour : {palette::background, palette::wall, palette::organism, palette::food,
                                    palette::poison, palette::crate, palette::crate_edge, palette::obstacle}) {
            EXPECT_GT(expected.count(colour), 20u);
        }
        const auto mismatch = expected.compare(image);
        EXPECT_EQ(mismatch.count, 0u) << size << " " << mismatch.first;
    }
}

TEST_F(ScreenshotTest, HealthStandsAboveEachOrganism) {
    const auto picture = known_picture();
    PlayingServer server{picture};
    const Ran ran = run_evoview("--server " + server.address() + " --screenshot " + path + " --timeout 20");
    ASSERT_EQ(ran.status, 0) << ran.output;
    sf::Image image;
    ASSERT_TRUE(image.loadFromFile(path));
    const Camera camera = camera_of(picture, 1280, 720);
    const auto decoded = wire::decode(picture).value();
    for (std::size_t i = 0; i < decoded.organisms.id.size(); ++i) {
        const Point top =
            camera.to_screen({decoded.organisms.x_px[i], decoded.organisms.y_px[i] - decoded.organisms.radius_px[i]});
        unsigned dark_count = 0;
        for (int y = -14; y < -1; ++y) {
            for (int x = -14; x <= 14; ++x) {
                const sf::Color is = image.getPixel(static_cast<unsigned>(top.x + x), static_cast<unsigned>(top.y + y));
                dark_count += is.r < 120 && is.g < 120 && is.b < 120;
            }
        }
        EXPECT_GE(dark_count, 6u) << "organism " << i; // a "1" is the thinnest
    }
}

TEST_F(ScreenshotTest, TellsThatThereIsNoServer) {
    link::FakeServer server;
    const std::string address = link::to_text(server.endpoint());
    server.stop_listening();
    const Ran ran = run_evoview("--server " + address + " --screenshot " + path + " --timeout 0.3");
    EXPECT_EQ(ran.status, 1);
    EXPECT_NE(ran.output.find(address), std::string::npos) << ran.output;
    EXPECT_FALSE(std::filesystem::exists(path));
}

TEST_F(ScreenshotTest, TellsThatThereIsNoSuchWorld) {
    PlayingServer server{known_picture()};
    const Ran ran = run_evoview("--server " + server.address() + " --world mars --screenshot " + path);
    EXPECT_EQ(ran.status, 1);
    EXPECT_NE(ran.output.find("No world \"mars\""), std::string::npos) << ran.output;
}

TEST_F(ScreenshotTest, TellsThatTheWorldStandsStillBeforeTheTick) {
    auto picture = known_picture();
    picture.set_state(evod::v1::RUN_STATE_PAUSED);
    PlayingServer server{picture};
    const Ran ran =
        run_evoview("--server " + server.address() + " --screenshot " + path + " --at-tick 50000 --timeout 1");
    EXPECT_EQ(ran.status, 1);
    EXPECT_NE(ran.output.find("is paused at tick 36034; waiting"), std::string::npos) << ran.output;
    EXPECT_NE(ran.output.find("no picture of tick 50000"), std::string::npos) << ran.output;
}

TEST_F(ScreenshotTest, TellsAtOnceThatTheRunHasEndedBeforeTheTick) {
    auto picture = known_picture();
    picture.set_state(evod::v1::RUN_STATE_TERMINATED);
    PlayingServer server{picture};
    const Ran ran = run_evoview("--server " + server.address() + " --screenshot " + path + " --at-tick 50000");
    EXPECT_EQ(ran.status, 1);
    EXPECT_NE(ran.output.find("before tick 50000"), std::string::npos) << ran.output;
}

TEST_F(ScreenshotTest, TellsThatTheFileCannotBeWritten) {
    PlayingServer server{known_picture()};
    const Ran ran = run_evoview("--server " + server.address() + " --screenshot " + path + "/nowhere.png");
    EXPECT_EQ(ran.status, 1);
    EXPECT_NE(ran.output.find("could not write"), std::string::npos) << ran.output;
}

TEST_F(ScreenshotTest, AWrongCommandLineIsRefusedWithStatus2) {
    for (const char* arguments : {"--size 12by4", "--size 1280x9999999", "--server :x", "--at-tick 5", "--island -1"}) {
        EXPECT_EQ(run_evoview(arguments).status, 2) << arguments;
    }
}

} // namespace
} // namespace evod::viewer
