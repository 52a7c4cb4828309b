#include "server/simulation/entities.h"

#include "server/base/inline_executor.h"
#include "server/jobs/thread_pool.h"
#include "server/simulation/laboratory.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace evod::simulation {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

evolution::BodyGenes genes_of(float base_health = 100, float body_size = 100) {
    evolution::BodyGenes genes;
    genes << 100, 100, body_size, base_health, 100, 100;
    return genes;
}

std::vector<std::string> fields_of(const base::Refusal& refused) {
    std::vector<std::string> fields;
    for (const base::Violation& violation : refused.violations) {
        fields.push_back(violation.field);
    }
    return fields;
}

/// A world of 800 × 600 px with an organism in the middle, and a laboratory that contains it.
class EntitiesTest : public testing::Test {
  protected:
    EntitiesTest() {
        parameters.island_width_px = 800;
        parameters.island_height_px = 600;
        parameters.population_size = 1;
        parameters.food_count = parameters.poison_count = 0;
        parameters.generation_s = 2;
    }
    void create() {
        ASSERT_TRUE(laboratory.apply(CreateWorld{"w", parameters, base::Seed{3}, {}}));
        ASSERT_TRUE(laboratory.apply(simulation::Run{"w", {}}));
    }
    World& world() { return (*laboratory.find("w"))->world; }
    const Island& island() { return world().island(0); }
    void advance(int ticks) {
        for (int tick = 0; tick < ticks; ++tick) {
            laboratory.advance(**laboratory.find("w"), executor);
        }
    }
    base::Result<Applied> place(std::vector<PlaceEntities::Item> items,
                                std::vector<PlaceEntities::Organism> organisms = {}) {
        return laboratory.apply(PlaceEntities{"w", 0, std::move(items), std::move(organisms)});
    }
    base::Result<Applied> remove(std::vector<std::uint32_t> food, std::vector<std::uint32_t> poison = {},
                                 std::vector<std::uint32_t> organisms = {}) {
        return laboratory.apply(RemoveEntities{"w", 0, {}, std::move(food), std::move(poison), std::move(organisms)});
    }
    /// A place at which an organism with default genes is clear of organism 0.
    Place clear_place(double from_it_px = 60) {
        const auto body = *island().body_of(0);
        const double x = physics::to_px(island().bodies().x[body]);
        return {physics::to_units(x > 400 ? x - from_it_px : x + from_it_px), island().bodies().y[body]};
    }
    static PlaceEntities::Organism organism_at(Place place, const evolution::BodyGenes& genes) {
        return organism_at_px(physics::to_px(place.x), physics::to_px(place.y), genes);
    }
    static PlaceEntities::Organism organism_at_px(double x_px, double y_px, const evolution::BodyGenes& genes) {
        return {x_px, y_px, {genes.begin(), genes.end()}};
    }

    parameters::Parameters parameters;
    Laboratory laboratory;
    base::InlineExecutor executor;
    jobs::ThreadPool three_threads{3};
};

TEST_F(EntitiesTest, PlacedFoodIsEatenAndDoesNotReappear) {
    create();
    const auto body = *island().body_of(0);
    const double x = physics::to_px(island().bodies().x[body]), y = physics::to_px(island().bodies().y[body]);
    const auto placed = place({{ItemKind::Food, x, y}, {ItemKind::Poison, x > 400 ? 20.0 : 780.0, 300}});
    ASSERT_TRUE(placed) << to_text(placed.error());
    EXPECT_EQ(*placed->placed, (EntityIds{.generation = 1, .food = {0}, .poison = {0}}));
    EXPECT_EQ(placed->tick, 0u);
    EXPECT_EQ(island().food().present_count(), 1u);
    advance(1);
    EXPECT_EQ(island().counts().food_eaten, 1u);
    EXPECT_EQ(island().food().all()[0].due_tick, Items::none);
    advance(118);
    EXPECT_EQ(island().food().present_count(), 0u);
    EXPECT_EQ(island().poison().present_count(), 1u);
    advance(2);
    EXPECT_EQ(world().moment().generation, 2u);
    EXPECT_EQ(island().food().size(), 0u);
    EXPECT_EQ(island().poison().size(), 0u);
}

TEST_F(EntitiesTest, ChangeTheStateHashAtOnce) {
    create();
    const base::StateHash empty = world().hash();
    ASSERT_TRUE(place({{ItemKind::Food, 30, 30}}));
    const base::StateHash food = world().hash();
    EXPECT_NE(food, empty);
    ASSERT_TRUE(place({}, {organism_at(clear_place(), genes_of())}));
    const base::StateHash organism = world().hash();
    EXPECT_NE(organism, food);
    ASSERT_TRUE(remove({0}));
    EXPECT_NE(world().hash(), organism);
    EXPECT_NE(world().hash(), empty);
}

