#include "server/replay/generation_reader.h"
#include "server/replay/mismatch.h"
#include "server/replay/recovery.h"
#include "server/replay/rerun.h"
#include "server/replay/run_file_fork.h"
#include "server/replay/verify.h"
#include "server/run_file/check.h"
#include "tests/support/waiting.h"
#include "tests/unit/recording/recorded_run.h"

#include <gmock/gmock.h>

namespace evod::run_file {
namespace {

using namespace recording;
using namespace replay;

using testing::ElementsAre;

class KeepEveryTest : public testing::Test {
  protected:
    KeepEveryTest() : data{*DataFolder::open(folder.path())} {}

    /// A run of 41.5 generations; its file is as a failure of the machine leaves it.
    void record(const RunFile::Options& options) {
        begun.clear();
        StorageThread thread{options};
        RecordedRun run{data, thread};
        begun.push_back(beginning_of(run.world()));
        for (int tick = 1; tick <= 4'980; ++tick) {
            if (tick % 1000 == 70) {
                run.command(set_parameter("mutation_chance", 0.1 + tick * 1e-5));
                EXPECT_TRUE(wait_until([&] { return thread.idle(); }));
            }
            run.advance(1);
            if (run.world().moment().generation_tick == 1 && run.world().moment().generation > 1) {
                begun.push_back(beginning_of(run.world()));
            }
        }
        hash = run.world().hash();
    }
    std::unique_ptr<RunFile> file() {
        auto opened = RunFile::open_read_only(data.file_of("w"));
        EXPECT_TRUE(opened) << to_text(opened.error());
        return *std::move(opened);
    }
    static std::vector<std::uint64_t> held(RunFile& file) {
        std::vector<std::uint64_t> generations;
        for (std::uint64_t generation = 1; generation <= file.generations().last(); ++generation) {
            if (*file.generations().beginning_of(generation)) {
                generations.push_back(generation);
            } else {
                EXPECT_FALSE(*file.generations().outcome_of(generation));
            }
        }
        return generations;
    }
    /// Checks that nothing is lost.
    void expect_whole(RunFile& run) {
        const auto checked = check(run);
        ASSERT_TRUE(checked) << to_text(checked.error());
        auto recovered = recover(run, executor);
        ASSERT_TRUE(recovered) << to_text(recovered.error());
        EXPECT_EQ(recovered->world.hash(), hash);
        GenerationReader reader{run, executor};
        for (const GenerationBegun& stored : begun) {
            const auto whole = reader.read(stored.opening.moment.generation);
            ASSERT_TRUE(whole) << to_text(whole.error());
            EXPECT_FALSE(compare(stored.born, whole->begun.born));
        }
        EXPECT_EQ(Rerun::at(run, begun.size() + 1, executor).error().code, base::RefusalCode::NotFound);
        const auto forked = fork(run, 8, data.file_of("fork"), "fork", {}, executor);
        ASSERT_TRUE(forked) << to_text(forked.error());
        std::filesystem::remove(data.file_of("fork"));
        const auto verified = verify(run, executor, [](const VerifyProgress&) {});
        ASSERT_TRUE(verified) << to_text(verified.error());
        EXPECT_FALSE(verified->difference) << verified->difference->part;
        EXPECT_EQ(verified->generations, 42u);
    }

    TemporaryFolder folder;
    DataFolder data;
    base::InlineExecutor executor;
    std::vector<GenerationBegun> begun;
    base::StateHash hash;
};

TEST_F(KeepEveryTest, RetainsEachFifthGenerationAndTheLast) {
    record({.durability = Durability::Relaxed});
    const auto whole_bytes = std::filesystem::file_size(data.file_of("w"));
    folder.clear();
    record({.durability = Durability::Relaxed, .keep_every = 5});
    EXPECT_LT(std::filesystem::file_size(data.file_of("w")), whole_bytes * 5 / 6);
    const auto run = file();
    EXPECT_THAT(held(*run), ElementsAre(1, 6, 11, 16, 21, 26, 31, 36, 41, 42));
    expect_whole(*run);
}

TEST_F(KeepEveryTest, ALargeFileRetainsStillFewerGenerations) {
    record({.durability = Durability::Relaxed, .vfs = nullptr, .file_bytes_max = 60 << 10, .keep_every = 5});
    const auto run = file();
    const auto generations = held(*run);
    EXPECT_LT(generations.size(), 10u);
    EXPECT_EQ((generations[1] - 1) % 10, 0u);
    expect_whole(*run);
}

TEST_F(KeepEveryTest, AFileKeepsTheRetentionItBeganWith) {
    for (const std::uint64_t later : {1u, 2u, 7u}) {
        folder.clear();
        record({.durability = Durability::Relaxed, .keep_every = 5});
        auto opened = RunFile::open(data.file_of("w"), {.durability = Durability::Relaxed, .keep_every = later});
        ASSERT_TRUE(opened) << to_text(opened.error());
        EXPECT_EQ((*opened)->retention().keep_every(), 5u);
        auto rerun = Rerun::at(**opened, 42, executor);
        ASSERT_TRUE(rerun) << to_text(rerun.error());
        (*opened)->begin();
        const auto& world = rerun->world();
        while (world.moment().generation < 48) {
            rerun->advance_tick(executor);
            if (world.moment().generation_tick == 1 && world.moment().generation > 42) {
                (*opened)->write(beginning_of(world));
            }
            if (world.moment().tick % ticks_per_hash == 0) {
                (*opened)->write(HashRecord{world.moment().tick, world.hash()});
            }
            if (world.generation_over()) {
                (*opened)->write(end_of(world));
            }
        }
        ASSERT_TRUE((*opened)->commit());
        EXPECT_THAT(held(**opened), ElementsAre(1, 6, 11, 16, 21, 26, 31, 36, 41, 46, 48));
        const auto verified = verify(*file(), executor, [](const VerifyProgress&) {});
        ASSERT_TRUE(verified) << to_text(verified.error());
        EXPECT_FALSE(verified->difference) << verified->difference->part;
    }
}

} // namespace
} // namespace evod::run_file
