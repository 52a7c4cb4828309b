#include "server/replay/generation_reader.h"
#include "server/replay/lineage.h"
#include "server/replay/mismatch.h"
#include "server/replay/recovery.h"
#include "server/replay/rerun.h"
#include "server/replay/run_file_fork.h"
#include "server/run_file/check.h"
#include "tests/support/waiting.h"
#include "tests/unit/recording/recorded_run.h"

#include <gmock/gmock.h>

#include <chrono>

namespace evod::run_file {
namespace {

using namespace recording;
using namespace replay;

constexpr std::int64_t bytes_max = 360 << 10;

/// A hundred generations in a file with room for some thirty whole ones.
class RetentionTest : public testing::Test {
  protected:
    RetentionTest() : data{*DataFolder::open(folder.path())} {
        StorageThread thread{{.durability = Durability::Relaxed, .vfs = nullptr, .file_bytes_max = bytes_max}};
        RecordedRun run{data, thread};
        hashes.push_back(run.world().hash());
        for (int tick = 1; tick <= 12'050; ++tick) {
            if (tick % 1000 == 70) {
                run.command(set_parameter("mutation_chance", 0.1 + tick * 1e-5));
                // Many commits, so that the retention is reduced several times.
                EXPECT_TRUE(wait_until([&] { return thread.idle(); }));
            }
            run.advance(1);
            hashes.push_back(run.world().hash());
            if (run.world().moment().generation_tick == 1) {
                begun.push_back(beginning_of(run.world()));
            }
            if (run.world().generation_over()) {
                ended.push_back(end_of(run.world()));
            }
        }
        run.recorder().close_all(run.laboratory());
    }