TEST_F(EntitiesTest, AnOrganismLivesFromThePlacingOn) {
    parameters.health_loss_per_s = 60; // 1 per tick
    create();
    advance(10);
    const auto placed =
        place({}, {organism_at(clear_place(), genes_of(5)), organism_at_px(10, 590, genes_of(300, 90))});
    ASSERT_FALSE(placed); // base_health_max is 200
    EXPECT_THAT(fields_of(placed.error()),
                ElementsAre("place.organisms[0].base_health", "place.organisms[1].base_health"));
    const auto done = place({}, {organism_at(clear_place(), genes_of(20)), organism_at_px(12, 588, genes_of(200, 90))});
    ASSERT_TRUE(done) << to_text(done.error());
    EXPECT_THAT(done->placed->organisms, ElementsAre(1u, 2u));
    EXPECT_EQ(world().alive_count(), 3u);
    EXPECT_EQ(island().placed_tick(1), 10u);
    EXPECT_EQ(island().live_statistics().organism_count, 3u);
    advance(25);
    EXPECT_EQ(island().life_records().cause[1], CauseOfDeath::Starved);
    EXPECT_NEAR(island().life_records().lived_ticks[1], 20, 1);
    const auto fitness = island().fitness(world().parameters().active, 35, executor);
    EXPECT_DOUBLE_EQ(fitness[1], island().life_records().lived_ticks[1] * parameters.tick_s);
    EXPECT_NEAR(fitness[2], 25 * parameters.tick_s + 175, 1e-3);
}

TEST_F(EntitiesTest, APlacedOrganismBreeds) {
    parameters.selection = evolution::SelectionMethod::Truncation;
    parameters.population_model = evolution::PopulationModel::Generational;
    parameters.elite_count = 1;
    create();
    ASSERT_TRUE(place({}, {organism_at(clear_place(), genes_of(200))}));
    advance(120);
    ASSERT_TRUE(world().generation_over());
    EXPECT_EQ(world().history().back()[0].organism_count, 2u);
    EXPECT_EQ(world().history().back()[0].best_organism, 1u);
    advance(1);
    EXPECT_EQ(island().born().genes.cols(), 1);
    EXPECT_TRUE((island().born().genes.col(0) == genes_of(200)).all()); // the elite
    EXPECT_EQ(island().born().parents[0].first, 1u);
    EXPECT_THAT(world().islands().founders(0), ElementsAre(no_founder));
}

TEST_F(EntitiesTest, ARemovedOrganismIsDead) {
    create();
    ASSERT_TRUE(place({}, {organism_at(clear_place(), genes_of())}));
    advance(30);
    ASSERT_TRUE(remove({}, {}, {0}));
    EXPECT_EQ(island().life_records().cause[0], CauseOfDeath::Removed);
    EXPECT_EQ(island().life_records().lived_ticks[0], 30u);
    EXPECT_EQ(world().alive_count(), 1u);
    advance(90);
    ASSERT_TRUE(world().generation_over());
    const GenerationStatistics& statistics = world().history().back()[0];
    EXPECT_EQ(statistics.alive_count, 1u);
    EXPECT_EQ(statistics.starved_count + statistics.poisoned_count, 0u);
    EXPECT_DOUBLE_EQ(world().outcomes()[0].fitness[0], 30 * parameters.tick_s);
}

TEST_F(EntitiesTest, RemovingTheLastOrganismEndsTheGeneration) {
    create();
    advance(5);
    ASSERT_TRUE(remove({}, {}, {0}));
    EXPECT_FALSE(world().generation_over());
    bool extinct = false;
    for (const Event& event : laboratory.take_events()) {
        extinct |= std::holds_alternative<Extinction>(event.kind);
    }
    EXPECT_TRUE(extinct);
    advance(1);
    EXPECT_TRUE(world().generation_over());
    EXPECT_EQ(world().moment().tick, 6u);
}

TEST_F(EntitiesTest, ARemovedItemDoesNotReappear) {
    parameters.food_count = 30;
    parameters.respawn_s = 0.1;
    create();
    ASSERT_TRUE(remove({3, 7}));
    EXPECT_EQ(island().food().present_count(), 28u);
    for (int tick = 0; tick < 119; ++tick) {
        advance(1);
        ASSERT_FALSE(island().food().present(3));
        ASSERT_FALSE(island().food().present(7));
    }
    const auto again = remove({3, 4, 4, 30});
    ASSERT_FALSE(again);
    EXPECT_THAT(fields_of(again.error()), ElementsAre("remove.food[0]", "remove.food[2]", "remove.food[3]"));
    EXPECT_TRUE(island().food().present(4)) << "nothing was removed";
}

