#include "server/simulation/packed.h"

#include <gtest/gtest.h>

#include <string>

namespace evod::simulation {
namespace {

/// Packs a value, and reads it again with unpack(unpacker). Expects that nothing is left.
template <class Value, class Unpack>
auto again(const Value& value, Unpack&& unpack) {
    base::Packer packer;
    pack(packer, value);
    const std::string bytes = packer.take();
    base::Unpacker unpacker{bytes};
    auto read = unpack(unpacker);
    EXPECT_TRUE(unpacker.empty());
    return read;
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

TEST(Packing, KeepsTheStateOfAnIsland) {
    IslandState state;
    state.fate = {.lived_ticks = {0, 7},
                  .cause = {CauseOfDeath::Alive, CauseOfDeath::Starved},
                  .food_eaten = {1, 2},
                  .poison_eaten = {3, 4}};
    state.counts.food_eaten = 9;
    state.placed = {{.genes = {1, 2, 3}, .tick = 5}, {.genes = {}, .tick = 6}};
    state.placed_food = 2;
    state.placed_poison = 3;
    state.organisms.push_back({.x = 1, .y = 2, .velocity_x = 3, .velocity_y = 4, .health = 5});
    state.headings = {0.5F};
    state.crates = {{.x = 6, .y = 7}};
    state.food.resize(2);
    state.poison.resize(1);
    EXPECT_EQ(again(state, unpack_island_state), state);
    EXPECT_EQ(again(IslandState{}, unpack_island_state), IslandState{});
}

TEST(Packing, KeepsSchedulesAndPlannedChanges) {
    parameters::Schedule schedule;
    schedule.add(1, {"mutation_chance", 0.5});
    schedule.add(3, {"mutation_chance", 0.25});
    schedule.add(3, {"population_size", std::uint32_t{12}});
    EXPECT_EQ(again(schedule, unpack_schedule), schedule);
    EXPECT_EQ(again(parameters::Schedule{}, unpack_schedule), parameters::Schedule{});

    // Every kind of value, and both kinds of moments.
    parameters::PlannedChange change{.id = 4,
                                     .at = {.generation = 8, .tick = {}},
                                     .assignments = {{"respawn", true},
                                                     {"migration", std::string{"ring"}},
                                                     {"population_size", std::uint32_t{12}},
                                                     {"mutation_chance", 0.5}},
                                     .by = "user"};
    EXPECT_EQ(again(change, unpack_planned_change), change);
    change.at = {.generation = {}, .tick = 99};
    EXPECT_EQ(again(change, unpack_planned_change), change);
}

TEST(Packing, KeepsCommands) {
    const PlaceEntities place{.world = "w",
                              .island = 3,
                              .items = {{ItemKind::Food, 1, 2}, {ItemKind::Poison, 3, 4}},
                              .organisms = {{5, 6, {7, 8, 9}}}};
    const PlaceEntities placed = again(place, unpack_place_entities);
    EXPECT_EQ(placed.island, 3U);
    ASSERT_EQ(placed.items.size(), 2U);
    EXPECT_EQ(placed.items[1].kind, ItemKind::Poison);
    EXPECT_EQ(placed.items[1].y_px, 4);
    ASSERT_EQ(placed.organisms.size(), 1U);
    EXPECT_EQ(placed.organisms[0].x_px, 5);
    EXPECT_EQ(placed.organisms[0].genes, (std::vector<float>{7, 8, 9}));

    const RemoveEntities remove{
        .world = "w", .island = 1, .generation = 2, .food = {3, 4}, .poison = {5}, .organisms = {6}};
    const RemoveEntities removed = again(remove, unpack_remove_entities);
    EXPECT_EQ(removed.island, 1U);
    EXPECT_EQ(removed.generation, 2U);
    EXPECT_EQ(removed.food, remove.food);
    EXPECT_EQ(removed.poison, remove.poison);
    EXPECT_EQ(removed.organisms, remove.organisms);

    const SetFitness set{.world = "w", .generation = 5, .island = 4, .first_organism = 3, .fitness = {1.5, -2}};
    const SetFitness given = again(set, unpack_set_fitness);
    EXPECT_EQ(given.generation, 5U);
    EXPECT_EQ(given.island, 4U);
    EXPECT_EQ(given.first_organism, 3U);
    EXPECT_EQ(given.fitness, set.fitness);
}

} // namespace
} // namespace evod::simulation
