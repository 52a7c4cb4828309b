// What a user changes from the window of evoview: worlds, the freezer, and what is on an island. Scripts drive the
// window; the test asks evod for the effect.
//
// Runs under Xvfb.
#include "client/viewer/panels/freezer_panel.h"
#include "client/viewer/panels/new_world_dialog.h"
#include "client/viewer/world/freezer.h"
#include "client/viewer/world/mouse_tool.h"
#include "proto/codec/population_csv.h"
#include "tests/system/viewer/support/panel_host.h"
#include "tests/system/viewer/support/replay_of_world.h"
#include "tests/unit/viewer/world/population_of.h"

#include <gmock/gmock.h>
#include <imgui.h>

#include <fstream>
#include <iterator>
#include <map>

namespace evod::viewer {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

struct ChangesTest : testing::Test {
    Ran play(RealServer& server, const std::string& script, const std::string& arguments = "") const {
        const std::string path = folder.file("script");
        std::ofstream{path} << "wait snapshot\n" << script << "\nquit\n";
        return run_evoview(server.address() + " --freezer " + folder.file("freezer") + " " + arguments + " --script " +
                           path);
    }
    static std::vector<std::string> worlds(RealServer& server) {
        evod::v1::Request request;
        request.mutable_list_worlds();
        const auto response = server.connection->request(request, hang).value();
        std::vector<std::string> names;
        for (const auto& world : response.worlds().worlds()) {
            names.push_back(world.name());
        }
        return names;
    }
    static std::map<std::string, evod::v1::ParameterValue> values(const evod::v1::ParameterSet& set) {
        std::map<std::string, evod::v1::ParameterValue> values;
        for (const auto& parameter : set.parameters()) {
            values[parameter.name()] = parameter.has_pending() ? parameter.pending() : parameter.value();
        }
        return values;
    }

    /// The content of a file in the folder.
    std::string content(const std::string& name) const {
        std::ifstream file{folder.file(name)};
        return {std::istreambuf_iterator<char>{file}, {}};
    }

    TemporaryFolder folder;
};

TEST_F(ChangesTest, CreatesAnExperimentAndShowsIt) {
    RealServer server{{"--seed", "7"}};
    const Ran ran = play(server, R"(
key F2
click "New world …"
click "New world/trade_offs"
set seed 12
click "New world/Create"
wait gone "New world/Create"
wait snapshot
wait widget Worlds/trade_offs
key Space
wait state running
)");
    ASSERT_EQ(ran.status, 0) << ran.output;
    EXPECT_THAT(worlds(server), ElementsAre("default", "trade_offs"));
    EXPECT_EQ(server.state("trade_offs").seed(), 12u);
    EXPECT_EQ(server.state("trade_offs").state(), evod::v1::RUN_STATE_RUNNING) << "the window shows it";
    EXPECT_EQ(values(server.parameters("trade_offs"))["normal_speed_cost"].real(), 0.1);
}

TEST_F(ChangesTest, ARefusedWorldIsExplainedInTheDialog) {
    RealServer server{{"--seed", "7"}};
    const Ran ran = play(server, R"(
key F2
click "New world …"
set "New world/name" "no good"
click "New world/Create"
wait widget "The new world is refused"
set "New world/name" default
click "New world/Create"
wait widget "The new world is refused"
click "Parameters as text"
set "New world/name" text
set "New world/text" {}}
click "New world/Create"
wait widget "The new world is refused"
set "New world/text" {}
click "New world/Create"
wait gone "New world/Create"
wait snapshot
)");
    ASSERT_EQ(ran.status, 0) << ran.output;
    EXPECT_THAT(worlds(server), ElementsAre("default", "text"));
}