TEST_F(EntitiesTest, EveryWrongFieldIsNamedAndNothingPlaced) {
    parameters.obstacle_count = 1;
    parameters.crate_count = 1;
    create();
    const physics::Boxes& boxes = island().boxes();
    const Place crate{boxes.x[0], boxes.y[0]}, obstacle{boxes.x[1], boxes.y[1]};
    const auto body = *island().body_of(0);
    const Place first{island().bodies().x[body], island().bodies().y[body]};
    const double nan = std::nan("");
    evolution::BodyGenes wild = genes_of();
    wild(evolution::Impulse) = std::nanf("");
    wild(evolution::FoodRadius) = 1e9f;
    const base::StateHash before = world().hash();
    const auto refused = place({{ItemKind::Food, 400, 3.9},
                                {ItemKind::Food, nan, 1e300},
                                {ItemKind::Poison, physics::to_px(crate.x), physics::to_px(crate.y)},
                                {ItemKind::Poison, physics::to_px(obstacle.x), physics::to_px(obstacle.y)},
                                {ItemKind::Food, 4, 596}},
                               {organism_at(first, genes_of()), organism_at_px(300, 9.9, genes_of()),
                                organism_at_px(300, 300, wild), organism_at(crate, genes_of())});
    ASSERT_FALSE(refused);
    EXPECT_THAT(fields_of(refused.error()),
                ElementsAre("place.items[0].y_px", "place.items[1].x_px", "place.items[1].y_px", "place.items[2]",
                            "place.items[3]", "place.organisms[1].y_px", "place.organisms[2].impulse",
                            "place.organisms[2].food_radius", "place.organisms[3]", "place.organisms[0]"));
    EXPECT_EQ(refused.error().violations[0].allowed, "4 to 596");
    EXPECT_EQ(refused.error().violations[0].got, "3.9");
    EXPECT_THAT(refused.error().violations.back().allowed, HasSubstr("organism 0 is there"));
    EXPECT_EQ(world().hash(), before);
    EXPECT_EQ(island().food().size(), 0u);
    EXPECT_EQ(world().alive_count(), 1u);
}

TEST_F(EntitiesTest, OrganismsOfACommandMayNotOverlap) {
    create();
    const Place there = clear_place();
    const auto refused = place({}, {organism_at(there, genes_of()), organism_at(there, genes_of())});
    ASSERT_FALSE(refused);
    EXPECT_THAT(fields_of(refused.error()), ElementsAre("place.organisms[1]"));
    EXPECT_THAT(refused.error().violations[0].allowed, HasSubstr("place.organisms[0]"));
}

TEST_F(EntitiesTest, AreRefusedWhereTheyCannotBe) {
    create();
    const auto elsewhere = laboratory.apply(PlaceEntities{"w", 1, {{ItemKind::Food, 30, 30}}, {}});
    ASSERT_FALSE(elsewhere);
    EXPECT_EQ(elsewhere.error().reason, base::Reason::IslandNotFound);
    const auto later = laboratory.apply(RemoveEntities{.world = "w", .generation = 2, .organisms = {0}});
    ASSERT_FALSE(later);
    EXPECT_EQ(later.error().reason, base::Reason::GenerationChanged);
    advance(120);
    ASSERT_TRUE(world().generation_over());
    EXPECT_EQ(place({{ItemKind::Food, 30, 30}}).error().reason, base::Reason::GenerationOver);
    EXPECT_EQ(remove({}, {}, {0}).error().reason, base::Reason::GenerationOver);
    parameters.fitness = parameters::FitnessFunction::GeneSum;
    ASSERT_TRUE(laboratory.apply(CreateWorld{"genes", parameters, base::Seed{3}, {}}));
    const auto bodiless = laboratory.apply(PlaceEntities{"genes", 0, {{ItemKind::Food, 30, 30}}, {}});
    ASSERT_FALSE(bodiless);
    EXPECT_EQ(bodiless.error().reason, base::Reason::NoBodies);
}

TEST_F(EntitiesTest, ReplaysAreNotChanged) {
    create();
    (*laboratory.find("w"))->replay = Replay{};
    EXPECT_EQ(place({{ItemKind::Food, 30, 30}}).error().reason, base::Reason::WorldIsReplay);
    EXPECT_EQ(remove({}, {}, {0}).error().reason, base::Reason::WorldIsReplay);
}

