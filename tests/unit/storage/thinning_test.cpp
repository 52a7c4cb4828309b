#include "server/storage/fork.h"
#include "server/storage/rerun.h"
#include "tests/unit/storage/recorded_run.h"

#include <gmock/gmock.h>

#include <chrono>

namespace evod::storage {
namespace {

constexpr std::int64_t bytes_max = 230 << 10;

/// A hundred generations in a file that has room for some thirty of them whole.
class ThinningTest : public testing::Test {
  protected:
    ThinningTest() : data{*DataFolder::open(folder.path())} {
        StorageThread thread{{.durability = Durability::Relaxed, .vfs = nullptr, .file_bytes_max = bytes_max}};
        RecordedRun run{data, thread};
        hashes.push_back(run.world().hash());
        for (int tick = 1; tick <= 12'050; ++tick) {
            if (tick % 1000 == 70) {
                run.command(set_parameter("mutation_chance", 0.1 + tick * 1e-5));
                // So that the file is written, and thinned, many times.
                while (!thread.idle())
                    std::this_thread::sleep_for(std::chrono::milliseconds{1});
            }
            run.advance(1);
            hashes.push_back(run.world().hash());
        }
        run.recorder().close_all(run.laboratory());
    }

    TemporaryFolder folder;
    DataFolder data;
    base::InlineExecutor executor;
    std::vector<base::StateHash> hashes; // by tick
};

TEST_F(ThinningTest, KeepsTheFileSmallAndTheRunWhole) {
    EXPECT_LT(std::filesystem::file_size(data.file_of("w")), 2 * bytes_max);
    const auto file = RunFile::open_read_only(data.file_of("w"));
    ASSERT_TRUE(file) << to_text(file.error());
    const auto checked = (*file)->check();
    ASSERT_TRUE(checked) << to_text(checked.error());
    EXPECT_EQ((*file)->last_generation(), 101u);
    EXPECT_EQ((*file)->journal()->size(), 12u);
    EXPECT_EQ((*file)->history(1000, 1000)->size(), 100u);

    std::vector<std::uint64_t> held;
    for (std::uint64_t generation = 1; generation <= 101; ++generation) {
        if (*(*file)->beginning_of(generation))
            held.push_back(generation);
        else
            EXPECT_FALSE(*(*file)->outcome_of(generation)) << generation;
    }
    EXPECT_LT(held.size(), 60u);
    EXPECT_EQ(held.front(), 1u);
    EXPECT_EQ(held.back(), 101u);
    // Evenly: among the older ones every second, or fourth, …; the newest are all there.
    const std::uint64_t step = held[1] - held[0];
    EXPECT_GE(step, 2u);
    EXPECT_EQ(held[2] - held[1], step);
    EXPECT_EQ(held[held.size() - 2], 100u);

    auto recovered = recover(**file, executor);
    ASSERT_TRUE(recovered) << to_text(recovered.error());
    EXPECT_EQ(recovered->world.hash(), hashes.back());
}

TEST_F(ThinningTest, WhatWasTakenOutIsSimulatedAgain) {
    const auto file = RunFile::open_read_only(data.file_of("w"));
    for (const std::uint64_t generation : {2u, 8u, 15u, 40u}) {
        ASSERT_FALSE(*(*file)->beginning_of(generation));
        auto rerun = Rerun::at(**file, generation, executor);
        ASSERT_TRUE(rerun) << to_text(rerun.error());
        EXPECT_EQ(rerun->world().moment().generation, generation);
        EXPECT_EQ(rerun->world().moment().generation_tick, 0u);
        for (int tick = 0; tick < 150; ++tick) {
            rerun->advance_tick(executor);
            ASSERT_EQ(rerun->world().hash(), hashes[rerun->world().moment().tick]);
        }
    }
    const auto forked = fork(**file, 8, data.file_of("fork"), "fork", {}, executor);
    ASSERT_TRUE(forked) << to_text(forked.error());
    const auto other = RunFile::open_read_only(data.file_of("fork"));
    EXPECT_TRUE((*other)->beginning_of(8)->has_value());
}

TEST_F(ThinningTest, ALinkThatIsMissingWithoutHavingBeenTakenOutIsNamed) {
    {
        Database database{data.file_of("w"), Database::Mode::Write};
        database.run(
            "DELETE FROM state_hash WHERE tick = (SELECT tick FROM state_hash ORDER BY tick LIMIT 1 OFFSET 3)");
    }
    const auto file = RunFile::open_read_only(data.file_of("w"));
    EXPECT_EQ((*file)->check().error().code, base::RefusalCode::DataLoss);
}

} // namespace
} // namespace evod::storage
