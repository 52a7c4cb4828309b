#include "server/commands/serve_options.h"

#include "proto/command_line/command.h"
#include "tests/unit/recording/recorded_run.h"

#include <gmock/gmock.h>

#include <fstream>

namespace evod::commands {
namespace {

using testing::HasSubstr;
using Requested = network::FirstWorldOptions::Requested;

/// The options after a command line; nothing if it was rejected.
std::optional<ServeOptions> parse(std::vector<const char*> words) {
    words.insert(words.begin(), "evod");
    command_line::Command app{"evod", "", ""};
    ServeOptions options;
    add_all_options(app, options);
    app.action([] {});
    testing::internal::CaptureStderr();
    const bool accepted = !app.parse(static_cast<int>(words.size()), words.data());
    testing::internal::GetCapturedStderr();
    return accepted ? std::optional{options} : std::nullopt;
}

TEST(ServeOptions, SpeedIsMaxOrAFactorInRange) {
    EXPECT_TRUE(parse_speed("max"));
    EXPECT_TRUE(parse_speed("0.001"));
    EXPECT_TRUE(parse_speed("10000"));
    for (const char* wrong : {"", "0", "0.0009", "10001", "-1", "1x", "nan", "inf", "fast"}) {
        EXPECT_FALSE(parse_speed(wrong)) << wrong;
    }
}

TEST(ServeOptions, ValuesOutOfRangeAreRejected) {
    EXPECT_TRUE(parse({"--port", "0", "--threads", "1024", "--speed", "max"}));
    for (const std::vector<const char*>& words : {std::vector<const char*>{"--port", "65536"},
                                                  {"--threads", "0"},
                                                  {"--rank-timeout", "0"},
                                                  {"--speed", "0"},
                                                  {"--http-bind", "::1"},
                                                  {"--http-host", "lab"},
                                                  {"--web", "--http-host", "http://lab"},
                                                  {"--web", "--http-host", "lab:80"},
                                                  {"--embed-in", "http://localhost:8888"},
                                                  {"--web", "--embed-in", "localhost:8888"},
                                                  {"--durability", "some"},
                                                  {"--file-bytes-max", "1"},
                                                  {"--data", "a", "--keep-nothing"}}) {
        EXPECT_FALSE(parse(words)) << words[0];
    }
}

TEST(ServeOptions, DescribeTheServer) {
    const auto options = parse({"--keep-nothing", "--port", "9", "--http-port", "8", "--seed", "5", "--speed", "2",
                                "--start", "--sessions-max", "7"});
    ASSERT_TRUE(options);
    const auto server = server_options(*options);
    ASSERT_TRUE(server) << to_text(server.error());
    EXPECT_EQ(server->listeners.port, 9);
    ASSERT_TRUE(server->listeners.http);
    EXPECT_EQ(server->listeners.http->port, 8);
    EXPECT_EQ(server->limits.sessions_max, 7u);
    const auto& worlds = std::get<network::LiveWorlds>(server->worlds);
    EXPECT_FALSE(worlds.storage);
    EXPECT_FALSE(worlds.processes);
    EXPECT_EQ(worlds.first_world.world.name, "default");
    EXPECT_EQ(worlds.first_world.world.seed, base::Seed{5});
    EXPECT_EQ(worlds.first_world.requested, Requested::WorldAndSeed);
    EXPECT_EQ(worlds.first_commands.speed, simulation::Speed{2});
    EXPECT_TRUE(worlds.first_commands.run);
}

TEST(ServeOptions, WebIsThePortOfThePage) {
    const auto described = [](std::vector<const char*> words) {
        words.push_back("--keep-nothing");
        return server_options(parse(words).value())->listeners.http;
    };
    EXPECT_FALSE(described({}));
    EXPECT_EQ(described({"--web"})->port, 7745);
    EXPECT_EQ(described({"--web", "--http-port", "8000"})->port, 8000);
    const auto named =
        described({"--http-host", "lab.example", "--web", "--http-host", "::1", "--http-bind", "0.0.0.0"});
    EXPECT_EQ(named->bind_address, "0.0.0.0");
    EXPECT_THAT(named->host_names, testing::ElementsAre("lab.example", "::1"));
    EXPECT_THAT(described({"--web", "--embed-in", "http://a", "--embed-in", "http://b:*"})->embedders,
                testing::ElementsAre("http://a", "http://b:*"));
}

TEST(ServeOptions, TheFirstWorldIsTheExperiments) {
    const recording::TemporaryFolder folder;
    const std::string path = folder.path() + "/two islands.json";
    std::ofstream{path} << R"({"seed": 6, "island_count": 2})";
    ServeOptions options;
    options.experiment_file = path;
    options.data_folder = folder.path();
    const auto server = server_options(options);
    ASSERT_TRUE(server) << to_text(server.error());
    const auto& worlds = std::get<network::LiveWorlds>(server->worlds);
    EXPECT_EQ(worlds.first_world.world.name, "two_islands");
    EXPECT_EQ(worlds.first_world.world.parameters.island_count, 2u);
    EXPECT_EQ(worlds.first_world.world.seed, base::Seed{6});
    EXPECT_EQ(worlds.first_world.requested, Requested::World);
    EXPECT_TRUE(worlds.first_commands.is_empty());
    EXPECT_EQ(worlds.storage.value().folder, folder.path());
    EXPECT_EQ(server->listeners.token_folder, folder.path());
}

TEST(ServeOptions, ACertificateNeedsItsKey) {
    ServeOptions options;
    options.keep_nothing = true;
    const auto refusal_of = [&](const ServeOptions::Tls& tls) {
        options.tls = tls;
        return to_text(server_options(options).error());
    };
    EXPECT_EQ(refusal_of({.certificate = "a", .key = "", .client_ca = ""}), "--tls-cert requires --tls-key");
    EXPECT_EQ(refusal_of({.certificate = "", .key = "b", .client_ca = "c"}), "--tls-key requires --tls-cert");
    EXPECT_EQ(refusal_of({.certificate = "", .key = "", .client_ca = "c"}),
              "--tls-client-ca requires --tls-cert and --tls-key");
    options.tls = {.certificate = "a", .key = "b", .client_ca = ""};
    const auto tls = server_options(options)->listeners.tls;
    ASSERT_TRUE(tls);
    EXPECT_EQ(tls->key, "b");
    EXPECT_FALSE(tls->client_ca);
    options.tls = {};
    EXPECT_FALSE(server_options(options)->listeners.tls);
}

TEST(ServeOptions, AFileThatCannotBeReadIsNamed) {
    ServeOptions options;
    options.keep_nothing = true;
    options.experiment_file = "/nowhere/a.json";
    EXPECT_THAT(to_text(server_options(options).error()), HasSubstr("/nowhere/a.json"));
    options.experiment_file.clear();
    options.population_file = "/nowhere/a.csv";
    EXPECT_THAT(to_text(server_options(options).error()), HasSubstr("--population: "));
}

TEST(ServeOptions, AReplayHasNoWorldsOfItsOwn) {
    ServeOptions options;
    options.data_folder = "/tokens";
    const auto server = replay_server_options(options, {.path = "/run.evod", .generation = 4});
    ASSERT_TRUE(server) << to_text(server.error());
    const auto& run = std::get<network::ReplayedRun>(server->worlds);
    EXPECT_EQ(run.path, "/run.evod");
    EXPECT_EQ(run.generation, 4u);
    EXPECT_EQ(server->listeners.token_folder, "/tokens");
}

} // namespace
} // namespace evod::commands
