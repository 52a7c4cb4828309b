// The panels of evoview, driven by scripts, against evod: the server has what the script did.
//
// Runs under Xvfb.
#include "tests/support/waiting.h"
#include "tests/system/viewer/support/processes.h"

#include <SFML/Graphics/Image.hpp>
#include <gmock/gmock.h>
#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace evod::viewer {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

struct PanelsTest : testing::Test {
    std::string write(const std::string& script) const {
        std::string path = folder.file("script");
        std::ofstream{path} << script;
        return path;
    }
    Ran play(const std::string& arguments, const std::string& script) const {
        return run_evoview(arguments + " --script " + write(script));
    }
    std::string token(const std::string& role) const {
        FILE* pipe = popen((std::string{EVOD} + " token add " + role + " --role " + role + " --data " +
                            folder.file("data") + " 2>" + folder.file("token"))
                               .c_str(),
                           "r");
        std::array<char, 128> line{};
        EXPECT_NE(std::fgets(line.data(), line.size(), pipe), nullptr);
        EXPECT_EQ(pclose(pipe), 0);
        std::string secret = line.data();
        secret.erase(secret.find_last_not_of('\n') + 1);
        return secret;
    }

    TemporaryFolder folder;
};

TEST_F(PanelsTest, WhatOnlyThePageHasLeadsToThePage) {
    RealServer with_page{{"--seed", "7", "--web", "--http-port", "0"}}, without{{"--seed", "7"}};
    for (const std::string line : {"key F8", "click \"Glass box/Play\"", "wait widget \"hold the world\""}) {
        const std::string script = "timeout 60\nwait connected\n" + line + "\nquit\n";
        const Ran ran = play(with_page.address(), script);
        EXPECT_EQ(ran.status, 1);
        EXPECT_THAT(ran.output,
                    AllOf(HasSubstr(":3: " + line + ": The panel Glass box is in the browser page: open http://"),
                          HasSubstr("/#world=default and choose Glass box")));
        EXPECT_THAT(play(without.address(), script).output, HasSubstr("start evod with --web"));
    }
}

double chance_of(const evod::v1::ParameterSet& set) {
    for (const auto& parameter : set.parameters()) {
        if (parameter.name() == "mutation_chance") {
            return parameter.value().real();
        }
    }
    ADD_FAILURE() << "there is no mutation_chance";
    return 0;
}

TEST_F(PanelsTest, ApplyReachesTheServer) {
    RealServer server{{"--seed", "7"}};
    const Ran applied = play(server.address(), R"(
wait connected
wait snapshot
key F4
wait widget "Revision 1"
set Search "mutation chance"
set mutation_chance 0.2
wait widget "1 edited"
click Apply
wait widget "Revision 2"
quit
)");
    ASSERT_EQ(applied.status, 0) << applied.output;
    EXPECT_EQ(server.parameters().revision(), 2u);
    EXPECT_EQ(chance_of(server.parameters()), 0.2);
}

std::string selection_of(const evod::v1::ParameterSet& set) {
    for (const auto& parameter : set.parameters()) {
        if (parameter.name() == "selection") {
            return parameter.value().choice();
        }
    }
    return "";
}

TEST_F(PanelsTest, ADropDownTakesOnlyItsChoices) {
    RealServer server{{"--seed", "7"}};
    const Ran chosen = play(server.address(), R"script(
wait snapshot
key F4
set Search selection
set selection truncation
wait widget "1 edited"
set selection tournament
click Apply
wait widget "Revision 2"
key F5
set palette cividis
set "colour by (C)" "gene body_size"
quit
)script");
    ASSERT_EQ(chosen.status, 0) << chosen.output;
    EXPECT_EQ(selection_of(server.parameters()), "tournament");
    const Ran unknown = play(server.address(), R"(wait snapshot
key F4
set Search selection
wait widget selection
timeout 0.5
set selection turnament
)");
    EXPECT_EQ(unknown.status, 1);
    EXPECT_THAT(unknown.output, HasSubstr("script:6: set selection turnament: "));
    EXPECT_THAT(unknown.output, HasSubstr("\"selection\" offers "));
    EXPECT_THAT(unknown.output, HasSubstr("tournament, "));
}

TEST_F(PanelsTest, KeysTypedIntoAFieldCommandNothing) {
    RealServer server{{"--seed", "7"}};
    const Ran ran = play(server.address(), R"(
wait snapshot
key F4
click Search
key Space
type " q1+"
key Q
key M
key Escape
wait widget Apply
key F12
wait gone Apply
quit
)");
    ASSERT_EQ(ran.status, 0) << ran.output;
    const auto world = server.state();
    EXPECT_EQ(world.state(), evod::v1::RUN_STATE_WAITING);
    EXPECT_EQ(world.tick(), 0u);
    EXPECT_EQ(world.speed().real_time_factor(), 1);
}

