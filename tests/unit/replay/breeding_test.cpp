#include "server/replay/breeding.h"

#include "server/evolution/fitness_shuffle.h"
#include "tests/unit/recording/recorded_run.h"

#include <algorithm>

namespace evod::replay {
namespace {

using namespace run_file;
using namespace recording;

/// 4.5 generations, with changes of parameters in the middle of the second, in a file that retains all of them or only
/// each fourth.
class BreedingTest : public testing::TestWithParam<std::uint64_t> {
  protected:
    BreedingTest() : data{*DataFolder::open(folder.path())} {
        record();
        opened = *RunFile::open_read_only(data.file_of("w"));
    }

    void record() {
        StorageThread thread{{.durability = Durability::Relaxed, .vfs = nullptr, .keep_every = GetParam()}};
        RecordedRun run{data, thread};
        for (int tick = 0; tick < 540; ++tick) {
            if (run.world().moment().generation_tick == 1) {
                begun.push_back(beginning_of(run.world()));
            }
            run.advance(1);
            if (run.world().generation_over()) {
                ended.push_back(end_of(run.world()));
            }
            if (tick == 170) {
                run.command(set_parameter("mutation_chance", 0.5));
                run.command(set_parameter("population_size", 17u));
            }
        }
        run.recorder().close_all(run.laboratory());
    }

    base::Result<Bred> breeding(std::optional<std::uint64_t> generation, std::uint32_t island = 0,
                                const base::StopCheck& stop = {}) {
        return breeding_of(*opened,
                           {.generation = generation, .seen_from = 5, .island = island, .rows = {.count_max = ~0u}},
                           executor, stop);
    }

