// Meals: what organisms eat in a tick, and which of them die.
#include "tests/unit/simulation/small_island.h"

#include <utility>

namespace evod::simulation {
namespace {

TEST_F(SmallIsland, CountsPoisonAsTheCauseOnlyInTheTickOfDeath) {
    parameters.poison_count = 2000; // everywhere
    parameters.respawn = false;
    parameters.poison_harm = 1e4;
    begin({chromosome_of(0, 0, 100, 100, 0, 0)});
    tick();
    EXPECT_EQ(island.alive_count(), 0u);
    EXPECT_EQ(island.life_records().cause[0], CauseOfDeath::Poisoned);
    EXPECT_EQ(island.life_records().lived_ticks[0], 1u);
    EXPECT_GT(island.life_records().poison_eaten[0], 0u);
    EXPECT_EQ(island.counts().poisoned_count, 1u);
    EXPECT_EQ(island.counts().poison_eaten, island.life_records().poison_eaten[0]);
}

TEST_F(SmallIsland, CountsStarvingLongAfterPoison) {
    parameters.poison_count = 300;
    parameters.respawn = false;
    parameters.poison_harm = 0.01;
    begin({chromosome_of(0, 0, 100, 5, 0, 0)});
    while (island.alive_count() > 0) {
        tick();
    }
    EXPECT_GT(island.life_records().poison_eaten[0], 0u);
    EXPECT_EQ(island.life_records().cause[0], CauseOfDeath::Starved);
}

TEST_F(SmallIsland, LivesIfFoodRaisesHealthAboveZeroInTime) {
    parameters.food_count = 3000;
    parameters.health_cap_per_size = 0;
    begin({chromosome_of(0, 0, 100, 0.05f, 0, 0)}); // less than the loss of a tick
    tick();
    ASSERT_EQ(island.alive_count(), 1u);
    const std::uint32_t meals = island.life_records().food_eaten[0];
    EXPECT_GT(meals, 1u);
    EXPECT_NEAR(health(0), 0.05f - 0.1f + 25 * static_cast<float>(meals), 1e-3);
}

TEST_F(SmallIsland, DiesIfHealthIsNotAboveZeroAfterATick) {
    parameters.food_count = parameters.poison_count = 3000;
    parameters.food_health = 0.05; // the same amount of poison: the sum stays below
    parameters.poison_harm = 10;
    begin({chromosome_of(0, 0, 100, 20, 0, 0)});
    tick();
    EXPECT_EQ(island.alive_count(), 0u);
    EXPECT_GT(island.life_records().food_eaten[0], 0u);
}

TEST_F(SmallIsland, LimitsHealthToTheCapOnlyAtMeals) {
    parameters.health_cap_per_size = 3;
    begin({chromosome_of(0, 0, 40, 190, 0, 0)});
    tick();
    EXPECT_FLOAT_EQ(health(0), 189.9f) << "not at birth";
    parameters.food_count = 3000;
    now = 0;
    begin({chromosome_of(0, 0, 40, 190, 0, 0)});
    tick();
    EXPECT_FLOAT_EQ(health(0), 120);
}

TEST_F(SmallIsland, HashCoversEatenItemsThatHaveAWeight) {
    parameters.island_width_px = parameters.island_height_px = 600;
    parameters.food_count = parameters.poison_count = 40;
    const auto play = [&](double per_food, double per_poison) {
        parameters.fitness_per_food = per_food;
        parameters.fitness_per_poison = per_poison;
        now = 0;
        begin(hungry());
        while (island.counts().food_eaten < 3 || island.counts().poison_eaten < 3) {
            tick();
        }
        base::StateHash of_eaten;
        for (std::uint32_t id = 0; id < 30; ++id) {
            const std::uint32_t food = per_food != 0 ? island.life_records().food_eaten[id] : 0;
            const std::uint32_t poison = per_poison != 0 ? island.life_records().poison_eaten[id] : 0;
            if (food + poison > 0) {
                of_eaten += base::EntityHash{6, id}.add(food, poison).finish();
            }
        }
        base::StateHash rest = island.hash();
        rest -= of_eaten;
        return std::pair{rest, of_eaten};
    };
    const auto [plain, nothing] = play(0, 0);
    EXPECT_EQ(nothing, base::StateHash{});
    for (const auto& [food, poison] : {std::pair{1.0, 0.0}, {0.0, -1.0}, {2.0, -3.0}}) {
        const auto [rest, of_eaten] = play(food, poison);
        EXPECT_EQ(rest, plain) << "the weights change nothing else in a generation";
        EXPECT_NE(of_eaten, base::StateHash{});
    }
}

} // namespace
} // namespace evod::simulation