TEST_F(PanelsTest, RunsGenerationsAndResetsWithASeed) {
    RealServer server{{"--seed", "7"}};
    const Ran ran = play(server.address(), R"(
wait snapshot
key F3
wait widget generations
click "as fast as possible"
set generations 2
click "Run generations"
wait generation 2
wait state waiting
set seed 12345
click "Reset …"
click "Cancel"
wait gone "Cancel"
click "Reset …"
click "Reset the world"
wait widget "seed 12345"
key F2
click "Worlds/default"
quit
)");
    ASSERT_EQ(ran.status, 0) << ran.output;
    const auto world = server.state();
    EXPECT_EQ(world.seed(), 12345u);
    EXPECT_EQ(world.generation(), 1u);
    EXPECT_TRUE(world.speed().max());
}

TEST_F(PanelsTest, EscQuitsOnlyAtTheSecondPress) {
    RealServer server{{"--seed", "7"}};
    const std::string path = folder.file("still_there.png");
    const Ran ran = play(server.address(), R"(
wait snapshot
key Escape
key F2
wait widget Worlds/default
screenshot )" + path + R"(
key Escape
key Escape
wait widget "nothing: the window is gone"
)");
    ASSERT_EQ(ran.status, 0) << ran.output;
    EXPECT_TRUE(std::filesystem::exists(path)) << "the first press closed the window";
}

TEST_F(PanelsTest, APanelLeavesTheTimeLineFree) {
    RealServer server{{"--seed", "7", "--data", folder.file("data")}};
    evod::v1::Request run;
    run.mutable_run_until_tick()->set_world("default");
    run.mutable_run_until_tick()->set_tick(30);
    server.ask(run);
    ASSERT_TRUE(
        wait_until([&] { return server.state().tick() == 30; })); // otherwise the middle of the line is an earlier tick
    for (const char* when : {"wait widget \"Time line/Live\"\nkey F6\n", "key F6\nwait widget \"Time line/Live\"\n"}) {
        const Ran ran = play(server.address() + " --past 1 --size 1280x720",
                             std::string{"wait snapshot\n"} + when + "click \"time line\"\nwait tick 10\nquit\n");
        ASSERT_EQ(ran.status, 0) << ran.output;
    }
}

TEST_F(PanelsTest, AClickOnAWorldShowsIt) {
    RealServer server{{"--seed", "7"}};
    server.make_world({.name = "mars", .parameters = {{"island_count", count(3)}}});
    const Ran ran = play(server.address(), R"(
wait snapshot
key F2
click mars
click "island 2"
key Space
wait state running
quit
)");
    ASSERT_EQ(ran.status, 0) << ran.output;
    EXPECT_EQ(server.state("mars").state(), evod::v1::RUN_STATE_RUNNING);
    EXPECT_EQ(server.state("default").state(), evod::v1::RUN_STATE_WAITING);
}

TEST_F(PanelsTest, AViewerConnectsAndChangesNothing) {
    const std::string admin = token("admin"), secret = token("viewer");
    RealServer server{{"--seed", "7", "--require-token", "--data", folder.file("data"), "--log-level", "debug"}};
    std::ofstream{folder.file("secret")} << secret << '\n';
    ASSERT_EQ(chmod(folder.file("secret").c_str(), 0600), 0);
    const Ran ran = play(server.address() + " --token-file " + folder.file("secret"), R"(
wait snapshot
key F4
wait widget "Revision 1"
set Search "mutation chance"
wait disabled mutation_chance
wait disabled Apply
key F3
wait disabled "as fast as possible"
wait disabled Sidebar/Run
wait disabled "Run generations"
wait disabled "Reset …"
key F2
wait widget default
screenshot )" + folder.file("viewer.png") + "\nquit\n");
    ASSERT_EQ(ran.status, 0) << ran.output;
    sf::Image image;
    EXPECT_TRUE(image.loadFromFile(folder.file("viewer.png")));
    server.connection.emplace(core::Options{
        .server = core::parse_endpoint(server.address()).value(), .token = admin, .client_name = "a test"});
    EXPECT_EQ(server.parameters().revision(), 1u);
    EXPECT_EQ(chance_of(server.parameters()), 0.15);
    EXPECT_EQ(server.state().state(), evod::v1::RUN_STATE_WAITING);
    EXPECT_FALSE(server.state().speed().max());
    EXPECT_THAT(server.end(), Not(HasSubstr("needs the role"))) << "the viewer sent no command";
}

