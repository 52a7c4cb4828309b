// Worlds whose organisms are steered by networks, as evoview shows them: headings on the island, the network of the
// selected organism with the activations that the server computes, and long chromosomes in the plots.
//
// Runs under Xvfb.
#include "client/viewer/island/styles.h"
#include "client/viewer/panels/brain_diagram.h"
#include "tests/system/viewer/support/expected_frame.h"
#include "tests/system/viewer/support/panel_host.h"
#include "tests/system/viewer/support/pixels.h"
#include "tests/system/viewer/support/replay_of_world.h"

#include <gtest/gtest.h>
#include <imgui.h>

#include <cmath>
#include <fstream>
#include <utility>
#include <vector>

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
    evod::v1::OrganismInfo organism(std::uint32_t id) const {
        evod::v1::Request request;
        request.mutable_get_organism()->set_world("net");
        request.mutable_get_organism()->set_organism(id);
        return server.connection->request(request, hang).value().organism();
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
        const Camera camera = camera_of(snapshot->about, 1280, 720);
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

TEST_F(NetworkTest, ThePanelShowsTheActivationsOfTheSelected) {
    const auto snapshot = snapshot_of(server, "net");
    const std::uint32_t id = snapshot->entities->organisms.id.front();
    const evod::v1::OrganismInfo info = organism(id);
    ASSERT_TRUE(info.has_brain());
    const std::string path = folder.file("network.png");
    const Ran ran = play("wait snapshot\nkey F6\nclick organism " + std::to_string(id) +
                         "\nwait widget Network\nscreenshot " + path + "\n");
    ASSERT_EQ(ran.status, 0) << ran.output;
    sf::Image image;
    ASSERT_TRUE(image.loadFromFile(path));
    const evod::v1::Brain& brain = info.brain();
    ASSERT_EQ(brain.hidden_size(), 5);
    for (const auto* layer : {&brain.inputs(), &brain.hidden(), &brain.outputs()}) {
        for (const float activation : *layer) {
            EXPECT_GT(count(image, activation_colour(activation)), 60u) << activation;
        }
    }
}

TEST(NetworkDiagram, ShowsOnlyTheLinesOfTheNeuronAtTheMouse) {
    evod::v1::Brain brain;
    brain.add_inputs(0);
    brain.add_hidden(0.37f);
    brain.add_hidden(-0.61f);
    brain.add_outputs(0);
    const std::vector<float> weights{1, -1, 1, -1}; // those of the first hidden neuron are positive
    PanelHost host{400, 300, [&](Gui& gui) {
                       ImGui::SetNextWindowPos({0, 0});
                       ImGui::SetNextWindowSize({400, 300});
                       ImGui::Begin("network");
                       build_brain(brain, weights, gui);
                       ImGui::End();
                   }};
    host.draw();
    sf::Image image = host.draw();
    EXPECT_GT(count(image, palette::series_blue), 50u);
    EXPECT_GT(count(image, palette::series_orange), 50u);
    const auto at = [&image](Colour colour) { // the first pixel from the top is at the upper edge of the neuron
        for (unsigned y = 0; y < image.getSize().y; ++y) {
            for (unsigned x = 0; x < image.getSize().x; ++x) {
                if (pixel_at(image, x, y) == colour) {
                    return std::pair{static_cast<int>(x), static_cast<int>(y) + 4};
                }
            }
        }
        return std::pair{0, 0};
    };
    const auto [x, y] = at(activation_colour(0.37f));
    ASSERT_GT(x, 0);
    host.move(x, y);
    image = host.draw();
    EXPECT_EQ(count(image, palette::series_blue), 0u);
    EXPECT_GT(count(image, palette::series_orange), 50u);
}

TEST_F(NetworkTest, LongChromosomesAreShownByGroup) {
    const Ran ran = play(R"script(wait snapshot
key F7
click Genes
set group "genes: brain"
set gene "turn<bias"
set gene "means of the 6 most changed"
click Selection
set gene "hidden2<food_bearing"
set group "genes: body"
set gene impulse
set gene "selection of all of the group"
key F5
set "colour by (C)" "gene hidden1<bias"
set "colour by (C)" health
)script");
    EXPECT_EQ(ran.status, 0) << ran.output;
}

} // namespace
} // namespace evod::viewer
