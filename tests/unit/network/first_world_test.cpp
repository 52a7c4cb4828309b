#include "server/network/first_world.h"

#include "tests/unit/recording/recorded_run.h"

#include <gmock/gmock.h>

#include <fstream>

namespace evod::network {
namespace {

using recording::RecordedRun;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using Requested = FirstWorldOptions::Requested;

std::vector<v1::Request> requests_of(const FirstWorld& world) {
    std::vector<v1::Request> requests;
    world.begin([&](v1::Request request) { requests.push_back(std::move(request)); });
    return requests;
}

/// The options for the world of RecordedRun, or for an equal one of another name.
LiveWorlds world_named(const std::string& name, Requested requested) {
    LiveWorlds options;
    options.first_world.world.name = name;
    options.first_world.world.parameters = recording::small_world();
    options.first_world.world.seed = {7};
    options.first_world.requested = requested;
    return options;
}

class StoredWorlds : public testing::Test {
  protected:
    /// Stores the world `w`, and maybe a fork of it, the world `fork`.
    void store(bool with_fork = false) {
        archive.reset(); // unlocks the folder
        auto data = run_file::DataFolder::open(folder.path());
        recording::StorageThread thread{{}};
        RecordedRun run{*data, thread};
        run.advance(10);
        if (with_fork) {
            run.fork({3, 4});
        }
        run.recorder().close_all(run.laboratory());
    }
    base::Result<FirstWorld> choose(const LiveWorlds& options) {
        archive.reset();
        auto opened = replay::Archive::open(folder.path(), {}, executor);
        if (!opened) {
            return opened.error();
        }
        archive = *std::move(opened);
        return FirstWorld::choose(options, archive.get());
    }
    std::string refusal_of(const LiveWorlds& options) {
        const auto chosen = choose(options);
        EXPECT_FALSE(chosen);
        return chosen ? "" : to_text(chosen.error());
    }

