#include "server/experiments/run_recording.h"

#include "server/base/inline_executor.h"
#include "server/replay/verify.h"
#include "server/run_file/check.h"
#include "server/run_file/data_folder.h"
#include "tests/support/shared_worlds.h"
#include "tests/unit/recording/recorded_run.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>

namespace evod::experiments {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class RunRecordingTest : public testing::Test {
  protected:
    static parameters::Experiment three_generations() {
        parameters::Experiment experiment;
        experiment.parameters = recording::small_world();
        experiment.parameters.island_count = 4;
        experiment.parameters.generation_limit = 3;
        experiment.seed = base::Seed{7};
        return experiment;
    }
    base::Result<std::unique_ptr<RunRecording>> open() const { return RunRecording::open(path, experiment, {}); }
    /// Simulates the run, or the rest of it, in so many slices. Without close(), it ends as if it was killed.
    void simulate(simulation::IslandsMaker* maker, base::Executor& executor, int slices, bool closes) const {
        const auto opened = open();
        ASSERT_TRUE(opened) << to_text(opened.error());
        RunRecording& run = **opened;
        ASSERT_NE(run.stored(), Stored::Whole);
        simulation::World world =
            run.stored() == Stored::Part
                ? run.continued_world(experiment, {}, executor, maker)
                : simulation::World{experiment.parameters, *experiment.seed, {}, experiment.schedule, maker};
        ASSERT_TRUE(run.begin(world, {1, 2}));
        for (int slice = 0; slice < slices && world.outcome() == evolution::Outcome::Running; ++slice) {
            const std::uint64_t tick = world.moment().tick, step = run_file::ticks_per_hash;
            const bool begins = world.generation_over();
            world.advance(world.is_shared() ? tick - tick % step + step : tick + 1, executor);
            ASSERT_TRUE(run.follow(world));
            if (begins || world.outcome() != evolution::Outcome::Running) {
                ASSERT_TRUE(run.commit());
            }
        }
        if (closes) {
            ASSERT_TRUE(run.close(world));
        }
    }
    void simulate(std::uint32_t processes, int slices, bool closes) const {
        support::share_worlds(processes, 1, [&](simulation::IslandsMaker& maker, base::Executor& executor) {
            simulate(&maker, executor, slices, closes);
        });
    }
    /// Expects a file that contains the whole run and equals a new simulation.
    void expect_whole() const {
        base::InlineExecutor executor;
        const auto file = run_file::RunFile::open_checked(path);
        ASSERT_TRUE(file) << to_text(file.error());
        const auto verified = replay::verify(**file, executor, [](const replay::VerifyProgress&) {});
        ASSERT_TRUE(verified) << to_text(verified.error());
        EXPECT_FALSE(verified->difference);
        EXPECT_EQ(verified->generations, 3u);
        EXPECT_EQ(verified->hashes, 6u);
        EXPECT_EQ((*open())->stored(), Stored::Whole);
    }