    TemporaryFolder folder;
    DataFolder data;
    base::InlineExecutor executor;
    std::vector<base::StateHash> hashes; // by tick
    std::vector<GenerationBegun> begun;  // from the first
    std::vector<GenerationEnded> ended;
};

TEST_F(RetentionTest, TheFileStaysSmallAndTheRunComplete) {
    EXPECT_LT(std::filesystem::file_size(data.file_of("w")), 2 * bytes_max);
    const auto file = RunFile::open_read_only(data.file_of("w"));
    ASSERT_TRUE(file) << to_text(file.error());
    const auto checked = check(**file);
    ASSERT_TRUE(checked) << to_text(checked.error());
    EXPECT_EQ((*file)->generations().last(), 101u);
    EXPECT_EQ((*file)->journal().read()->size(), 12u);
    EXPECT_EQ((*file)->generations().history(1000, 1000)->size(), 100u);

    std::vector<std::uint64_t> held;
    for (std::uint64_t generation = 1; generation <= 101; ++generation) {
        if (*(*file)->generations().beginning_of(generation)) {
            held.push_back(generation);
        } else {
            EXPECT_FALSE(*(*file)->generations().outcome_of(generation)) << generation;
        }
    }
    EXPECT_LT(held.size(), 60u);
    EXPECT_EQ(held.front(), 1u);
    EXPECT_EQ(held.back(), 101u);
    // Evenly: every second or fourth or … of the older ones, and all of the newest.
    const std::uint64_t step = held[1] - held[0];
    EXPECT_GE(step, 2u);
    EXPECT_EQ(held[2] - held[1], step);
    EXPECT_EQ(held[held.size() - 2], 100u);

    auto recovered = recover(**file, executor);
    ASSERT_TRUE(recovered) << to_text(recovered.error());
    EXPECT_EQ(recovered->world.hash(), hashes.back());
}

TEST_F(RetentionTest, PurgedGenerationsAreSimulatedAgain) {
    const auto file = RunFile::open_read_only(data.file_of("w"));
    for (const std::uint64_t generation : {2u, 8u, 15u, 40u}) {
        ASSERT_FALSE(*(*file)->generations().beginning_of(generation));
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
    EXPECT_TRUE((*other)->generations().beginning_of(8)->has_value());
}

TEST_F(RetentionTest, EveryGenerationIsReadWhole) {
    const auto file = RunFile::open_read_only(data.file_of("w"));
    ASSERT_TRUE((*file)->pin_snapshot());
    GenerationReader reader{**file, executor};
    const auto read = [&](std::uint64_t generation) {
        SCOPED_TRACE(generation);
        const auto whole = reader.read(generation);
        ASSERT_TRUE(whole) << to_text(whole.error());
        EXPECT_FALSE(compare(begun[generation - 1].opening, whole->begun.opening));
        EXPECT_FALSE(compare(begun[generation - 1].born, whole->begun.born));
        ASSERT_EQ(whole->ended.has_value(), generation <= ended.size());
        if (whole->ended) {
            EXPECT_FALSE(compare(ended[generation - 1].outcomes, whole->ended->outcomes));
            EXPECT_FALSE(compare(ended[generation - 1].statistics, whole->ended->statistics));
        }
    };
    for (std::uint64_t generation = 1; generation <= begun.size(); ++generation) {
        read(generation);
    }
    for (const std::uint64_t generation : {40u, 8u, 15u, 15u}) {
        read(generation);
    }
}

TEST_F(RetentionTest, LineageIsCompleteForwardsAndBackwards) {
    const auto file = RunFile::open_read_only(data.file_of("w"));
    ASSERT_TRUE((*file)->pin_snapshot());
    std::vector<std::vector<Family>> generations;
    const auto forwards = each_generation(**file, executor, {}, [&](std::uint64_t generation, const auto& families) {
        generations.push_back(families);
        return generation == generations.size();
    });
    ASSERT_TRUE(forwards) << to_text(forwards.error());
    ASSERT_EQ(generations.size(), begun.size());
    std::uint64_t expected = 90, strangers = 0;
    const auto back = each_generation_back_from(
        **file, expected, executor, {}, [&](std::uint64_t generation, const std::vector<Family>& families) {
            EXPECT_EQ(generation, expected--);
            for (std::uint32_t island = 0; island < families.size(); ++island) {
                const Family &there = families[island], &same = generations[generation - 1][island];
                EXPECT_EQ(there.parents, same.parents);
                EXPECT_EQ(there.child_count, same.child_count);
                EXPECT_EQ(there.kept_count, same.kept_count);
                EXPECT_EQ(there.fitness, ended[generation - 1].outcomes[island].fitness);
                for (std::size_t organism = 0; organism < there.parents.size(); ++organism) {
                    const auto [first, second] = there.parents[organism];
                    strangers += first.island != island;
                    // A survivor has the genes of its parent, whatever island the parent lived on.
                    if (organism < there.origins.prey.survivors) {
                        EXPECT_TRUE(
                            (begun[generation - 1].born[island].genes.col(static_cast<Eigen::Index>(organism)) ==
                             begun[generation - 2].born[first.island].genes.col(first.organism))
                                .all());
                    }
                }
            }
            return true;
        });
    ASSERT_TRUE(back) << to_text(back.error());
    EXPECT_EQ(expected, 0u);
    EXPECT_GT(strangers, 0u);
}

TEST_F(RetentionTest, AMissingHashThatIsRetainedIsReported) {
    {
        Database database{data.file_of("w"), Database::Mode::Write};
        database.run(
            "DELETE FROM state_hash WHERE tick = (SELECT tick FROM state_hash ORDER BY tick LIMIT 1 OFFSET 3)");
    }
    const auto file = RunFile::open_read_only(data.file_of("w"));
    EXPECT_EQ(check(**file).error().code, base::RefusalCode::DataLoss);
}

TEST(Retention, PurgesInSmallSteps) {
    const TemporaryFolder folder;
    DataFolder data = *DataFolder::open(folder.path());
    base::InlineExecutor executor;
    std::vector<base::StateHash> hashes; // by tick
    {
        StorageThread thread{{.durability = Durability::Relaxed}};
        RecordedRun run{data, thread};
        for (int tick = 0; tick < 4900; ++tick) {
            hashes.push_back(run.world().hash());
            run.advance(1);
        }
        hashes.push_back(run.world().hash());
        run.recorder().close_all(run.laboratory());
    }
    const std::string path = data.file_of("w");
    const auto held_in = [](RunFile& file) {
        std::vector<std::uint64_t> generations;
        for (std::uint64_t generation = 1; generation <= 41; ++generation) {
            if (*file.generations().beginning_of(generation)) {
                generations.push_back(generation);
            }
        }
        return generations;
    };
    const auto rows = [&](const char* of) {
        return Database{path, Database::Mode::Read}.number((std::string{"SELECT count(DISTINCT "} + of).c_str());
    };
    const auto generations = [&] { return rows("generation) FROM population"); };
    const auto expect_whole = [&](RunFile& file) {
        const auto checked = check(file);
        EXPECT_TRUE(checked) << to_text(checked.error());
        const auto recovered = recover(file, executor);
        ASSERT_TRUE(recovered) << to_text(recovered.error());
        EXPECT_GE(recovered->world.moment().tick, 4860u) << "its last hash";
        EXPECT_EQ(recovered->world.hash(), hashes[recovered->world.moment().tick]);
        for (const HashRecord& link : *file.hashes(0, 4900)) {
            EXPECT_EQ(link.hash, hashes[link.tick]);
        }
    };
    const std::vector<std::uint64_t> halved = [] {
        std::vector<std::uint64_t> odd; // counted from the first; and the last two, which are never purged
        for (std::uint64_t generation = 1; generation <= 39; generation += 2) {
            odd.push_back(generation);
        }
        odd.insert(odd.end(), {40, 41});
        return odd;
    }();
    {
        const auto file = RunFile::open(path, {.file_bytes_max = 1000});
        ASSERT_TRUE(file) << to_text(file.error());
        ASSERT_TRUE((*file)->is_large());
        ASSERT_TRUE((*file)->shrink_if_large());
        EXPECT_EQ(held_in(**file), halved);
        EXPECT_EQ(generations(), 41) << "nothing is taken out yet";
        EXPECT_FALSE((*file)->is_large()) << "as far as is known before it is";
        ASSERT_TRUE((*file)->shrink_if_large());
        EXPECT_EQ(held_in(**file), halved);
        expect_whole(**file);
        EXPECT_TRUE(*(*file)->purge_step()); // finds that there are no orphaned parts
        EXPECT_TRUE(*(*file)->purge_step());
        EXPECT_LT(generations(), 41);
        EXPECT_GE(generations(), std::ssize(halved));
        expect_whole(**file);
    }
    // After the file is opened again, the purge is completed.
    const auto file = RunFile::open(path, {});
    EXPECT_FALSE(*(*file)->purge_step()) << "a file that is only opened stays as it is";
    (*file)->begin();
    ASSERT_TRUE((*file)->commit());
    int times = 0;
    while (*(*file)->purge_step()) {
        ASSERT_LT(++times, 1000);
    }
    EXPECT_EQ(generations(), std::ssize(halved));
    EXPECT_EQ(rows("tick) FROM state_hash"), std::ssize(*(*file)->hashes(0, 4900)));
    EXPECT_LT(rows("tick) FROM state_hash"), 60);
    EXPECT_EQ(held_in(**file), halved);
    expect_whole(**file);
}

} // namespace
} // namespace evod::run_file