TEST_F(EntitiesTest, AreBoundedInAGeneration) {
    create();
    std::vector<PlaceEntities::Item> items(place_entries_max, {ItemKind::Food, 30, 30});
    for (std::size_t placed = 0; placed < placed_max; placed += items.size()) {
        ASSERT_TRUE(place(items));
    }
    EXPECT_EQ(place({{ItemKind::Food, 30, 30}}).error().reason, base::Reason::PlacedMax);
    EXPECT_TRUE(place({{ItemKind::Poison, 30, 30}}));
    advance(121);
    EXPECT_TRUE(place({{ItemKind::Food, 30, 30}}));
}

TEST_F(EntitiesTest, ADeadIslandLivesAgain) {
    parameters.island_count = 2;
    parameters.food_count = 5;
    create();
    const auto remove_first = [&] { return remove({}, {}, {0}); };
    ASSERT_TRUE(remove_first());
    advance(10);
    EXPECT_EQ(island().alive_count(), 0u);
    ASSERT_TRUE(place({}, {organism_at_px(400, 300, genes_of())}));
    const WorldState state = world().state(executor);
    World restored = world().at_its_opening(executor);
    const auto done = restored.restore(state, three_threads);
    ASSERT_TRUE(done) << to_text(done.error());
    advance(10);
    EXPECT_EQ(island().alive_count(), 1u);
    EXPECT_NEAR(island().living().health[*island().body_of(1)], 99, 0.1);
}

/// Places and removes random entities; returns how many commands were accepted.
int change_randomly(Laboratory& laboratory, std::mt19937& random) {
    const World& world = (*laboratory.find("w"))->world;
    const auto island = static_cast<std::uint32_t>(random() % world.islands().size());
    const auto x = [&] { return 20 + static_cast<double>(random() % 760'000) / 1000; };
    const auto y = [&] { return 20 + static_cast<double>(random() % 560'000) / 1000; };
    PlaceEntities place{.world = "w", .island = island};
    for (auto left = random() % 20; left > 0; --left) {
        place.items.push_back({random() % 2 == 0 ? ItemKind::Food : ItemKind::Poison, x(), y()});
    }
    const evolution::BodyGenes genes = genes_of(100 + static_cast<float>(random() % 50));
    place.organisms.push_back({x(), y(), {genes.begin(), genes.end()}});
    const Island& there = world.islands()[island];
    RemoveEntities remove{.world = "w", .island = island};
    const auto organism = static_cast<std::uint32_t>(random() % there.life_records().cause.size());
    if (there.body_of(organism)) {
        remove.organisms.push_back(organism);
    }
    if (const auto food = static_cast<std::uint32_t>(random() % there.food().size()); there.food().present(food)) {
        remove.food.push_back(food);
    }
    return laboratory.apply(place).has_value() + laboratory.apply(remove).has_value();
}

TEST_F(EntitiesTest, AnIslandEmptiedBeforeItsFirstTickIsRestored) {
    parameters.population_size = 3;
    parameters.island_count = 2;
    create();
    ASSERT_TRUE(laboratory.apply(RemoveEntities{"w", 1, {}, {}, {}, {0, 1, 2}}));
    for (const int ticks : {0, 1, 1, 60}) {
        advance(ticks);
        World restored = world().at_its_opening(executor);
        ASSERT_TRUE(restored.restore(world().state(executor), executor));
        EXPECT_EQ(restored.hash(), world().hash()) << "at tick " << world().moment().tick;
    }
}

TEST_F(EntitiesTest, AWorldIsRestoredWithThemBitForBit) {
    parameters.population_size = 30;
    parameters.food_count = parameters.poison_count = 60;
    parameters.island_count = 2;
    parameters.crate_count = 3;
    parameters.migration = evolution::Topology::Ring;
    parameters.migration_epoch = 1;
    parameters.respawn_s = 0.5;
    create();
    std::mt19937 random{5};
    int accepted = 0;
    for (int round = 0; round < 60; ++round) {
        accepted += change_randomly(laboratory, random);
        const WorldState state = world().state(three_threads);
        World restored = world().at_its_opening(executor);
        EXPECT_EQ(restored.is_as_begun(), true);
        const auto done = restored.restore(state, three_threads);
        ASSERT_TRUE(done) << to_text(done.error()) << " in round " << round;
        ASSERT_EQ(restored.hash(), world().hash()) << round;
        EXPECT_EQ(restored.state(executor).islands, state.islands);
        const int ticks = static_cast<int>(random() % 25);
        for (int tick = 0; tick < ticks; ++tick) {
            advance(1);
            restored.advance_tick(three_threads);
            ASSERT_EQ(restored.hash(), world().hash()) << "round " << round << ", tick " << tick;
            ASSERT_EQ(restored.bred().founders, world().bred().founders);
        }
    }
    EXPECT_GT(accepted, 60);
    EXPECT_GT(world().moment().generation, 3u);
}

} // namespace
} // namespace evod::simulation
