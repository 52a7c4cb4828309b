#include "server/experiments/run_writer.h"

#include "server/run_file/run_file.h"
#include "tests/unit/recording/recorded_run.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <optional>

namespace evod::experiments {
namespace {

namespace fs = std::filesystem;

class RunWriterTest : public testing::Test {
  protected:
    static parameters::Parameters two_generations() {
        parameters::Parameters parameters = recording::small_world();
        parameters.generation_limit = 2;
        return parameters;
    }
    /// Simulates the world to its end, or for so many ticks.
    base::Result<void> simulate(RunWriter& writer, std::optional<int> ticks = {}) {
        base::Result<void> followed = writer.follow(world);
        for (int tick = 0; followed && tick != ticks && world.outcome() == evolution::Outcome::Running; ++tick) {
            if (world.generation_over()) {
                world.breed_next_generation(executor);
            }
            world.advance_tick(executor);
            followed = writer.follow(world);
        }
        return followed;
    }

    const recording::TemporaryFolder folder;
    const std::string path = folder.path() + "/run.evod";
    base::InlineExecutor executor;
    simulation::World world{two_generations(), base::Seed{7}};
};

TEST_F(RunWriterTest, WritesTheWholeRun) {
    RunWriter writer{path, "w", {1, 2}, world};
    ASSERT_TRUE(simulate(writer));
    EXPECT_FALSE(fs::exists(path)) << "the file has its name only when it is complete";
    ASSERT_TRUE(writer.finish());
    auto file = run_file::RunFile::open_checked(path);
    ASSERT_TRUE(file) << to_text(file.error());
    EXPECT_EQ((*file)->identity().name, "w");
    EXPECT_EQ((*file)->identity().run_id, (simulation::RunId{1, 2}));
    EXPECT_EQ((*file)->identity().seed, base::Seed{7});
    EXPECT_EQ((*file)->generations().last_ended(), 2u);
    EXPECT_EQ((*file)->contents().tick, world.moment().tick);
}

TEST_F(RunWriterTest, LeavesNothingOfAnUnfinishedRun) {
    {
        RunWriter writer{path, "w", {1, 2}, world};
        ASSERT_TRUE(simulate(writer, 5));
        EXPECT_FALSE(fs::is_empty(folder.path()));
    }
    EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST_F(RunWriterTest, ReplacesAnEarlierFile) {
    for (const char* name : {"first", "second"}) {
        simulation::World again{two_generations(), base::Seed{7}};
        RunWriter writer{path, name, {1, 2}, again};
        ASSERT_TRUE(writer.follow(again));
        ASSERT_TRUE(writer.finish());
    }
    auto file = run_file::RunFile::open_checked(path);
    ASSERT_TRUE(file) << to_text(file.error());
    EXPECT_EQ((*file)->identity().name, "second");
}

TEST_F(RunWriterTest, ReportsAFolderThatDoesNotExist) {
    RunWriter writer{folder.path() + "/nowhere/run.evod", "w", {1, 2}, world};
    const auto followed = simulate(writer); // the first transaction ends with the generation
    ASSERT_FALSE(followed);
    EXPECT_THAT(followed.error().message, testing::HasSubstr("/nowhere/"));
    EXPECT_FALSE(writer.finish());
}

} // namespace
} // namespace evod::experiments
