// What a user changes from the window of evoview. Scripts drive the window; the test asks evod for the effect.
//
// Runs under Xvfb.
#include "tests/system/viewer/support/replay_of_world.h"

#include <gmock/gmock.h>

#include <fstream>

namespace evod::viewer {
namespace {

using testing::HasSubstr;

struct ChangesTest : testing::Test {
    Ran play(RealServer& server, const std::string& script, const std::string& arguments = "") const {
        const std::string path = folder.file("script");
        std::ofstream{path} << "wait snapshot\n" << script << "\nquit\n";
        return run_evoview(server.address() + " " + arguments + " --script " + path);
    }

    TemporaryFolder folder;
};

TEST_F(ChangesTest, ForksWithOneClickAndShowsTheFork) {
    RealServer server{{"--seed", "7"}};
    server.run_to("default", 100);
    const Ran ran = play(server, R"(
click Fork
key F2
wait widget Worlds/default-2
wait snapshot
wait connected
key .
wait tick 101
)");
    ASSERT_EQ(ran.status, 0) << ran.output;
    EXPECT_EQ(server.state("default-2").tick(), 101u) << "the window shows the fork";
    EXPECT_EQ(server.state("default").tick(), 100u);
}

TEST_F(ChangesTest, WhatThePageCreatesEndsTheScriptWithTheWayThere) {
    RealServer server{{"--seed", "7"}};
    for (const std::string line : {"click \"New …\"", "key F10"}) {
        const Ran ran = play(server, line);
        EXPECT_EQ(ran.status, 1);
        EXPECT_THAT(ran.output, HasSubstr("is in the browser page: start evod with --web, open the page"));
    }
}

TEST_F(ChangesTest, AViewerSeesWhyItCannotFork) {
    const std::string command = "umask 077; " + std::string{EVOD} + " token add class --role viewer --data " +
                                folder.file("data") + " 2>/dev/null >" + folder.file("token");
    ASSERT_EQ(std::system(command.c_str()), 0);
    RealServer server{{"--seed", "7", "--data", folder.file("data")}};
    const Ran ran = play(server, "timeout 0.5\nclick Fork", "--token-file " + folder.file("token"));
    EXPECT_EQ(ran.status, 1);
    EXPECT_THAT(ran.output, HasSubstr("Only the role admin may create and delete worlds"));
}

} // namespace
} // namespace evod::viewer
