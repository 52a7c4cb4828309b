// Worlds whose organisms are steered by networks, as evoview shows them: headings on the island, and long chromosomes.
//
// Runs under Xvfb.
#include "client/viewer/island/styles.h"
#include "tests/system/viewer/support/expected_frame.h"
#include "tests/system/viewer/support/pixels.h"
#include "tests/system/viewer/support/replay_of_world.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

namespace evod::viewer {
namespace {

constexpr std::uint64_t tick = 150;

struct NetworkTest : testing::Test {
    NetworkTest() {
        server.make_world({.name = "net",
                           .seed = 3,
                           .parameters = {{"controller", choice("network")},
                                          {"generation_s", real(2)},
                                          {"population_size", count(20)}}});
        server.run_to("net", tick);
    }
    Ran play(const std::string& script) const {
        std::ofstream{folder.file("script")} << "timeout 20\n" << script << "quit\n";
        return run_evoview(server.address() + " --world net --script " + folder.file("script"));
    }
    TemporaryFolder folder;
    mutable RealServer server{{"--seed", "7", "--speed", "max", "--data", folder.file("runs")}};
};

TEST_F(NetworkTest, ALinePointsWhereEachOrganismHeads) {
    const auto snapshot = snapshot_of(server, "net");
    const codec::Entities& organisms = snapshot->entities->organisms;
    ASSERT_TRUE(organisms.has_headings());
    for (const std::string skin : {"classic", "vivid"}) {
        const std::string path = folder.file(skin + ".png");
        const Ran ran = run_evoview("--server " + server.address() + " --skin " + skin + " --world net --screenshot " +
                                    path + " --at-tick " + std::to_string(tick));
        ASSERT_EQ(ran.status, 0) << ran.output;
        sf::Image image;
        ASSERT_TRUE(image.loadFromFile(path));
        const Camera camera = camera_of_screenshot(snapshot->about, 1280, 720);
        const Styles& styles = styles_of({skin == "classic" ? Skin::Classic : Skin::Vivid});
        const Colour line = styles.heading.fill;
        std::size_t ahead = 0, behind = 0;
        for (std::size_t i = 0; i < organisms.id.size(); ++i) {
            const double heading = double{organisms.heading_radians(i)};
            // A pixel before the end of the line, where no other mark of the organism is.
            const double beyond_px = (double{styles.heading_pixels} - 1) / camera.zoom();
            const double distance = double{organisms.radius_px(i)} + beyond_px;
            const auto is_line = [&](double way) {
                const Point at = camera.to_screen({organisms.x_px(i) + way * distance * std::cos(heading),
                                                   organisms.y_px(i) + way * distance * std::sin(heading)});
                if (!camera.viewport().contains(at)) {
                    return false;
                }
                const Colour is = pixel_at(image, static_cast<unsigned>(at.x), static_cast<unsigned>(at.y));
                return std::abs(is.red - line.red) + std::abs(is.green - line.green) + std::abs(is.blue - line.blue) <
                       60;
            };
            ahead += is_line(1);
            behind += is_line(-1);
        }
        EXPECT_GE(ahead, organisms.id.size() * 8 / 10) << skin;
        EXPECT_LE(behind, organisms.id.size() * 3 / 10) << skin;
    }
}

TEST_F(NetworkTest, AWeightColoursTheOrganisms) {
    const Ran ran = play(R"script(wait snapshot
key F5
set "colour by (C)" "gene hidden1<bias"
set "colour by (C)" health
)script");
    EXPECT_EQ(ran.status, 0) << ran.output;
}

} // namespace
} // namespace evod::viewer
