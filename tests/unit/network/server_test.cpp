// Starting a server: which options it refuses. Serving is tested by tests/system.
#include "server/network/server.h"

#include "tests/support/temporary_folder.h"

#include <gmock/gmock.h>

namespace evod::network {
namespace {

using base::RefusalCode;
using testing::AllOf;
using testing::HasSubstr;

ServerOptions any_port() {
    ServerOptions options;
    options.listeners.port = 0;
    simulation::CreateWorld& world = std::get<LiveWorlds>(options.worlds).first_world.world;
    world.name = "default";
    world.seed = {5};
    return options;
}

/// Why a server with these options does not start.
std::string refusal_of(ServerOptions options) {
    const auto server = Server::open(std::move(options));
    EXPECT_FALSE(server);
    return server ? "" : to_text(server.error());
}

TEST(Server, RefusesAddressesByTheirOption) {
    ServerOptions options = any_port();
    options.listeners.bind_address = "localhost";
    EXPECT_THAT(refusal_of(options), AllOf(HasSubstr("'localhost'"), HasSubstr("--bind")));
    options = any_port();
    options.listeners.http = HttpOptions{.bind_address = "1.2.3"};
    EXPECT_THAT(refusal_of(options), AllOf(HasSubstr("'1.2.3'"), HasSubstr("--http-bind")));
}

TEST(Server, RefusesAPortThatIsInUse) {
    const auto first = Server::open(any_port());
    ASSERT_TRUE(first) << to_text(first.error());
    EXPECT_NE((*first)->endpoint().port(), 0);
    EXPECT_FALSE((*first)->http_endpoint());
    ServerOptions options = any_port();
    options.listeners.port = (*first)->endpoint().port();
    EXPECT_THAT(refusal_of(options), AllOf(HasSubstr("the port is in use"), HasSubstr("another port with --port")));
    options = any_port();
    options.listeners.http = HttpOptions{.port = (*first)->endpoint().port()};
    EXPECT_THAT(refusal_of(options), AllOf(HasSubstr("the port is in use"), HasSubstr("--http-port")));
}

TEST(Server, NeedsTokensOnOtherInterfaces) {
    ServerOptions options = any_port();
    options.listeners.bind_address = "0.0.0.0";
    EXPECT_THAT(refusal_of(options), HasSubstr("token"));
}

TEST(Server, NamesTheFileOfAReplayThatItCannotRead) {
    ServerOptions options = any_port();
    options.worlds = ReplayedRun{.path = "/nowhere/run.evod", .generation = {}};
    EXPECT_THAT(refusal_of(options), HasSubstr("/nowhere/run.evod"));
}

TEST(Server, StopsBeforeItServes) {
    auto server = Server::open(any_port());
    ASSERT_TRUE(server) << to_text(server.error());
    EXPECT_EQ((*server)->first_seed(), base::Seed{5});
    (*server)->stop();
    (*server)->stop();
    EXPECT_TRUE((*server)->run());
}

TEST(Server, RestoresTheWorldThatItHasStored) {
    const support::TemporaryFolder folder;
    ServerOptions options = any_port();
    LiveWorlds& worlds = std::get<LiveWorlds>(options.worlds);
    worlds.storage = StorageOptions{.folder = folder.path(), .run_files = {}};
    {
        auto server = Server::open(options);
        ASSERT_TRUE(server) << to_text(server.error());
        (*server)->stop();
        EXPECT_TRUE((*server)->run());
    }
    worlds.first_world.world.seed = {6};
    {
        const auto server = Server::open(options);
        ASSERT_TRUE(server) << to_text(server.error());
        EXPECT_EQ((*server)->first_seed(), base::Seed{5});
    }
    worlds.first_world.requested = FirstWorldOptions::Requested::WorldAndSeed;
    EXPECT_THAT(refusal_of(options), HasSubstr("seed (5, not 6)"));
}

} // namespace
} // namespace evod::network
