#include "client/viewer/world/status_text.h"

#include "client/core/client_types.h"

#include <gmock/gmock.h>

namespace evod::viewer {
namespace {

using testing::ElementsAre;

TEST(StatusText, DescribesTheStateOfTheDisk) {
    evod::v1::Storage storage;
    EXPECT_EQ(storage_text(storage), "");
    EXPECT_STREQ(state_text(evod::v1::RUN_STATE_RUNNING, storage, false), "running");
    storage.set_state(evod::v1::STORAGE_STATE_FAILING);
    storage.set_reason("it is full");
    EXPECT_EQ(storage_text(storage), "It is full") << "from a server that sends no text";
    storage.set_text("commands are refused: it is full");
    EXPECT_EQ(storage_text(storage), "Commands are refused: it is full");
    EXPECT_STREQ(state_text(evod::v1::RUN_STATE_RUNNING, storage, false), "running");
    storage.set_state(evod::v1::STORAGE_STATE_STALLED);
    EXPECT_STREQ(state_text(evod::v1::RUN_STATE_RUNNING, storage, false), "waits for the disk");
    EXPECT_STREQ(state_text(evod::v1::RUN_STATE_PAUSED, storage, false), "paused");
    EXPECT_STREQ(state_word(evod::v1::RUN_STATE_PAUSED, storage, false), "paused");
    EXPECT_STREQ(state_text(evod::v1::RUN_STATE_WAITING, storage, false), "waiting – Space runs");
    EXPECT_STREQ(state_word(evod::v1::RUN_STATE_WAITING, storage, false), "waiting");
}

TEST(StatusText, ARunningWorldMayWaitForFitness) {
    const evod::v1::Storage storage;
    EXPECT_STREQ(state_text(evod::v1::RUN_STATE_RUNNING, storage, true), "waits for fitness");
    EXPECT_STREQ(state_word(evod::v1::RUN_STATE_PAUSED, storage, true), "paused");
    evod::v1::AwaitedFitness awaited;
    EXPECT_EQ(core::to_text(awaited, 2), "2 of 2 islands rated");
    awaited.add_islands(1);
    EXPECT_EQ(core::to_text(awaited, 2), "1 of 2 islands rated");
    EXPECT_EQ(core::to_text(awaited, 1), "0 of 1 island rated");
}

TEST(StatusText, FormatsSpeedsAsMultiplesOfRealTime) {
    evod::v1::Speed speed;
    speed.set_real_time_factor(1);
    EXPECT_EQ(speed_text(speed), "1×");
    speed.set_real_time_factor(64);
    EXPECT_EQ(speed_text(speed), "64×");
    speed.set_real_time_factor(0.125);
    EXPECT_EQ(speed_text(speed), "1/8×");
    speed.set_real_time_factor(0.3);
    EXPECT_EQ(speed_text(speed), "0.3×");
    speed.set_max(true);
    EXPECT_EQ(speed_text(speed), "max");
    EXPECT_EQ(speed_text(10000), "10,000×");
}

TEST(StatusText, FormatsARefusalAsASentence) {
    evod::v1::Status status;
    status.set_message("no such island\n  subscribe_snapshots.island: got 9, allowed 0 to 7");
    status.add_violations()->set_field("subscribe_snapshots.island");
    EXPECT_EQ(refusal_text(status), "No such island: island: got 9, allowed 0 to 7");
    status.set_message("fork_world.name: got \"a b\", allowed 1 to 64 letters");
    status.mutable_violations(0)->set_field("fork_world.name");
    EXPECT_EQ(refusal_text(status), "Name: got \"a b\", allowed 1 to 64 letters");
    status.set_message("2 fields are invalid\n  fork_world.name: got a b, allowed 1 to 64 letters\n"
                       "  fork_world.seed: got x, allowed a number");
    status.add_violations()->set_field("fork_world.seed");
    EXPECT_EQ(refusal_text(status), "2 fields are invalid: name: got a b, allowed 1 to 64 letters; "
                                    "seed: got x, allowed a number");
}

TEST(StatusText, DescribesALossWithoutCodesAndOptions) {
    core::ConnectionStatus status;
    EXPECT_EQ(connection_loss_text(status, true), "");
    status.reason = "no server at localhost:1";
    EXPECT_EQ(connection_loss_text(status, true), "No server at localhost:1");
    status.reason = "the server at localhost:1 refused us: UNAUTHENTICATED: this server does not know the token";
    status.refusal.emplace().set_message("this server does not know the token");
    status.token_needed = true;
    EXPECT_EQ(connection_loss_text(status, true), "This server does not know the token");
    status.refusal->set_message("this server wants a token: --token-file gives it one");
    EXPECT_EQ(connection_loss_text(status, false), "The server requires a token: ask its administrator for one");
}

TEST(StatusText, NamesTheIslandOnlyIfThereAreSeveral) {
    evod::v1::SnapshotFrame snapshot;
    snapshot.set_world("default");
    snapshot.set_island_count(1);
    snapshot.mutable_speed()->set_real_time_factor(2);
    snapshot.set_state(evod::v1::RUN_STATE_RUNNING);
    snapshot.set_ticks_per_s(119.7);
    RunControl control;
    control.update(snapshot);
    EXPECT_EQ(place_and_speed_text("default", snapshot, control), "default · 2× (120 ticks/s)");
    snapshot.set_island_count(8);
    snapshot.set_island(2);
    EXPECT_EQ(place_and_speed_text("default", snapshot, control), "default · island 2 of 0–7 · 2× (120 ticks/s)");
    EXPECT_EQ(place_text("default", snapshot), "default · island 2 of 0–7");
}

TEST(StatusText, ListsTheStatisticsOfBothGenerations) {
    evod::v1::SnapshotFrame snapshot;
    snapshot.set_tick(36'034);
    snapshot.set_simulated_s(600.56);
    snapshot.mutable_live()->set_alive_count(43);
    snapshot.mutable_live()->set_organism_count(50);
    snapshot.mutable_live()->set_health_mean(78.25);
    snapshot.mutable_live()->set_food_eaten(1312);
    snapshot.mutable_live()->set_poison_eaten(45);
    evod::v1::GenerationStatistics last;
    last.set_generation(15);
    last.set_fitness_best(251.34);
    last.set_fitness_mean(160.2);
    EXPECT_THAT(statistics_texts(snapshot, &last),
                ElementsAre("alive 43 of 50", "mean health 78.2", "food eaten 1,312", "poison eaten 45",
                            "tick 36,034 (10:01 min)", "fitness of generation 15: best 251.3, mean 160.2"));
    EXPECT_EQ(statistics_texts(snapshot, nullptr).size(), 5u);
    snapshot.mutable_live()->set_predator_count(9);
    snapshot.mutable_live()->set_eaten_count(31);
    snapshot.mutable_live()->set_born_count(1200);
    last.mutable_predators()->set_fitness_best(12);
    last.mutable_predators()->set_fitness_mean(3.5);
    EXPECT_THAT(statistics_texts(snapshot, &last),
                ElementsAre("alive 43 of 50", "predators 9, prey eaten 31", "born 1,200", "mean health 78.2",
                            "food eaten 1,312", "poison eaten 45", "tick 36,034 (10:01 min)",
                            "fitness of generation 15: best 251.3, mean 160.2",
                            "of its predators: best 12.0, mean 3.5"));
}

TEST(StatusText, LabelsReplaysOfLiveWorldsAndOfRunFiles) {
    evod::v1::Replay replay;
    EXPECT_EQ(replay_label(replay), "REPLAY");
    replay.set_replay_of("default");
    EXPECT_EQ(replay_label(replay), "REPLAY of default");
    evod::v1::SnapshotFrame snapshot;
    snapshot.set_generation(1200);
    EXPECT_EQ(shown_text("default", nullptr, &snapshot), "World default");
    EXPECT_EQ(shown_text("default@3", &replay, &snapshot), "Replay of default, generation 1,200");
    replay.clear_replay_of();
    EXPECT_EQ(shown_text("file", &replay, nullptr), "Replay of a file");
}

} // namespace
} // namespace evod::viewer
