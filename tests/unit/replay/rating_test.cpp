// Runs in which clients rated the organisms: recovery, verification, forks, missing numbers.
#include "server/simulation/rating.h"

#include "server/replay/recovery.h"
#include "server/replay/rerun.h"
#include "server/replay/run_file_fork.h"
#include "tests/unit/replay/stored_run_fixture.h"

#include <gmock/gmock.h>

namespace evod::replay {
namespace {

using namespace run_file;
using namespace recording;

using testing::Contains;
using testing::HasSubstr;

enum class Rated { Bodies, BodyGenes, FreeGenes };
void PrintTo(Rated rated, std::ostream* out) {
    *out << (rated == Rated::Bodies ? "bodies" : rated == Rated::BodyGenes ? "genes of bodies" : "free genes alone");
}

class StoredRatingTest : public StoredRuns, public testing::WithParamInterface<Rated> {
  protected:
    bool has_bodies() const { return GetParam() == Rated::Bodies; }
    /// A run of a world with two islands of twelve organisms.
    std::unique_ptr<RecordedRun> begin() {
        auto run = std::make_unique<RecordedRun>(data, *thread);
        run->command(set_parameter("fitness", std::string{"external"}));
        run->command(set_parameter("external_bodies", has_bodies()));
        if (GetParam() == Rated::FreeGenes) {
            run->command(set_parameter("free_genes", 2u));
        }
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
};

TEST_P(StoredRatingTest, AKilledRunContinuesWithTheNumbers) {
    for (int stage = 0; stage <= 4; ++stage) {
        begin_again();
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
        const auto file = file_left();
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
        begin_again();
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
        const auto file = file_left("fork");
        const auto recovered = recover(*file, three_threads);
        ASSERT_TRUE(recovered) << to_text(recovered.error());
        EXPECT_EQ(recovered->world.hash(), hash) << numbers;
        EXPECT_EQ(recovered->world.awaits_fitness(), numbers < 12 || !has_bodies());
        expect_agrees(*file);
    }
}

TEST_P(StoredRatingTest, TablesContainTheNumbers) {
    const auto run = begin();
    rate_generations(*run, 2);
    const auto file = file_left();
    // 12 is the greatest number that rate() sends.
    EXPECT_THAT(lines_of(*file, {.table = RunTable::Organisms}), Contains(HasSubstr(",12,")));
    EXPECT_THAT(lines_of(*file, {.table = RunTable::Events}), Contains(HasSubstr(",set_fitness,")));
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
    const auto file = file_left();
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

INSTANTIATE_TEST_SUITE_P(Bodies, StoredRatingTest, testing::Values(Rated::Bodies, Rated::BodyGenes, Rated::FreeGenes));

} // namespace
} // namespace evod::replay