TEST_F(ChangesTest, BOffersASecondWorldWithTheSameParameters) {
    RealServer server{{"--seed", "7"}};
    evod::v1::Request change;
    change.mutable_set_parameters()->set_world("default");
    auto& parameter = *change.mutable_set_parameters()->add_parameters();
    parameter.set_name("mutation_chance");
    *parameter.mutable_value() = real(0.3);
    ASSERT_TRUE(core::accepted(server.connection->request(change, hang).value()));
    const Ran ran = play(server, R"(
key B
wait widget "New world/Create"
key Escape
wait gone "New world/Create"
key B
click "same as default"
click "New world/Create"
wait gone "New world/Create"
wait connected
wait snapshot
key X
key W
key B
)");
    ASSERT_EQ(ran.status, 0) << ran.output;
    EXPECT_THAT(worlds(server), ElementsAre("default", "default-2"));
    for (const auto& [name, value] : values(server.parameters("default"))) {
        EXPECT_EQ(values(server.parameters("default-2"))[name].SerializeAsString(), value.SerializeAsString()) << name;
    }
}

TEST_F(ChangesTest, ForksWithOneClickAndDeletes) {
    RealServer server{{"--seed", "7"}};
    server.run_to("default", 100);
    Ran ran = play(server, R"(
click Fork
key F2
wait widget Worlds/default-2
wait snapshot
key .
wait tick 101
)");
    ASSERT_EQ(ran.status, 0) << ran.output;
    EXPECT_EQ(server.state("default-2").tick(), 101u) << "the focus is on the fork";
    EXPECT_EQ(server.state("default").tick(), 100u);
    ran = play(server, R"(
key F2
click Worlds/default-2
wait snapshot
click "Worlds/Delete …"
click "Delete default-2"
wait gone Worlds/default-2
wait snapshot
)");
    ASSERT_EQ(ran.status, 0) << ran.output;
    EXPECT_THAT(worlds(server), ElementsAre("default"));
}

TEST_F(ChangesTest, AViewerSeesWhyItCannotCreateWorlds) {
    const std::string command = "umask 077; " + std::string{EVOD} + " token add class --role viewer --data " +
                                folder.file("data") + " 2>/dev/null >" + folder.file("token");
    ASSERT_EQ(std::system(command.c_str()), 0);
    RealServer server{{"--seed", "7", "--data", folder.file("data")}};
    const Ran ran = play(server, "key F2\ntimeout 0.5\nclick \"New world …\"", "--token-file " + folder.file("token"));
    EXPECT_EQ(ran.status, 1);
    EXPECT_THAT(ran.output, HasSubstr("Only the role admin may create and delete worlds"));
}

TEST_F(ChangesTest, AFrozenPopulationStartsANewWorld) {
    RealServer server{{"--seed", "7", "--data", folder.file("data")}};
    const Ran ran = play(server, R"(
key F10
click "Freeze the population"
click Freezer/default-g1
click "Freezer/New world …"
set "New world/name" thawed
click "New world/islands"
click "New world/Create"
wait gone "New world/Create"
wait snapshot
)");
    ASSERT_EQ(ran.status, 0) << ran.output;
    const auto thawed = values(server.parameters("thawed"));
    EXPECT_EQ(thawed.at("population_size").count(), 50u);
    EXPECT_EQ(thawed.at("island_count").count(), 1u) << "as in the file, not as in the preset";
    server.end();
    for (const std::string world : {"default", "thawed"}) {
        const std::string exported = folder.file(world + ".csv");
        const std::string command = std::string{EVOD} + " export " + folder.file("data/" + world + ".evod") +
                                    " --what population --generation 1 --output " + exported + " >/dev/null 2>&1";
        ASSERT_EQ(std::system(command.c_str()), 0);
        EXPECT_EQ(content("freezer/default-g1.csv"), content(world + ".csv")) << world;
    }
}

TEST_F(ChangesTest, ADamagedFileIsListed) {
    RealServer server{{"--seed", "7"}};
    std::filesystem::create_directories(folder.file("freezer"));
    std::ofstream{folder.file("freezer/cut.csv")} << codec::population_heading << "\n0,0,1,2\n";
    const Ran ran = play(server, R"(
key F10
wait widget "cut is damaged"
click Freezer/cut
wait disabled "Freezer/New world …"
click "Freezer/Delete …"
click "Delete the file"
wait gone Freezer/cut
)");
    ASSERT_EQ(ran.status, 0) << ran.output;
    EXPECT_FALSE(std::filesystem::exists(folder.file("freezer/cut.csv")));
}

