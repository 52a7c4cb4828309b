#include "server/experiments/sweep_runner.h"

#include "tests/unit/recording/recorded_run.h"

#include <gmock/gmock.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace evod::experiments {
namespace {

Sweep small_sweep() {
    const auto sweep = parse_sweep(R"({"experiment": {"population_size": 4, "generation_s": 1},
        "grid": {"food_count": [5, 9]}, "replicates": 2, "generations": 3, "seed": 4})",
                                   [](const std::string&) { return parameters::Experiment{}; });
    EXPECT_TRUE(sweep) << to_text(sweep.error());
    return *sweep;
}

std::string table_of(const Sweep& sweep, const std::string& path, std::size_t jobs) {
    const auto folder = SweepFolder::open(path, sweep);
    SweepRunner runner{sweep, *folder, {.jobs = jobs}};
    const auto made = runner.execute({0, 1, 2, 3});
    EXPECT_TRUE(made && *made == 4);
    EXPECT_TRUE(folder->gather());
    std::ifstream table{folder->table()};
    return {std::istreambuf_iterator<char>{table}, {}};
}

TEST(SweepRunner, WritesTheSameTableWithAnyNumberOfJobs) {
    const recording::TemporaryFolder folder;
    const Sweep sweep = small_sweep();
    EXPECT_EQ(table_of(sweep, folder.path() + "/one", 1), table_of(sweep, folder.path() + "/three", 3));
}

TEST(SweepRunner, ReportsAllOfTheExpectedWork) {
    const recording::TemporaryFolder temporary;
    const Sweep sweep = small_sweep();
    const auto folder = SweepFolder::open(temporary.path() + "/sweep", sweep);
    double work = 0;
    std::size_t runs = 0;
    SweepRunner runner{sweep,
                       *folder,
                       {.on_generation = [&](double more) { work += more; },
                        .on_run =
                            [&](double more) {
                                work += more;
                                ++runs;
                            }}};
    const std::vector<std::size_t> all{0, 1, 2, 3};
    ASSERT_TRUE(runner.execute(all));
    EXPECT_EQ(runs, 4u);
    EXPECT_DOUBLE_EQ(work, *runner.work_of(all));
    EXPECT_DOUBLE_EQ(work, 4 * 3 * 4 / sweep.parameters.tick_s); // runs, generations, organisms
}

TEST(SweepRunner, AStoppedRunLeavesNoFile) {
    const recording::TemporaryFolder temporary;
    const Sweep sweep = small_sweep();
    const auto folder = SweepFolder::open(temporary.path() + "/sweep", sweep);
    std::atomic<bool> stopped = false;
    SweepRunner runner{
        sweep, *folder, {.stopped = [&] { return stopped.load(); }, .on_generation = [&](double) { stopped = true; }}};
    const auto made = runner.execute({0, 1, 2, 3});
    ASSERT_TRUE(made);
    EXPECT_EQ(*made, 0u);
    EXPECT_TRUE(std::filesystem::is_empty(temporary.path() + "/sweep/parts"));
}

TEST(SweepRunner, AnErrorEndsTheSweep) {
    const recording::TemporaryFolder temporary;
    const Sweep sweep = small_sweep();
    const auto folder = SweepFolder::open(temporary.path() + "/sweep", sweep);
    std::filesystem::remove_all(temporary.path() + "/sweep/parts");
    SweepRunner runner{sweep, *folder, {.jobs = 2}};
    EXPECT_FALSE(runner.execute({0, 1, 2, 3}));
}

TEST(SweepRunner, TheWorkOfARunWithoutALimitIsUnknown) {
    parameters::Parameters world;
    world.generation_limit = 0;
    EXPECT_EQ(work_of_run(world), std::nullopt);
    world.generation_limit = 3;
    EXPECT_DOUBLE_EQ(*work_of_run(world), 3 * work_of_generation(world));
}

} // namespace
} // namespace evod::experiments
