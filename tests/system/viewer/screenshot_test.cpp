// evoview --screenshot against a test server: every pixel matches the snapshot.
//
// Runs under Xvfb.
#include "client/viewer/drawing/window_layout.h"
#include "tests/system/viewer/support/expected_frame.h"
#include "tests/system/viewer/support/known_snapshot.h"
#include "tests/system/viewer/support/playing_server.h"
#include "tests/system/viewer/support/processes.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <tuple>

namespace evod::viewer {
namespace {

struct ScreenshotTest : testing::Test {
    TemporaryFolder folder;
    std::string path = folder.file("frame.png");
};

TEST_F(ScreenshotTest, EveryPixelMatchesTheSnapshot) {
    const auto snapshot = known_snapshot();
    for (const auto& [size, width, height] : {std::tuple{"1280x720", 1280u, 720u}, {"641x479", 641u, 479u}}) {
        PlayingServer server{snapshot};
        const Ran ran = run_evoview("--server " + server.address() + " --skin classic --size " + size +
                                    " --screenshot " + path + " --at-tick 36000 --timeout 600");
        ASSERT_EQ(ran.status, 0) << ran.output;
        EXPECT_EQ(server.command_count(), 0u) << "a screenshot sends no command";
        sf::Image image;
        ASSERT_TRUE(image.loadFromFile(path));
        ASSERT_EQ(image.getSize(), (sf::Vector2u{width, height}));
        const ExpectedFrame expected{codec::decode_plain(snapshot).value(),
                                     camera_of_screenshot(snapshot, width, height)};
        for (const Colour colour : {palette::background, palette::wall, palette::organism, palette::food,
                                    palette::poison, palette::crate, palette::crate_edge, palette::obstacle}) {
            EXPECT_GT(expected.count(colour), 20u);
        }
        const auto mismatch = expected.compare(image);
        EXPECT_EQ(mismatch.count, 0u) << size << " " << mismatch.first;
    }
}

TEST_F(ScreenshotTest, HealthIsDrawnAboveEachOrganism) {
    const auto snapshot = known_snapshot();
    PlayingServer server{snapshot};
    const Ran ran =
        run_evoview("--server " + server.address() + " --skin classic --screenshot " + path + " --timeout 600");
    ASSERT_EQ(ran.status, 0) << ran.output;
    sf::Image image;
    ASSERT_TRUE(image.loadFromFile(path));
    const Camera camera = camera_of_screenshot(snapshot, 1280, 720);
    const auto decoded = codec::decode_plain(snapshot).value();
    const codec::Entities& organisms = decoded.entities->organisms;
    for (std::size_t i = 0; i < organisms.id.size(); ++i) {
        const Point top = camera.to_screen({organisms.x_px(i), organisms.y_px(i) - organisms.radius_px(i)});
        unsigned dark_count = 0;
        for (int y = -14; y < -1; ++y) {
            for (int x = -14; x <= 14; ++x) {
                const sf::Color is = image.getPixel(static_cast<unsigned>(top.x + x), static_cast<unsigned>(top.y + y));
                dark_count += is.r < 120 && is.g < 120 && is.b < 120;
            }
        }
        EXPECT_GE(dark_count, 6u) << "organism " << i; // "1" is the thinnest digit
    }
}

TEST_F(ScreenshotTest, ShowsTheSidebarIfItIsWideEnough) {
    const auto snapshot = known_snapshot();
    for (const auto& [size, width, has_sidebar] : {std::tuple{"800x450", 800u, true}, {"799x450", 799u, false}}) {
        PlayingServer server{snapshot};
        const Ran ran = run_evoview("--server " + server.address() + " --size " + size + " --screenshot " + path +
                                    " --timeout 600");
        ASSERT_EQ(ran.status, 0) << ran.output;
        sf::Image image;
        ASSERT_TRUE(image.loadFromFile(path));
        const sf::Color is = image.getPixel(width - 4, 300); // the sidebar is light, the vivid island is dark
        EXPECT_EQ(is.r > 200 && is.g > 200 && is.b > 200, has_sidebar) << size;
    }
}

TEST_F(ScreenshotTest, ReportsAMissingServer) {
    core::FakeServer server;
    const std::string address = core::to_text(server.endpoint());
    server.stop_listening();
    const Ran ran = run_evoview("--server " + address + " --screenshot " + path + " --timeout 0.3");
    EXPECT_EQ(ran.status, 1);
    EXPECT_NE(ran.output.find(address), std::string::npos) << ran.output;
    EXPECT_FALSE(std::filesystem::exists(path));
}

TEST_F(ScreenshotTest, ReportsAMissingWorld) {
    PlayingServer server{known_snapshot()};
    const Ran ran = run_evoview("--server " + server.address() + " --world mars --screenshot " + path);
    EXPECT_EQ(ran.status, 1);
    EXPECT_NE(ran.output.find("No world \"mars\""), std::string::npos) << ran.output;
}

TEST_F(ScreenshotTest, ReportsAWorldThatIsPausedBeforeTheTick) {
    auto snapshot = known_snapshot();
    snapshot.set_state(evod::v1::RUN_STATE_PAUSED);
    Ran ran;
    // On a slow machine no snapshot has arrived after a second.
    for (int timeout_s = 1; timeout_s < 60 && ran.output.find("is paused at tick 36034; waiting") == std::string::npos;
         timeout_s *= 3) {
        PlayingServer server{snapshot};
        ran = run_evoview("--server " + server.address() + " --screenshot " + path + " --at-tick 50000 --timeout " +
                          std::to_string(timeout_s));
        EXPECT_EQ(ran.status, 1);
        EXPECT_NE(ran.output.find("no snapshot of tick 50000"), std::string::npos) << ran.output;
    }
    EXPECT_NE(ran.output.find("is paused at tick 36034; waiting"), std::string::npos) << ran.output;
}

TEST_F(ScreenshotTest, ReportsAtOnceARunThatEndedBeforeTheTick) {
    auto snapshot = known_snapshot();
    snapshot.set_state(evod::v1::RUN_STATE_TERMINATED);
    PlayingServer server{snapshot};
    const Ran ran = run_evoview("--server " + server.address() + " --screenshot " + path + " --at-tick 50000");
    EXPECT_EQ(ran.status, 1);
    EXPECT_NE(ran.output.find("before tick 50000"), std::string::npos) << ran.output;
}

TEST_F(ScreenshotTest, ReportsAFileThatCannotBeWritten) {
    PlayingServer server{known_snapshot()};
    const Ran ran = run_evoview("--server " + server.address() + " --screenshot " + path + "/nowhere.png");
    EXPECT_EQ(ran.status, 1);
    EXPECT_NE(ran.output.find("could not write"), std::string::npos) << ran.output;
}

} // namespace
} // namespace evod::viewer
