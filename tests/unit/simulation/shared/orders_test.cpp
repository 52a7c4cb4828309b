#include "server/simulation/shared/orders.h"

#include <gtest/gtest.h>

#include <string>

namespace evod::simulation::shared {
namespace {

template <class T>
T again(const T& value) {
    return base::unpack<T>(base::pack(value));
}

TEST(Packing, KeepsStatisticsWithAndWithoutAnAccount) {
    GenerationStatistics statistics{.generation = 7, .island = 3, .fitness_best = -0.5, .best_organism = 9};
    statistics.genes = {{.mean = 1, .deviation = 2, .min = 3, .max = 4},
                        {.mean = 5, .deviation = 6, .min = 7, .max = 8}};
    for (const bool with_account : {false, true}) {
        if (with_account) {
            statistics.account = {{.selection = 1, .transmission = 2, .migration = 3, .change = 6}};
        }
        const GenerationStatistics read = again(std::vector{statistics, statistics}).back();
        EXPECT_EQ(read.generation, 7U);
        EXPECT_EQ(read.island, 3U);
        EXPECT_EQ(read.fitness_best, -0.5);
        EXPECT_EQ(read.best_organism, 9U);
        ASSERT_EQ(read.genes.size(), 2U);
        EXPECT_EQ(read.genes[1].max, 8);
        EXPECT_EQ(read.account, statistics.account);
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
    const BredIslands read = again(BredIslands{.islands = {generation}, .founders = {{4, 5}, {}}});
    ASSERT_EQ(read.islands.size(), 1U);
    EXPECT_TRUE((read.islands[0].genes == generation.genes).all());
    EXPECT_EQ(read.islands[0].parents, generation.parents);
    EXPECT_EQ(read.islands[0].elite_count, 2U);
    EXPECT_EQ(read.islands[0].survivor_count, 5U);
    EXPECT_EQ(read.islands[0].clamped_count, 11U);
    EXPECT_EQ(read.islands[0].account, std::nullopt);
    EXPECT_EQ(read.founders, (Founders{{4, 5}, {}}));
}

TEST(Packing, KeepsMigrants) {
    const Migrants migrants{
        .fitness = {1, 2.5}, .founders = {7, no_founder}, .genes = evolution::GeneMatrix::Random(6, 2)};
    const Migrants read = again(migrants);
    EXPECT_EQ(read.fitness, migrants.fitness);
    EXPECT_EQ(read.founders, migrants.founders);
    EXPECT_TRUE((read.genes == migrants.genes).all());
    EXPECT_EQ(again(Migrants{}).genes.size(), 0);
}

TEST(Packing, KeepsOrders) {
    const Message message{.dropped = {3, 9},
                          .world = 12,
                          .order = Place{.command = {.world = "w",
                                                     .island = 3,
                                                     .items = {{ItemKind::Food, 1, 2}, {ItemKind::Poison, 3, 4}},
                                                     .organisms = {{5, 6, {7, 8, 9}}}},
                                         .tick = 17}};
    const Message read = again(message);
    EXPECT_EQ(read.dropped, message.dropped);
    EXPECT_EQ(read.world, 12U);
    const auto& place = std::get<Place>(read.order);
    EXPECT_EQ(place.tick, 17U);
    EXPECT_EQ(place.command.island, 3U);
    ASSERT_EQ(place.command.items.size(), 2U);
    EXPECT_EQ(place.command.items[1].kind, ItemKind::Poison);
    EXPECT_EQ(place.command.items[1].y_px, 4);
    ASSERT_EQ(place.command.organisms.size(), 1U);
    EXPECT_EQ(place.command.organisms[0].x_px, 5);
    EXPECT_EQ(place.command.organisms[0].genes, (std::vector<float>{7, 8, 9}));

    const Message remove{
        .dropped = {},
        .world = 1,
        .order =
            Remove{.command = {.world = "w", .island = 1, .food = {3, 4}, .poison = {5}, .organisms = {6}}, .tick = 2}};
    const RemoveEntities removed = std::get<Remove>(again(remove).order).command;
    EXPECT_EQ(removed.island, 1U);
    EXPECT_EQ(removed.food, (std::vector<std::uint32_t>{3, 4}));
    EXPECT_EQ(removed.poison, (std::vector<std::uint32_t>{5}));
    EXPECT_EQ(removed.organisms, (std::vector<std::uint32_t>{6}));

    EXPECT_TRUE(std::holds_alternative<End>(again(Message{.dropped = {}, .world = 0, .order = End{}}).order));
}

TEST(PackingDeathTest, AssertsThatAnOrderHasItsSize) {
    std::string bytes = base::pack(Message{.dropped = {}, .world = 1, .order = Advance{.ticks = {4, 9}}});
    EXPECT_EQ(std::get<Advance>(base::unpack<Message>(bytes).order).ticks.last, 9U);
    EXPECT_DEATH((void)base::unpack<Message>(bytes.substr(0, bytes.size() - 1)), "");
    EXPECT_DEATH((void)base::unpack<Message>(bytes + '\0'), "");
}

} // namespace
} // namespace evod::simulation::shared