TEST_F(PanelsTest, EveryKindOfWidgetIsSetByTheTextBesideIt) {
    RealServer server{{"--seed", "7", "--speed", "max", "--data", folder.file("data")}};
    evod::v1::Request run;
    run.mutable_run()->set_generations(3);
    server.ask(run);
    const Ran ran = play(server.address(), R"script(
wait generation 3
wait state waiting
key P
wait widget "Time line/Live"
set generation 2
set "Time line/generation" 1
key P
wait gone "Time line/Live"
actions 9
key .
wait generation 4
click organism 12
wait widget "keep it centred (L)"
set "keep it centred (L)" on
key F5
set palette cividis
actions 12
click at 0.5,0.5
quit
)script");
    EXPECT_EQ(ran.status, 0) << ran.output;
}

TEST_F(PanelsTest, SelectionChangesWithThreeActions) {
    RealServer server{{"--seed", "7"}};
    const Ran ran = play(server.address(), R"(
wait snapshot
wait widget "Revision 1"
set selection tournament
click Apply
wait widget "Revision 2"
actions 3
set Selection "stochastic universal"
click Apply
wait widget "Revision 3"
set "apply at once" on
set Search "selection"
set "Tournament size" 4
wait widget "Revision 4"
menu "Tournament size"
click "Default: 3"
wait widget "Revision 5"
quit
)");
    EXPECT_EQ(ran.status, 0) << ran.output;
    EXPECT_EQ(selection_of(server.parameters()), "stochastic_universal");
}

TEST_F(PanelsTest, AFailingLineEndsEvoviewAndIsPrinted) {
    const Ran wrong = play("localhost:1", "wait widget Connect\nclik Connect\n");
    EXPECT_EQ(wrong.status, 2);
    EXPECT_THAT(wrong.output, HasSubstr("script:2: word 1: got \"clik\""));
    const Ran late = play("localhost:1", "timeout 0.1\n\nclick Disconnect\n");
    EXPECT_EQ(late.status, 1);
    EXPECT_THAT(late.output, HasSubstr("script:3: click Disconnect: "));
}

TEST_F(PanelsTest, DrawsOnAScreenThatEndsWithItsLastClient) {
    Process screen{"/usr/bin/env", {"Xvfb", "-displayfd", "1", "-terminate", "-nolisten", "tcp"}};
    std::string number;
    do { // the output also has messages of the X server
        number = screen.read_line();
    } while (!number.empty() && number.find_first_not_of("0123456789\n") != std::string::npos);
    ASSERT_FALSE(number.empty()) << "Xvfb did not start";
    number.pop_back();
    Process evoview{"/usr/bin/env",
                    {"DISPLAY=:" + number, EVOVIEW, "localhost:1", "--script", write("wait widget Tabs/Run\nquit\n")}};
    EXPECT_EQ(evoview.wait(), 0);
}

#ifdef ENDLESS_LOOK_UP_LIBRARY
TEST_F(PanelsTest, AnEndlessLookUpDoesNotBlockTheWindow) {
    Process evoview{"/usr/bin/env",
                    {std::string{"LD_PRELOAD="} + ENDLESS_LOOK_UP_LIBRARY, EVOVIEW, "lab.example", "--script",
                     write("key F5\nwait widget palette\nquit\n")}};
    EXPECT_EQ(evoview.wait(), 0);
}
#endif

TEST_F(PanelsTest, TextAndWidgetsFollowTheScale) {
    const auto sidebar_width = [&](const std::string& scale) {
        const Ran ran = play("localhost:1 --size 1280x720 --scale " + scale,
                             "wait widget Tabs/Run\nscreenshot " + folder.file("window.png") + "\nquit\n");
        EXPECT_EQ(ran.status, 0) << ran.output;
        sf::Image image;
        EXPECT_TRUE(image.loadFromFile(folder.file("window.png")));
        // The lowest row of the sidebar has no widgets.
        const unsigned y = image.getSize().y - 3;
        const sf::Color background = image.getPixel(image.getSize().x - 3, y);
        unsigned width = 0;
        for (unsigned x = 0; x < image.getSize().x; ++x) {
            width += image.getPixel(x, y) == background;
        }
        return width;
    };
    const unsigned half = sidebar_width("0.5");
    EXPECT_NEAR(half, 200, 2);
    EXPECT_NEAR(sidebar_width("1"), 400, 2);
}

} // namespace
} // namespace evod::viewer
