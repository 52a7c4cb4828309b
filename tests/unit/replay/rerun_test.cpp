#include "server/replay/recovery.h"
#include "server/replay/rerun.h"

#include "tests/unit/replay/stored_run_fixture.h"

#include <gmock/gmock.h>

#include <functional>
#include <initializer_list>
#include <limits>
#include <random>
#include <sstream>

namespace evod::replay {
namespace {

using namespace run_file;
using namespace recording;

using testing::HasSubstr;

class RerunTest : public StoredRuns {};

TEST_F(RerunTest, AWorldContinuesExactly) {
    std::mt19937 random{1};
    for (int round = 0; round < 30; ++round) {
        begin_again();
        RecordedRun run{data, *thread};
        run.advance(random() % 200);
        run.command(set_parameter("mutation_chance", 0.3));
        if (round % 2 == 1) {
            run.command(set_parameter("shuffle_fitness", true));
        }
        if (round % 3 == 0) { // eaten items become part of the state in the next generation
            run.command(set_parameter("fitness_per_food", 5.0));
            run.command(set_parameter("fitness_per_poison", -7.5));
        }
        run.advance(random() % 200);
        run.command(set_parameter("food_health", 3.0));
        run.command(set_parameter("population_size", 17u)); // from the next generation on
        run.advance(random() % 300);
        run.command(set_parameter("food_health", 4.0)); // the last moment in the file

        const auto file = file_left();
        auto recovered = recover(*file, three_threads);
        ASSERT_TRUE(recovered) << to_text(recovered.error());
        simulation::World& again = recovered->world;
        EXPECT_EQ(again.moment().tick, run.world().moment().tick);
        EXPECT_EQ(again.moment().simulated_s, run.world().moment().simulated_s);
        EXPECT_EQ(again.hash(), run.world().hash());
        EXPECT_EQ(again.parameters().revision, run.world().parameters().revision);
        EXPECT_TRUE(again.parameters().requested == run.world().parameters().requested);
        EXPECT_EQ(again.history().size(), run.world().history().size());
        for (int tick = 0; tick < 300; ++tick) {
            again.advance_tick(three_threads);
            run.world().advance_tick(executor);
            ASSERT_EQ(again.hash(), run.world().hash());
        }
    }
}

TEST_F(RerunTest, ARunIsRecoveredAtTheEndOfAGeneration) {
    RecordedRun run{data, *thread};
    run.advance(240); // exactly two generations
    ASSERT_TRUE(run.world().generation_over());
    const auto file = file_left();
    const auto recovered = recover(*file, executor);
    ASSERT_TRUE(recovered) << to_text(recovered.error());
    EXPECT_TRUE(recovered->world.generation_over());
    EXPECT_EQ(recovered->world.hash(), run.world().hash());
    EXPECT_EQ(recovered->world.history().size(), 2u);
}

TEST_F(RerunTest, AClosedRunIsRecoveredAtItsLastTick) {
    RecordedRun run{data, *thread};
    run.advance(101); // between two stored hashes
    run.recorder().close_all(run.laboratory());
    const auto file = file_left();
    const auto recovered = recover(*file, executor);
    ASSERT_TRUE(recovered) << to_text(recovered.error());
    EXPECT_EQ(recovered->world.moment().tick, 101u);
    EXPECT_EQ(recovered->world.hash(), run.world().hash());
}

TEST_F(RerunTest, RunControlIsOfTheLastCommandWithoutReachedGoals) {
    const auto control_after = [&](std::uint64_t ticks, auto... requests) {
        begin_again();
        RecordedRun run{data, *thread};
        (run.command(requests), ...);
        run.advance(ticks);
        const auto file = file_left();
        return recover(*file, executor)->control;
    };
    v1::Request endless, two_generations, until_tick, release, pause, speed;
    release.mutable_release_lease();
    endless.mutable_run();
    two_generations.mutable_run()->set_generations(2);
    until_tick.mutable_run_until_tick()->set_tick(120);
    pause.mutable_pause();
    speed.mutable_set_speed()->mutable_speed()->set_max(true);

    simulation::RunControl control = control_after(60, endless, speed);
    EXPECT_TRUE(control.endless && !control.paused && !control.speed);
    control = control_after(60, endless, pause);
    EXPECT_TRUE(control.endless && control.paused);
    control = control_after(180, two_generations);
    EXPECT_EQ(control.until_generation, 2u);
    control = control_after(240, two_generations);
    EXPECT_FALSE(control.until_generation);
    control = control_after(60, until_tick);
    EXPECT_EQ(control.until_tick, 120u);
    control = control_after(120, until_tick);
    EXPECT_TRUE(!control.until_tick && control.paused && !control.leased);
    control = control_after(120, endless, until_tick);
    EXPECT_TRUE(control.endless && control.paused && control.leased);
    control = control_after(180, endless, until_tick, release);
    EXPECT_TRUE(control.endless && !control.paused && !control.leased);
}

TEST_F(RerunTest, EveryGenerationCanBeReproduced) {
    RecordedRun run{data, *thread};
    std::vector<base::StateHash> hashes{run.world().hash()};
    for (int tick = 0; tick < 600; ++tick) {
        if (tick % 130 == 50) {
            run.command(set_parameter("mutation_chance", 0.1 + tick * 1e-3));
        }
        run.advance(1);
        hashes.push_back(run.world().hash());
    }
    const auto file = file_left();
    for (std::uint64_t generation = 1; generation <= 5; ++generation) {
        auto rerun = Rerun::at(*file, generation, executor);
        ASSERT_TRUE(rerun) << to_text(rerun.error());
        EXPECT_EQ(rerun->world().moment().generation, generation);
        while (rerun->world().moment().tick < 600) {
            rerun->advance_tick(executor);
            ASSERT_EQ(rerun->world().hash(), hashes[rerun->world().moment().tick]);
        }
    }
    EXPECT_EQ(Rerun::at(*file, 6, executor).error().code, base::RefusalCode::NotFound);
}

TEST_F(RerunTest, ADifferentStateHashIsReported) {
    {
        RecordedRun run{data, *thread};
        run.advance(200);
    }
    const auto file = file_left();
    file->begin();
    file->write(HashRecord{180, {1, 2}});
    ASSERT_TRUE(file->commit());
    const auto refused = recover(*file, executor).error();
    EXPECT_EQ(refused.code, base::RefusalCode::DataLoss);
    EXPECT_THAT(refused.message, HasSubstr("tick 180"));
}

TEST_F(RerunTest, ARunOfAnotherModelIsReadButNotSimulated) {
    const std::string path = folder.path() + "/old.evod";
    RunIdentity identity{.name = "old", .run_id = {}, .seed = {}, .parameters = {}};
    identity.model_version = simulation::model_version - 1;
    identity.evod_version = "0.0.9";
    ASSERT_TRUE(RunFile::create(path, identity, {}));
    const auto file = RunFile::open_read_only(path);
    ASSERT_TRUE(file);
    const auto refused = recover(**file, executor).error();
    EXPECT_EQ(refused.code, base::RefusalCode::FailedPrecondition);
    EXPECT_THAT(refused.message, HasSubstr("evod 0.0.9"));
}

TEST_F(RerunTest, AppliedChangesAreNotKept) {
    RecordedRun run{data, *thread};
    for (int change = 0; change < 50; ++change) {
        run.command(set_parameter("food_health", 1.0 + change));
        run.advance(4);
    }
    const auto file = file_left();
    auto rerun = Rerun::at(*file, 1, executor);
    ASSERT_TRUE(rerun) << to_text(rerun.error());
    rerun->apply_changes();
    EXPECT_EQ(rerun->changes().waiting_count(), 49u);
    rerun->advance_to(100, executor);
    EXPECT_EQ(rerun->changes().waiting_count(), 24u);
    rerun->advance_to(200, executor);
    EXPECT_EQ(rerun->changes().waiting_count(), 0u);
    EXPECT_EQ(rerun->world().hash(), run.world().hash());
}

/// Writes another beginning of generation 2, with right checksums.
struct OtherBeginning {
    const char* impossible;
    std::function<void(GenerationBegun&)> make;
};

TEST_F(RerunTest, AnImpossibleBeginningIsReported) {
    constexpr float nan = std::numeric_limits<float>::quiet_NaN(), infinite = std::numeric_limits<float>::infinity();
    const auto gene = [](unsigned which, float value) {
        return [which, value](GenerationBegun& begun) { begun.born[1].genes(which, 3) = value; };
    };
    for (const OtherBeginning& other : std::initializer_list<OtherBeginning>{
             {"population", gene(evolution::BodySize, nan)},
             {"population", gene(evolution::BodySize, 0)},
             {"population", gene(evolution::BodySize, -1)},
             {"population", gene(evolution::BodySize, 9'000)}, // wider than the island
             {"population", gene(evolution::NormalSpeed, infinite)},
             {"population", gene(evolution::BaseHealth, 1e30f)},
             {"population",
              [](GenerationBegun& begun) {
                  begun.born[0].genes.resize(Eigen::NoChange, 0);
                  begun.born[0].parents.clear();
                  begun.founders[0].clear();
              }},
             {"moment",
              [](GenerationBegun& begun) {
                  begun.opening.moment.simulated_s = std::numeric_limits<double>::infinity();
              }},
             // Each set is valid, but after the next tick the organisms of this generation would not have room.
             {"parameters",
              [](GenerationBegun& begun) {
                  begun.opening.parameters.requested.values.body_size_max = 1'000;
                  begun.opening.parameters.requested.values.population_size = 5;
              }},
         }) {
        begin_again();
        {
            RecordedRun run{data, *thread};
            run.advance(300);
        }
        const auto file = file_left();
        GenerationBegun begun = **file->generations().beginning_of(2);
        other.make(begun);
        file->begin();
        file->write(begun);
        ASSERT_TRUE(file->commit());
        const auto rerun = Rerun::at(*file, 2, executor);
        ASSERT_FALSE(rerun);
        EXPECT_EQ(rerun.error().code, base::RefusalCode::DataLoss);
        EXPECT_THAT(rerun.error().message,
                    HasSubstr(std::string{" is damaged: generation 2 begins with an impossible "} + other.impossible));
    }
}

TEST_F(RerunTest, ALineageFromImpossibleFitnessIsReported) {
    RecordedRun run{data, *thread};
    run.advance(500);
    const auto file = file_left();
    GenerationEnded ended = **file->generations().outcome_of(2); // migrants are chosen at its end
    ended.outcomes[1].fitness[4] = std::numeric_limits<double>::quiet_NaN();
    file->begin();
    file->write(ended);
    ASSERT_TRUE(file->commit());
    std::ostringstream text;
    const auto written = write_table({*file, executor}, {.table = RunTable::Lineage}, text);
    ASSERT_FALSE(written);
    EXPECT_THAT(written.error().message, HasSubstr("generation 3 was bred from organisms without a finite fitness"));
}

} // namespace
} // namespace evod::replay
