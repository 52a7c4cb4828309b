#include "server/simulation/share.h"

#include <gtest/gtest.h>

namespace evod::simulation {
namespace {

TEST(Shares, DivideAllIslandsIntoNearlyEqualRanges) {
    for (std::size_t islands = 1; islands <= 40; ++islands) {
        for (std::uint32_t size = 1; size <= islands; ++size) {
            std::size_t next = 0;
            for (std::uint32_t rank = 0; rank < size; ++rank) {
                const base::Range share = share_of(islands, rank, size);
                ASSERT_EQ(share.begin, next);
                ASSERT_GE(share.end - share.begin, islands / size);
                ASSERT_LE(share.end - share.begin, islands / size + 1);
                for (; next < share.end; ++next) {
                    ASSERT_EQ(rank_of(islands, next, size), rank);
                }
            }
            ASSERT_EQ(next, islands);
        }
    }
}

TEST(Packing, KeepsStatisticsWithAndWithoutAnAccount) {
    GenerationStatistics statistics{.generation = 7, .island = 3, .fitness_best = -0.5, .best_organism = 9};
    statistics.genes = {{.mean = 1, .deviation = 2, .min = 3, .max = 4},
                        {.mean = 5, .deviation = 6, .min = 7, .max = 8}};
    for (const bool with_account : {false, true}) {
        if (with_account) {
            statistics.account = {{.selection = 1, .transmission = 2, .migration = 3, .change = 6}};
        }
        base::Packer packer;
        pack(packer, statistics);
        pack(packer, statistics);
        const std::string bytes = packer.take();
        base::Unpacker unpacker{bytes};
        (void)unpack_statistics(unpacker);
        const GenerationStatistics again = unpack_statistics(unpacker);
        EXPECT_TRUE(unpacker.empty());
        EXPECT_EQ(again.generation, 7U);
        EXPECT_EQ(again.island, 3U);
        EXPECT_EQ(again.fitness_best, -0.5);
        EXPECT_EQ(again.best_organism, 9U);
        ASSERT_EQ(again.genes.size(), 2U);
        EXPECT_EQ(again.genes[1].max, 8);
        EXPECT_EQ(again.account, statistics.account);
    }
}

TEST(Packing, KeepsTheOrganismsOfAGeneration) {
    evolution::NextGeneration generation;
    generation.genes = evolution::GeneMatrix::Random(6, 40);
    for (std::uint32_t i = 0; i < 40; ++i) {
        generation.parents.push_back({i, 39 - i});
    }
    generation.elite_count = 2;
    generation.survivor_count = 5;
    generation.clamped_count = 11;
    base::Packer packer;
    pack(packer, generation);
    const std::string bytes = packer.take();
    base::Unpacker unpacker{bytes};
    const evolution::NextGeneration again = unpack_generation(unpacker);
    EXPECT_TRUE(unpacker.empty());
    EXPECT_TRUE((again.genes == generation.genes).all());
    EXPECT_EQ(again.parents, generation.parents);
    EXPECT_EQ(again.elite_count, 2U);
    EXPECT_EQ(again.survivor_count, 5U);
    EXPECT_EQ(again.clamped_count, 11U);
    EXPECT_EQ(again.account, std::nullopt);
}

} // namespace
} // namespace evod::simulation
