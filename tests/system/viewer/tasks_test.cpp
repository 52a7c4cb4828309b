// Tasks of a lesson in a real window. Each takes at most three actions from the first screen: clicks, keys and
// typed texts. docs/VIEWER.md lists the tasks with their actions.
//
// Runs under Xvfb.
#include "tests/system/viewer/support/processes.h"
#include "tests/system/viewer/support/replay_of_world.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <string>
#include <vector>

namespace evod::viewer {
namespace {

/// evod with the world "default", which runs at real time and has been paused in generation 10.
struct TasksTest : testing::Test {
    TasksTest() : server{{"--seed", "7", "--data", folder.file("data"), "--speed", "max"}} {
        server.run_generations("default", 9);
        server.run_to("default", server.state("default").tick() + 60);
        evod::v1::Request speed;
        speed.mutable_set_speed()->set_world("default");
        speed.mutable_set_speed()->mutable_speed()->set_real_time_factor(1);
        server.ask(speed);
    }

    /// Does a task, which must take at most three actions. `proof` are lines of a script that show its effect.
    void play(const std::string& task, const std::string& proof = "") {
        const std::string path = folder.file("script");
        std::ofstream{path} << "wait snapshot\nwait connected\n" << task << "\nactions 3\n" << proof << "\nquit\n";
        const Ran ran = run_evoview(server.address() + " --world default --script " + path);
        EXPECT_EQ(ran.status, 0) << ran.output;
    }

    std::vector<evod::v1::WorldInfo> worlds() {
        evod::v1::Request request;
        request.mutable_list_worlds();
        const auto response = server.connection->request(request, hang).value();
        return {response.worlds().worlds().begin(), response.worlds().worlds().end()};
    }

    /// An organism that is alive and has parents.
    evod::v1::OrganismInfo child() {
        for (const std::uint32_t id : snapshot_of(server, "default")->entities->organisms.id) {
            evod::v1::Request request;
            request.mutable_get_organism()->set_world("default");
            request.mutable_get_organism()->set_organism(id);
            const auto response = server.connection->request(request, hang).value();
            if (response.organism().parents_size() > 0) {
                return response.organism();
            }
        }
        ADD_FAILURE() << "every organism is a founder";
        return {};
    }

    TemporaryFolder folder;
    RealServer server;
};

TEST_F(TasksTest, ChangeTheSelection) {
    play(R"(click Selection
click "selection: tournament"
click Apply)",
         "wait widget \"Revision 2\"");
    const auto set = server.parameters("default");
    const auto selection =
        std::ranges::find(set.parameters(), "selection", [](const auto& parameter) { return parameter.name(); });
    ASSERT_NE(selection, set.parameters().end());
    EXPECT_EQ(selection->value().choice(), "tournament");
}

TEST_F(TasksTest, SlowDown) {
    play("key -");
    EXPECT_TRUE(wait_until([&] { return server.state("default").speed().real_time_factor() == 0.5; }));
}

TEST_F(TasksTest, FollowAnOrganism) {
    play("click organism " + std::to_string(child().id()) + "\nkey L", "wait widget \"keep it centred (L)\"");
}

TEST_F(TasksTest, ReplayGenerationFive) {
    play(R"(click "Fitness curve"
wait widget Live
wait state paused
key Space)",
         "wait state running");
}

TEST_F(TasksTest, ForkNow) {
    play("click Fork", "wait connected\nwait snapshot");
    const auto all = worlds();
    ASSERT_EQ(all.size(), 2u);
    EXPECT_EQ(all.back().name(), "default-2");
    EXPECT_EQ(all.back().tick(), all.front().tick());
}

} // namespace
} // namespace evod::viewer