    const support::TemporaryFolder folder;
    const std::string path = folder.path() + "/ring.evod";
    parameters::Experiment experiment = three_generations();
};

constexpr int all = 1'000'000;

TEST_F(RunRecordingTest, StoresAWholeRun) {
    simulate(1, all, true);
    expect_whole();
    const auto file = run_file::RunFile::open_read_only(path);
    EXPECT_EQ((*file)->identity().name, "ring");
    EXPECT_TRUE((*file)->end_mark()->has_value());
    EXPECT_FALSE(fs::exists(path + "-lock"));
}

TEST_F(RunRecordingTest, ContinuesWhatWasKilled) {
    for (const int ticks : {0, 5, 119, 120, 121, 300}) { // a generation has 120 ticks
        fs::remove(path);
        simulate(1, ticks, false);
        EXPECT_EQ((*open())->continues_at(), static_cast<std::uint64_t>(1 + std::max(ticks - 1, 0) / 120));
        simulate(1, all, true);
        expect_whole();
    }
}

TEST_F(RunRecordingTest, AKilledRunVerifies) {
    experiment.parameters.generation_s = 59.0 / 60; // the second generation begins one tick before a stored hash
    for (const int ticks : {58, 59, 60, 61, 100}) {
        fs::remove(path);
        simulate(1, ticks, false);
        base::InlineExecutor executor;
        const auto file = run_file::RunFile::open_checked(path);
        ASSERT_TRUE(file) << to_text(file.error());
        const auto verified = replay::verify(**file, executor, [](const replay::VerifyProgress&) {});
        ASSERT_TRUE(verified) << to_text(verified.error());
        EXPECT_FALSE(verified->difference) << "after " << ticks << " ticks: " << verified->difference->part;
        EXPECT_LE((*file)->last_tick(), static_cast<std::uint64_t>(ticks)) << "it contains no tick that never was";
    }
}

TEST_F(RunRecordingTest, ContinuesWhatWasInterrupted) {
    for (const int ticks : {1, 70, 120, 130}) {
        fs::remove(path);
        simulate(1, ticks, true);
        EXPECT_TRUE(check_end_mark(**run_file::RunFile::open_checked(path))) << "after " << ticks << " ticks";
        simulate(1, all, true);
        expect_whole();
    }
}

TEST_F(RunRecordingTest, ContinuesWithAnotherNumberOfProcesses) {
    simulate(1, 130, false);
    simulate(2, 3, false); // begins the third generation
    EXPECT_EQ((*open())->continues_at(), 3u);
    simulate(4, 1, true);
    simulate(3, all, true);
    expect_whole();
}

TEST_F(RunRecordingTest, AHigherLimitContinuesAWholeRun) {
    for (const int ticks : {all, 50}) { // whole, and interrupted
        fs::remove(path);
        experiment.parameters.generation_limit = 1;
        simulate(1, ticks, true);
        experiment.parameters.generation_limit = 2;
        EXPECT_EQ((*open())->stored(), Stored::Part);
        simulate(2, all, true);
        EXPECT_EQ((*open())->stored(), Stored::Whole);
        experiment.parameters.generation_limit = 0;
        EXPECT_EQ((*open())->stored(), Stored::Part) << "no limit";
        experiment.parameters.generation_limit = 3;
        simulate(1, 1, false); // killed
        simulate(1, all, true);
        expect_whole();
        EXPECT_EQ((*run_file::RunFile::open_read_only(path))->identity().parameters.generation_limit, 3u);
    }
    experiment.parameters.generation_limit = 2;
    EXPECT_THAT(open().error().message, HasSubstr("its generation_limit is 3, not 2"));
}

TEST_F(RunRecordingTest, ReadsTheStatisticsOfEarlierGenerations) {
    simulate(1, 250, false);
    const auto run = open();
    std::vector<std::uint64_t> generations;
    ASSERT_TRUE((*run)->read_statistics([&](const auto& islands) {
        EXPECT_EQ(islands.size(), 4u);
        generations.push_back(islands.front().generation);
    }));
    EXPECT_THAT(generations, testing::ElementsAre(1, 2));
}

TEST_F(RunRecordingTest, RefusesAnotherRun) {
    simulate(1, 130, true);
    const auto refusal_with = [&](auto&& change) {
        parameters::Experiment other = experiment;
        change(other);
        const auto run = RunRecording::open(path, other, {});
        return run ? std::string{} : run.error().message;
    };
    EXPECT_THAT(refusal_with([](auto& other) { other.seed = base::Seed{8}; }), HasSubstr("its seed is 7, not 8"));
    EXPECT_THAT(refusal_with([](auto& other) { other.parameters.food_count = 3; }),
                HasSubstr("its food_count is 40, not 3"));
    EXPECT_THAT(refusal_with([](auto& other) {
                    other.schedule.add(2, {"mutation_chance", 0.5});
                }),
                HasSubstr("schedule"));
    EXPECT_EQ(refusal_with([](auto& other) { other.seed.reset(); }), "");
    const auto drawn = std::make_shared<const std::vector<evolution::GeneMatrix>>();
    EXPECT_THAT(RunRecording::open(path, experiment, drawn).error().message, HasSubstr("first population"));
}

TEST_F(RunRecordingTest, RefusesAFileThatIsBeingWritten) {
    const auto first = open();
    ASSERT_TRUE(first);
    EXPECT_THAT(open().error().message, HasSubstr("another program is writing to it"));
}

TEST_F(RunRecordingTest, RefusesAFolderThatAServerUses) {
    const auto server = run_file::DataFolder::open(folder.path());
    ASSERT_TRUE(server);
    EXPECT_THAT(open().error().message, HasSubstr("a server uses its folder"));
}

TEST_F(RunRecordingTest, RefusesOtherFiles) {
    std::ofstream{path} << "generation,island,best,mean,median\n";
    EXPECT_THAT(open().error().message, HasSubstr(path));
    EXPECT_EQ(fs::file_size(path), 35u);
    EXPECT_FALSE(fs::exists(path + "-lock"));
}

TEST_F(RunRecordingTest, ReportsAStateThatDiffersFromTheStoredOne) {
    simulate(1, 70, true);
    {
        auto file = run_file::RunFile::open(path, {});
        ASSERT_TRUE(file);
        (*file)->begin();
        (*file)->write(run_file::HashRecord{60, {1, 2}});
        (*file)->write(run_file::EndMark{.tick = 70});
        ASSERT_TRUE((*file)->commit());
    }
    base::InlineExecutor executor;
    const auto run = open();
    simulation::World world = (*run)->continued_world(experiment, {}, executor, nullptr);
    ASSERT_TRUE((*run)->begin(world, {1, 2}));
    base::Result<void> followed;
    for (int tick = 0; tick < 60; ++tick) {
        ASSERT_TRUE(followed);
        world.advance_tick(executor);
        followed = (*run)->follow(world);
    }
    ASSERT_FALSE(followed);
    EXPECT_THAT(followed.error().message, HasSubstr("the stored state hash of tick 60 differs"));
}

} // namespace
} // namespace evod::experiments