TEST_F(ChangesTest, PlacesAndRemovesWithTheMouse) {
    RealServer server{{"--seed", "7"}};
    const auto before = snapshot_of(server, "default");
    const Ran ran = play(server, R"(
click "Click: Food"
click at 0.5,0.5
click "Click: Poison"
click at 0.5,0.55
key Escape
click organism 27
wait widget Organism/Freeze
click "Click: Organism"
click at 0.5,0.4
click "Click: Remove"
click organism 5
wait connected
key Escape
click organism 27
key Escape
click Organism/Freeze
key F10
click Freezer/default-g1-o27
click Freezer/Thaw
click at 0.55,0.4
key Escape
wait connected
drag Freezer/default-g1-o27 at 0.7,0.4
wait connected
)");
    ASSERT_EQ(ran.status, 0) << ran.output;
    const auto after = snapshot_of(server, "default");
    const codec::QuantisedSnapshot &was = *before->entities, &is = *after->entities;
    ASSERT_EQ(is.food.id.size(), was.food.id.size() + 1);
    ASSERT_EQ(is.poison.id.size(), was.poison.id.size() + 1);
    constexpr double pixel_px = 1.5; // a pixel of the window, in px of the world
    EXPECT_NEAR(double{is.food.x_px(is.food.id.size() - 1)}, 640, pixel_px);
    EXPECT_NEAR(double{is.food.y_px(is.food.id.size() - 1)}, 360, pixel_px);
    EXPECT_NEAR(double{is.poison.y_px(is.poison.id.size() - 1)}, 396, pixel_px);
    EXPECT_EQ(is.organisms.id.size(), was.organisms.id.size() + 2) << "three placed, one removed";
    EXPECT_FALSE(is.organisms.index_of(5));
    const std::size_t model = is.organisms.index_of(27).value();
    for (const std::uint32_t id : {50u, 51u, 52u}) {
        const std::size_t placed = is.organisms.index_of(id).value();
        EXPECT_EQ(is.organisms.radius_px(placed), is.organisms.radius_px(model)) << "the same genes";
        EXPECT_NEAR(double{is.organisms.y_px(placed)}, 288, pixel_px);
    }
}

TEST_F(ChangesTest, AnOrganismCanBeDraggedOutOfTheFreezer) {
    RealServer server{{"--seed", "7"}};
    Freezer freezer{folder.file("freezer")};
    ASSERT_TRUE(freezer.save("fast", population_of({{1, 2, 3, 4, 5, 6}})));
    ASSERT_TRUE(freezer.save("many", population_of({std::vector<float>(12)})));
    ViewedWorld world{{.connection = {.server = core::parse_endpoint(server.address()).value()}, .world = "default"}};
    FreezerPanel panel;
    NewWorldDialog dialog;
    MouseTool tool;
    IslandView island_view;
    const Gui* built = nullptr;
    PanelHost host{400, 300, [&](Gui& gui) {
                       built = &gui;
                       ImGui::SetNextWindowPos({0, 0});
                       ImGui::SetNextWindowSize({300, 300});
                       ImGui::Begin("Freezer");
                       Panel::Context context{world, gui, Freezer::Clock::now(), island_view};
                       context.freezer = &freezer;
                       context.new_world = &dialog;
                       context.tool = &tool;
                       panel.build(context);
                       ImGui::End();
                   }};
    host.draw();
    host.draw();
    const auto drag = [&](const char* file) {
        const auto found = built->widget_positions().find(file);
        ASSERT_EQ(found.size(), 1u) << file;
        const Point from = found.front()->centre();
        host.move(static_cast<int>(from.x), static_cast<int>(from.y));
        host.button(sf::Event::MouseButtonPressed);
        host.move(350, 200);
    };
    drag("fast");
    EXPECT_TRUE(tool.dragging());
    EXPECT_EQ(tool.hint({}), "Place fast");
    host.button(sf::Event::MouseButtonReleased);
    EXPECT_TRUE(tool.take_drop());
    tool.choose(MouseTool::Kind::Select);
    drag("many");
    EXPECT_FALSE(tool.dragging()) << "a population is not placed with the mouse";
    host.button(sf::Event::MouseButtonReleased);
    EXPECT_FALSE(tool.take_drop());
}

} // namespace
} // namespace evod::viewer