    const recording::TemporaryFolder folder;
    base::InlineExecutor executor;
    std::unique_ptr<replay::Archive> archive;
};

TEST(FirstWorld, IsCreatedIfRunsAreNotStored) {
    LiveWorlds options = world_named("a", Requested::Nothing);
    const auto chosen = FirstWorld::choose(options, nullptr);
    ASSERT_TRUE(chosen) << to_text(chosen.error());
    EXPECT_EQ(chosen->seed(), base::Seed{7});
    const auto requests = requests_of(*chosen);
    ASSERT_EQ(requests.size(), 1u) << "no command was requested";
    EXPECT_EQ(requests[0].create_world().name(), "a");
    EXPECT_EQ(requests[0].create_world().seed(), 7u);
    const auto command = protocol::to_command(
        [&] {
            v1::Request request = requests[0];
            request.set_client_key("test");
            return request;
        }(),
        {});
    ASSERT_TRUE(command) << to_text(command.error());
    EXPECT_EQ(std::get<simulation::CreateWorld>(*command).parameters, recording::small_world());
}

TEST(FirstWorld, GetsItsCommandsAfterItIsCreated) {
    LiveWorlds options = world_named("a", Requested::Nothing);
    options.first_commands = {.speed = simulation::Speed{2}, .run = true};
    auto requests = requests_of(*FirstWorld::choose(options, nullptr));
    ASSERT_EQ(requests.size(), 3u);
    EXPECT_TRUE(requests[0].has_create_world());
    EXPECT_EQ(requests[1].set_speed().world(), "a");
    EXPECT_EQ(requests[1].set_speed().speed().real_time_factor(), 2);
    EXPECT_EQ(requests[2].run().world(), "a");
    EXPECT_FALSE(requests[2].run().has_generations());

    options.first_commands = {.speed = simulation::Speed{}, .run = false};
    requests = requests_of(*FirstWorld::choose(options, nullptr));
    ASSERT_EQ(requests.size(), 2u);
    EXPECT_TRUE(requests[1].set_speed().speed().max());
}

TEST_F(StoredWorlds, AreCreatedOnlyOnRequest) {
    LiveWorlds options = world_named("b", Requested::Nothing);
    auto chosen = choose(options);
    ASSERT_TRUE(chosen) << to_text(chosen.error());
    EXPECT_EQ(chosen->seed(), base::Seed{7}) << "there is no world yet";
    store();
    chosen = choose(options);
    ASSERT_TRUE(chosen) << to_text(chosen.error());
    EXPECT_EQ(chosen->seed(), std::nullopt);
    EXPECT_TRUE(requests_of(*chosen).empty());
    options.first_world.requested = Requested::World;
    chosen = choose(options);
    ASSERT_TRUE(chosen) << to_text(chosen.error());
    EXPECT_EQ(chosen->seed(), base::Seed{7});
    EXPECT_EQ(requests_of(*chosen).size(), 1u);
}

TEST_F(StoredWorlds, KeepTheirSeed) {
    store();
    LiveWorlds options = world_named("w", Requested::World);
    options.first_world.world.seed = {6}; // drawn at random, because the user requested none
    const auto chosen = choose(options);
    ASSERT_TRUE(chosen) << to_text(chosen.error());
    EXPECT_EQ(chosen->seed(), base::Seed{7});
    EXPECT_TRUE(requests_of(*chosen).empty());
}

TEST_F(StoredWorlds, DifferFromTheOptionsByName) {
    store();
    LiveWorlds options = world_named("w", Requested::WorldAndSeed);
    EXPECT_TRUE(choose(options));
    options.first_world.world.seed = {6};
    EXPECT_THAT(refusal_of(options),
                AllOf(HasSubstr(folder.path() + " contains a world \"w\" with other seed (7, not 6)"),
                      HasSubstr("start without --experiment, --seed and --population")));
    options = world_named("w", Requested::World);
    options.first_world.world.parameters.population_size += 1;
    options.first_world.world.parameters.food_count += 1;
    const std::string why = refusal_of(options);
    EXPECT_THAT(why,
                AllOf(HasSubstr("parameters: food_count (40, not 41)"), HasSubstr(", population_size (12, not 13)")));
    EXPECT_THAT(why, Not(HasSubstr("tick_s")));
    options.first_world.requested = Requested::Nothing;
    EXPECT_TRUE(choose(options)) << "the user did not request this world";
}

TEST_F(StoredWorlds, DifferFromTheOptionsByScheduleAndOrganisms) {
    store();
    LiveWorlds options = world_named("w", Requested::World);
    options.first_world.world.schedule.add(5, {"mutation_chance", 0.5});
    EXPECT_THAT(refusal_of(options), HasSubstr("other schedule of parameters"));
    options = world_named("w", Requested::World);
    options.first_world.world.first_population =
        std::make_shared<const std::vector<evolution::GeneMatrix>>(2, evolution::GeneMatrix::Zero(6, 12));
    EXPECT_THAT(refusal_of(options), HasSubstr("other organisms"));
}

TEST_F(StoredWorlds, CommandsApplyToOneWorld) {
    store();
    LiveWorlds options = world_named("default", Requested::Nothing);
    options.first_commands.run = true;
    auto chosen = choose(options);
    ASSERT_TRUE(chosen) << to_text(chosen.error());
    ASSERT_EQ(requests_of(*chosen).size(), 1u);
    EXPECT_EQ(requests_of(*chosen)[0].run().world(), "w") << "the only world";
}

TEST_F(StoredWorlds, CommandsNeedANameAmongSeveralWorlds) {
    store(true);
    LiveWorlds options = world_named("default", Requested::Nothing);
    options.first_commands.run = true;
    EXPECT_THAT(refusal_of(options), AllOf(HasSubstr("--speed and --start apply to one world"), HasSubstr("fork, w")));
    options.first_commands = {};
    EXPECT_TRUE(choose(options)) << "no command was requested";
    for (const Requested requested : {Requested::Nothing, Requested::World}) {
        options = world_named("w", requested);
        options.first_commands.run = true;
        const auto chosen = choose(options);
        ASSERT_TRUE(chosen) << to_text(chosen.error());
        ASSERT_EQ(requests_of(*chosen).size(), 1u);
        EXPECT_EQ(requests_of(*chosen)[0].run().world(), "w");
    }
}

TEST_F(StoredWorlds, DamagedOnesGetNoCommands) {
    std::ofstream{folder.path() + "/w.evod"} << "this is not a run file";
    LiveWorlds options = world_named("w", Requested::WorldAndSeed);
    options.first_commands = {.speed = simulation::Speed{}, .run = true};
    const auto chosen = choose(options);
    ASSERT_TRUE(chosen) << to_text(chosen.error());
    EXPECT_EQ(chosen->seed(), std::nullopt);
    EXPECT_TRUE(requests_of(*chosen).empty());
}

} // namespace
} // namespace evod::network