    TemporaryFolder folder;
    DataFolder data;
    base::InlineExecutor executor;
    std::vector<GenerationBegun> begun; // from the first
    std::vector<GenerationEnded> ended;
    std::unique_ptr<RunFile> opened;
};

TEST_P(BreedingTest, ReportsDescendantsAndParameters) {
    ASSERT_EQ(begun.size(), 5u);
    for (std::uint64_t generation = 1; generation <= 4; ++generation) {
        for (std::uint32_t island = 0; island < 2; ++island) {
            const auto bred = breeding(generation, island);
            ASSERT_TRUE(bred) << to_text(bred.error());
            EXPECT_EQ(bred->generation, generation);
            EXPECT_EQ(bred->parameters.mutation_chance, generation < 2 ? 0.15 : 0.5);
            const evolution::NextGeneration& born = begun[generation].born[island];
            ASSERT_EQ(bred->record.descendants.size(), generation < 2 ? 12u : 17u);
            ASSERT_EQ(bred->record.descendants.size(), born.parents.size());
            for (const auto& descendant : bred->record.descendants) {
                EXPECT_EQ(descendant.parents, born.parents[descendant.id]);
                EXPECT_TRUE(std::ranges::equal(descendant.genes, evolution::column(born.genes, descendant.id)));
            }
            // After every second generation, the best of the other island replace the worst of this one.
            std::vector<evolution::Migrant> migrants;
            for (const auto& contender : bred->record.contenders) {
                if (contender.migrant) {
                    migrants.push_back(*contender.migrant);
                }
            }
            ASSERT_EQ(migrants.size(), generation % 2 == 0 ? 1u : 0u);
            for (const evolution::Migrant& migrant : migrants) {
                EXPECT_EQ(migrant.from, 1 - island);
                EXPECT_EQ(bred->record.contenders[migrant.replaces].migrant, migrant);
                EXPECT_EQ(bred->record.contenders[migrant.replaces].fitness,
                          ended[generation - 1].outcomes[migrant.from].fitness[migrant.organism]);
            }
        }
    }
}

TEST_P(BreedingTest, WithoutAGenerationTheLastThatBredIsShown) {
    EXPECT_EQ(breeding({})->generation, 4u);
    for (const auto& [seen_from, expected] : {std::pair{1u, 1u}, {2u, 1u}, {4u, 3u}, {99u, 4u}}) {
        EXPECT_EQ(
            breeding_of(*opened, {.generation = {}, .seen_from = seen_from, .island = 0, .rows = {}}, executor, {})
                ->generation,
            expected);
    }
}

TEST_P(BreedingTest, AMissingGenerationOrIslandIsRefused) {
    for (const std::uint64_t generation : {std::uint64_t{0}, std::uint64_t{5}, ~std::uint64_t{0}}) {
        const auto refused = breeding(generation);
        ASSERT_FALSE(refused);
        EXPECT_EQ(refused.error().code, base::RefusalCode::NotFound);
        EXPECT_EQ(refused.error().violations.at(0).field, "generation");
        EXPECT_EQ(refused.error().violations.at(0).allowed, "1 to 4");
    }
    const auto refused = breeding(1, 2);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().violations.at(0).field, "island");
    EXPECT_EQ(refused.error().violations.at(0).allowed, "0 to 1");
}

INSTANTIATE_TEST_SUITE_P(Storage, BreedingTest, testing::Values(1, 4));

using WhollyRetained = BreedingTest;

TEST_P(WhollyRetained, ChangedDescendantsAreReported) {
    opened.reset();
    auto file = *RunFile::open(data.file_of("w"), {});
    GenerationBegun other = begun[2];
    other.born[1].genes(3, 11) += 1;
    file->begin();
    file->write(other);
    ASSERT_TRUE(file->commit());
    file.reset();
    opened = *RunFile::open_read_only(data.file_of("w"));
    EXPECT_TRUE(breeding(2, 0));
    const auto refused = breeding(2, 1);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, base::RefusalCode::DataLoss);
    EXPECT_NE(refused.error().message.find("generation 2 bred descendants that differ"), std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(Storage, WhollyRetained, testing::Values(1));

using RetainedInPart = BreedingTest;

TEST_P(RetainedInPart, ACancelledRequestStopsTheSimulation) {
    const auto refused = breeding(2, 0, base::StopCheck{[] { return true; }});
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, base::RefusalCode::Unavailable);
}

INSTANTIATE_TEST_SUITE_P(Storage, RetainedInPart, testing::Values(4));

TEST(Breeding, ShuffledAndOwnFitnessAreBothReported) {
    for (const std::uint64_t keep_every : {1, 4}) {
        TemporaryFolder folder;
        DataFolder data{*DataFolder::open(folder.path())};
        std::vector<GenerationEnded> ended;
        {
            StorageThread thread{{.durability = Durability::Relaxed, .vfs = nullptr, .keep_every = keep_every}};
            RecordedRun run{data, thread};
            run.command(set_parameter("shuffle_fitness", true));
            run.command(set_parameter("elite_count", 2u));
            for (int tick = 0; tick < 540; ++tick) {
                run.advance(1);
                if (run.world().generation_over()) {
                    ended.push_back(end_of(run.world()));
                }
            }
            run.recorder().close_all(run.laboratory());
        }
        const auto file = *RunFile::open_read_only(data.file_of("w"));
        base::InlineExecutor executor;
        std::size_t migrants = 0, others = 0;
        for (std::uint64_t generation = 1; generation <= 4; ++generation) {
            for (std::uint32_t island = 0; island < 2; ++island) {
                // Refused if the descendants differ from the stored ones.
                const auto bred = breeding_of(
                    *file, {.generation = generation, .seen_from = 5, .island = island, .rows = {.count_max = ~0u}},
                    executor, {});
                ASSERT_TRUE(bred) << to_text(bred.error());
                const std::vector<std::vector<double>> own{ended[generation - 1].outcomes[0].fitness,
                                                           ended[generation - 1].outcomes[1].fitness};
                std::vector<std::vector<double>> dealt = own;
                for (std::uint32_t i = 0; i < 2; ++i) {
                    evolution::shuffle_fitness(dealt[i], {.seed = base::Seed{7}, .island = i, .generation = generation},
                                               executor);
                }
                for (std::uint32_t id = 0; id < 12; ++id) {
                    const auto& contender = bred->record.contenders[id];
                    const std::uint32_t from = contender.migrant ? contender.migrant->from : island;
                    const std::uint32_t organism = contender.migrant ? contender.migrant->organism : id;
                    EXPECT_EQ(contender.own_fitness, own[from][organism]);
                    EXPECT_EQ(contender.fitness, dealt[from][organism]);
                    migrants += contender.migrant.has_value();
                    others += contender.fitness != *contender.own_fitness;
                }
                // Rows from the middle are those of these organisms.
                const auto some = breeding_of(*file,
                                              {.generation = generation,
                                               .seen_from = 5,
                                               .island = island,
                                               .rows = {.first_contender = 5, .count_max = 3}},
                                              executor, {});
                ASSERT_TRUE(some);
                ASSERT_EQ(some->record.contenders.size(), 3u);
                for (std::size_t i = 0; i < 3; ++i) {
                    EXPECT_EQ(some->record.contenders[i].own_fitness, bred->record.contenders[5 + i].own_fitness);
                }
            }
        }
        EXPECT_GT(migrants, 0u);
        EXPECT_GT(others, 50u); // of 96
    }
}

TEST(Breeding, ARunInItsFirstGenerationHasNotBred) {
    TemporaryFolder folder;
    DataFolder data{*DataFolder::open(folder.path())};
    {
        StorageThread thread{{.durability = Durability::Relaxed, .vfs = nullptr}};
        RecordedRun run{data, thread};
        run.advance(119);
        run.recorder().close_all(run.laboratory());
    }
    const auto file = *RunFile::open_read_only(data.file_of("w"));
    base::InlineExecutor executor;
    for (const std::optional<std::uint64_t> generation : {std::optional<std::uint64_t>{}, {1}}) {
        const auto refused =
            breeding_of(*file, {.generation = generation, .seen_from = 1, .island = 0, .rows = {}}, executor, {});
        ASSERT_FALSE(refused);
        EXPECT_EQ(refused.error().code, base::RefusalCode::FailedPrecondition);
    }
}

} // namespace
} // namespace evod::replay
