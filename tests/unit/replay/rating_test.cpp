// Runs in which clients rated the organisms: recovery, verification, forks, missing numbers.
#include "server/simulation/rating.h"

#include "server/replay/fork.h"
#include "server/replay/recovery.h"
#include "server/replay/rerun.h"
#include "server/replay/run_tables.h"
#include "server/replay/verify.h"
#include "tests/support/thread_executor.h"
#include "tests/unit/recording/recorded_run.h"

#include <gmock/gmock.h>

#include <sstream>

namespace evod::replay {
namespace {

using namespace run_file;
using namespace recording;

using testing::HasSubstr;

class StoredRatingTest : public testing::TestWithParam<bool> {
  protected:
    StoredRatingTest() : data{*DataFolder::open(folder.path())} {}

    /// A run of a world with two islands of twelve organisms, with or without bodies.
    std::unique_ptr<RecordedRun> begin() {
        auto run = std::make_unique<RecordedRun>(data, *thread);
        run->command(set_parameter("fitness", std::string{"external"}));
        run->command(set_parameter("external_bodies", GetParam()));
        run->reset(base::Seed{7}, {3, 4});
        return run;
    }
    void advance_to_rating(RecordedRun& run) {
        do {
            run.advance(1);
        } while (!run.world().awaits_fitness());
    }
    void rate(RecordedRun& run, std::uint32_t island, int numbers, int first = 0) {
        v1::Request request;
        v1::SetFitness& set = *request.mutable_set_fitness();
        set.set_world("w");
        set.set_generation(run.world().moment().generation);
        set.set_island(island);
        set.set_first_organism(static_cast<std::uint32_t>(first));
        for (int i = first; i < first + numbers; ++i) {
            set.add_fitness(static_cast<double>((i * 7 + static_cast<int>(set.generation())) % 13));
        }
        run.command(request);
    }
    void rate_generations(RecordedRun& run, int count) {
        for (int generation = 0; generation < count; ++generation) {
            advance_to_rating(run);
            rate(run, 0, 12);
            rate(run, 1, 12);
        }
    }
    std::unique_ptr<RunFile> file_of(const std::string& name) {
        thread.reset();
        auto file = RunFile::open(data.file_of(name), {});
        EXPECT_TRUE(file) << to_text(file.error());
        return *std::move(file);
    }
    void expect_agrees(RunFile& file) {
        const auto verified = verify(file, three_threads, [](const VerifyProgress&) {});
        ASSERT_TRUE(verified) << to_text(verified.error());
        EXPECT_FALSE(verified->difference)
            << verified->difference->part << ": " << verified->difference->stored << " but "
            << verified->difference->simulated << " at tick " << verified->difference->differs.tick;
    }

    TemporaryFolder folder;
    DataFolder data;
    std::unique_ptr<StorageThread> thread = std::make_unique<StorageThread>(RunFile::Options{});
    base::InlineExecutor executor;
    support::ThreadExecutor three_threads{3};
};

TEST_P(StoredRatingTest, AKilledRunContinuesWithTheNumbers) {
    for (int stage = 0; stage <= 4; ++stage) {
        folder.clear();
        thread = std::make_unique<StorageThread>(RunFile::Options{});
        const auto run = begin();
        rate_generations(*run, 3);
        advance_to_rating(*run);
        run->checkpoint(); // while the world waits
        if (stage >= 1) {
            rate(*run, 1, 5);
        }
        if (stage >= 2) {
            rate(*run, 1, 7, 5);
        }
        if (stage >= 3) {
            rate(*run, 0, 12);
        }
        if (stage >= 4) {
            run->advance(1);
        }
        const auto file = file_of("w");
        const auto recovered = recover(*file, three_threads);
        ASSERT_TRUE(recovered) << to_text(recovered.error());
        EXPECT_EQ(recovered->world.hash(), run->world().hash()) << stage;
        EXPECT_EQ(recovered->world.awaits_fitness(), run->world().awaits_fitness()) << stage;
        EXPECT_EQ(recovered->world.generation_over(), run->world().generation_over()) << stage;
        EXPECT_EQ(recovered->world.history().size(), stage < 3 ? 3u : 4u);
        expect_agrees(*file);
    }
}

TEST_P(StoredRatingTest, AForkContinuesWithTheNumbers) {
    for (const int numbers : {0, 5, 12}) {
        folder.clear();
        thread = std::make_unique<StorageThread>(RunFile::Options{});
        base::StateHash hash;
        {
            const auto run = begin();
            rate_generations(*run, 1);
            advance_to_rating(*run);
            rate(*run, 0, 12);
            if (numbers > 0) {
                rate(*run, 1, numbers);
            }
            run->fork({5, 6});
            if (numbers == 12) {
                run->advance(1, "fork");
            }
            run->recorder().close_all(run->laboratory());
            hash = (*run->laboratory().find("fork"))->world.hash();
        }
        const auto file = file_of("fork");
        const auto recovered = recover(*file, three_threads);
        ASSERT_TRUE(recovered) << to_text(recovered.error());
        EXPECT_EQ(recovered->world.hash(), hash) << numbers;
        EXPECT_EQ(recovered->world.awaits_fitness(), numbers < 12 || !GetParam());
        expect_agrees(*file);
    }
}

TEST_P(StoredRatingTest, TablesContainTheNumbers) {
    const auto run = begin();
    rate_generations(*run, 2);
    const auto file = file_of("w");
    std::ostringstream text;
    ASSERT_TRUE(write_table({*file, executor}, {.table = RunTable::Organisms}, text));
    EXPECT_THAT(text.str(), HasSubstr(",12,")); // the greatest number that rate() sends
    std::ostringstream events;
    ASSERT_TRUE(write_table({*file, executor}, {.table = RunTable::Events}, events));
    EXPECT_THAT(events.str(), HasSubstr(",set_fitness,"));
}

TEST_P(StoredRatingTest, AMissingNumberIsReported) {
    {
        const auto run = begin();
        rate_generations(*run, 3);
        run->advance(1);
    }
    thread.reset();
    change(data.file_of("w"),
           "DELETE FROM journal WHERE number > 3"); // the last entries are those of generation 2 and 3
    const auto file = file_of("w");
    const auto verified = verify(*file, three_threads, [](const VerifyProgress&) {});
    ASSERT_TRUE(verified) << to_text(verified.error());
    ASSERT_TRUE(verified->difference);
    EXPECT_EQ(verified->difference->part, "the fitness from clients");
    EXPECT_EQ(verified->difference->differs.generation, 2u);
    auto rerun = Rerun::begun_at(*file, 1, nullptr, *world_changes(*file), 0, executor);
    ASSERT_TRUE(rerun) << to_text(rerun.error());
    rerun->advance_to(1'000, executor);
    ASSERT_TRUE(rerun->changes().fault());
    EXPECT_THAT(rerun->changes().fault()->message, HasSubstr("does not contain the fitness of generation 2"));
}

INSTANTIATE_TEST_SUITE_P(Bodies, StoredRatingTest, testing::Bool());

} // namespace
} // namespace evod::replay
