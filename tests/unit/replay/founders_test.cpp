// Founders in run files: recovered, forked and replayed worlds have the founders of the original.
#include "server/replay/lineage.h"
#include "server/replay/recovery.h"
#include "server/replay/rerun.h"
#include "server/run_file/check.h"
#include "tests/unit/recording/recorded_run.h"

#include <gmock/gmock.h>

#include <algorithm>

namespace evod::replay {
namespace {

using namespace run_file;
using namespace recording;

using testing::HasSubstr;

class FoundersTest : public testing::Test {
  protected:
    /// Six generations and a half on two islands with migrants between them; every other pair is crossed.
    void record(std::uint64_t keep_every, bool shuffled = false) {
        StorageThread thread{{.keep_every = keep_every}};
        RecordedRun run{data, thread};
        run.command(set_parameter("shuffle_fitness", shuffled));
        run.command(set_parameter("crossover_chance", 0.5));
        for (int tick = 0; tick < 780; ++tick) {
            run.advance(1);
            founders.resize(run.world().moment().generation);
            founders.back() = run.world().bred().founders;
        }
        run.recorder().close_all(run.laboratory());
    }
    std::string path() const { return data.file_of("w"); }

    TemporaryFolder folder;
    DataFolder data = *DataFolder::open(folder.path());
    base::InlineExecutor executor;
    std::vector<simulation::Founders> founders; // of each generation, before migration
};

/// Lineage finds migrants by the fitness with which they were chosen.
TEST_F(FoundersTest, FoundersFollowTheFirstParents) {
    for (const bool shuffled : {false, true}) {
        folder.clear();
        founders.clear();
        record(1, shuffled);
        const auto file = RunFile::open_read_only(path());
        simulation::Founders led_to;
        const auto followed =
            each_generation(**file, executor, {}, [&](std::uint64_t generation, const auto& families) {
                simulation::Founders next(families.size());
                for (std::uint32_t i = 0; i < families.size(); ++i) {
                    for (std::uint32_t organism = 0; organism < families[i].origins.organism_count(); ++organism) {
                        const bool initial = families[i].origins.initial;
                        next[i].push_back(
                            initial ? i * static_cast<std::uint32_t>(families[i].origins.organism_count()) + organism
                                    : led_to[families[i].parents[organism][0].island]
                                            [families[i].parents[organism][0].organism]);
                    }
                }
                led_to = std::move(next);
                EXPECT_EQ(led_to, founders[generation - 1]) << "generation " << generation << ", shuffled " << shuffled;
                return true;
            });
        EXPECT_TRUE(followed);
    }
}

TEST_F(FoundersTest, LineageFromAGenerationOnIsTheSame) {
    record(1);
    const auto file = RunFile::open_read_only(path());
    std::vector<std::vector<Family>> all, late;
    ASSERT_TRUE(each_generation(**file, executor, {}, [&](std::uint64_t, const auto& families) {
        all.push_back(families);
        return true;
    }));
    ASSERT_TRUE(each_generation(
        **file, executor, {},
        [&](std::uint64_t, const auto& families) {
            late.push_back(families);
            return true;
        },
        4));
    ASSERT_EQ(all.size(), 7u);
    ASSERT_EQ(late.size(), 4u);
    for (std::size_t i = 0; i < late.size(); ++i) {
        for (std::size_t island = 0; island < 2; ++island) {
            EXPECT_EQ(late[i][island].parents, all[i + 3][island].parents) << i;
            EXPECT_EQ(late[i][island].child_count, all[i + 3][island].child_count) << i;
        }
    }
}

TEST_F(FoundersTest, FoundersAreEqualAfterARestartAndInAReplay) {
    for (const std::uint64_t keep_every : {1u, 3u}) {
        record(keep_every);
        ASSERT_EQ(founders.size(), 7u);
        EXPECT_TRUE(std::ranges::any_of(founders, [](const simulation::Founders& islands) {
            return std::ranges::any_of(islands[0], [](std::uint32_t founder) { return founder >= 12; });
        })) << "no organism came from the other island";
        const auto file = RunFile::open_read_only(path());
        const auto checked = check(**file);
        EXPECT_TRUE(checked) << to_text(checked.error());
        EXPECT_EQ(recover(**file, executor)->world.bred().founders, founders.back());
        for (std::uint64_t generation = 1; generation <= 7; ++generation) {
            const auto there = Rerun::at(**file, generation, executor);
            ASSERT_TRUE(there) << to_text(there.error());
            EXPECT_EQ(there->world().bred().founders, founders[generation - 1]) << generation;
        }
        folder.clear();
    }
}

TEST_F(FoundersTest, MissingFoundersAreNamed) {
    record(1);
    change(path(), "DELETE FROM founders WHERE generation = 5 AND island = 1");
    const auto file = RunFile::open_read_only(path());
    EXPECT_THAT(to_text(check(**file).error()), HasSubstr("the founders of generation 5"));
}

} // namespace
} // namespace evod::replay
