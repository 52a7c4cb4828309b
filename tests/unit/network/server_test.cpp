// Starting a server: which options it refuses, and which worlds it begins with. Serving is tested by tests/system.
#include "server/network/server.h"

#include "tests/unit/recording/recorded_run.h"

#include <gmock/gmock.h>

namespace evod::network {
namespace {

using base::RefusalCode;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

ServerOptions any_port() {
    ServerOptions options;
    options.port = 0;
    options.first_world.name = "default";
    options.first_world.seed = {5};
    return options;
}

/// Why a server with these options does not start.
std::string refusal_of(ServerOptions options) {
    const auto server = Server::open(std::move(options));
    EXPECT_FALSE(server);
    return server ? "" : to_text(server.error());
}

class StoredWorlds : public testing::Test {
  protected:
    ServerOptions stored(const std::string& world) {
        ServerOptions options = any_port();
        options.data_folder = folder.path();
        options.first_world.name = world;
        options.first_world_asked = true;
        return options;
    }
    /// Runs a server, which stops at once.
    void serve(ServerOptions options) {
        auto server = Server::open(std::move(options));
        ASSERT_TRUE(server) << to_text(server.error());
        (*server)->stop();
        EXPECT_TRUE((*server)->run());
    }

    const recording::TemporaryFolder folder;
};

TEST(Server, RefusesAddressesByTheirOption) {
    ServerOptions options = any_port();
    options.bind_address = "localhost";
    EXPECT_THAT(refusal_of(options), AllOf(HasSubstr("'localhost'"), HasSubstr("--bind")));
    options = any_port();
    options.http = ServerOptions::HttpOptions{.bind_address = "1.2.3"};
    EXPECT_THAT(refusal_of(options), AllOf(HasSubstr("'1.2.3'"), HasSubstr("--http-bind")));
}

TEST(Server, RefusesAPortThatIsInUse) {
    const auto first = Server::open(any_port());
    ASSERT_TRUE(first) << to_text(first.error());
    EXPECT_NE((*first)->endpoint().port(), 0);
    EXPECT_FALSE((*first)->http_endpoint());
    ServerOptions options = any_port();
    options.port = (*first)->endpoint().port();
    EXPECT_THAT(refusal_of(options), AllOf(HasSubstr("the port is in use"), HasSubstr("another port with --port")));
    options = any_port();
    options.http = ServerOptions::HttpOptions{.port = (*first)->endpoint().port()};
    EXPECT_THAT(refusal_of(options), AllOf(HasSubstr("the port is in use"), HasSubstr("--http-port")));
}

TEST(Server, NeedsTokensOnOtherInterfaces) {
    ServerOptions options = any_port();
    options.bind_address = "0.0.0.0";
    EXPECT_THAT(refusal_of(options), HasSubstr("token"));
}

TEST(Server, NamesTheFileOfAReplayThatItCannotRead) {
    ServerOptions options = any_port();
    options.replay = ServerOptions::Replay{.path = "/nowhere/run.evod", .generation = {}};
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

TEST_F(StoredWorlds, KeepTheirSeed) {
    serve(stored("a"));
    ServerOptions options = stored("a");
    options.first_world.seed = {6}; // drawn at random, because the user asked for none
    const auto server = Server::open(options);
    ASSERT_TRUE(server) << to_text(server.error());
    EXPECT_EQ((*server)->first_seed(), base::Seed{5});
}

TEST_F(StoredWorlds, DifferFromTheOptionsByName) {
    serve(stored("a"));
    ServerOptions options = stored("a");
    options.first_world.seed = {6};
    options.first_seed_asked = true;
    EXPECT_THAT(refusal_of(options), AllOf(HasSubstr("world \"a\""), HasSubstr("seed (5, not 6)")));
    options = stored("a");
    options.first_world.parameters.population_size += 1;
    options.first_world.parameters.food_count += 1;
    const std::string why = refusal_of(options);
    EXPECT_THAT(why, AllOf(HasSubstr("parameters: food_count ("), HasSubstr(", population_size (")));
    EXPECT_THAT(why, Not(HasSubstr("tick_s")));
}

TEST_F(StoredWorlds, AnotherWorldIsAddedOnlyOnRequest) {
    serve(stored("a"));
    ServerOptions options = stored("b");
    options.first_world_asked = false;
    const auto server = Server::open(options);
    ASSERT_TRUE(server) << to_text(server.error());
    EXPECT_EQ((*server)->first_seed(), std::nullopt) << "world b does not exist";
}

TEST_F(StoredWorlds, SpeedAppliesToOneWorld) {
    serve(stored("a"));
    ServerOptions options = any_port();
    options.data_folder = folder.path();
    options.first_speed = simulation::Speed{};
    EXPECT_TRUE(Server::open(options)) << "there is only one world";
    serve(stored("b"));
    EXPECT_THAT(refusal_of(options), AllOf(HasSubstr("--speed and --start apply to one world"), HasSubstr("a, b")));
    serve(stored("default"));
    EXPECT_TRUE(Server::open(options));
}

} // namespace
} // namespace evod::network
