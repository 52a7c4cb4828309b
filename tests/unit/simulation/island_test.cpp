#include "server/simulation/island.h"

#include "server/simulation/fitness.h"
#include "tests/unit/simulation/small_island.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <numbers>
#include <vector>

namespace evod::simulation {
namespace {

TEST_F(SmallIsland, LosesHealthAtItsRateUntilItStarves) {
    begin({chromosome_of(0, 0, 50, 20, 0, 0), chromosome_of(0, 0, 50, 30, 0, 0)});
    tick();
    EXPECT_FLOAT_EQ(health(0), 19.9f);
    while (island.alive_count() == 2) {
        tick();
    }
    EXPECT_NEAR(now, 200, 1) << "6 health/s: 20 last 200 ticks, to the rounding of floats";
    const std::uint32_t died = now;
    EXPECT_EQ(island.life_records().cause[0], CauseOfDeath::Starved);
    EXPECT_EQ(island.life_records().lived_ticks[0], died);
    EXPECT_EQ(island.counts().starved_count, 1u);
    EXPECT_FALSE(island.body_of(0).has_value());
    EXPECT_EQ(island.bodies().id[island.body_of(1).value()], 1u);
    while (now < 250) {
        tick();
    }
    EXPECT_NEAR(fitness()[0], died / 60.0, 1e-9) << "the health of the dead is 0, their seconds count";
    EXPECT_NEAR(fitness()[1], 250 / 60.0 + 5, 1e-2);
}

TEST(LossPerTick, IsTheRateTimesTheCostsOfGenes) {
    parameters::Parameters p;
    p.normal_speed_cost = 0.1;
    p.impulse_cost = 0.2;
    p.base_health_cost = 0.5;
    p.food_radius_cost = 0.1;
    p.poison_radius_cost = 0.3;
    const auto loss = [&](const evolution::BodyGenes& genes) {
        LivingOrganisms living;
        living.resize(1);
        living.put(0, genes, p);
        return living.loss_per_tick.front();
    };
    EXPECT_FLOAT_EQ(loss(chromosome_of(100, 100, 100, 100, 100, 100)), 0.1f);
    const double factor =
        1 + 0.1 * (1.2 - 1) + 0.2 * (1.3 * 1.3 - 1) + 0.5 * (0.9 - 1) + 0.1 * (1.4 * 1.4 - 1) + 0.3 * (0.7 * 0.7 - 1);
    EXPECT_FLOAT_EQ(loss(chromosome_of(120, 130, 50, 90, 140, 70)), static_cast<float>(0.1 * factor));
    p.base_health_cost = 10;
    EXPECT_EQ(loss(chromosome_of(20, 20, 100, 20, 20, 20)), 0) << "never a gain";
}

TEST_F(SmallIsland, ItemsReappearAfterRespawnTime) {
    parameters.food_count = 1000;
    for (std::uint32_t ticks = 0; ticks <= 600; ++ticks) {
        parameters.respawn_s = ticks / 60.0;
        now = 0;
        begin({chromosome_of(0, 0, 150, 100, 0, 0)});
        tick();
        ASSERT_GT(island.counts().food_eaten, 0u);
        for (std::uint32_t item = 0; item < island.food().size(); ++item) {
            ASSERT_TRUE(island.food().present(item) || island.food().all()[item].due_tick == 1 + std::max(ticks, 1u))
                << "respawn_s " << parameters.respawn_s;
        }
    }
    parameters.respawn = false;
    now = 0;
    begin({chromosome_of(0, 0, 150, 100, 0, 0)});
    tick();
    const std::uint32_t left = island.food().present_count();
    EXPECT_LT(left, 1000u);
    while (now < 50) {
        tick();
    }
    EXPECT_LE(island.food().present_count(), left);
}

TEST_F(SmallIsland, FitnessIsTheWeightedSum) {
    parameters.island_width_px = parameters.island_height_px = 600;
    parameters.food_count = parameters.poison_count = 40;
    begin(hungry());
    while (island.alive_count() > 20) {
        tick();
    }
    const auto sum = [&](std::uint32_t id, double second, double of_health, double food, double poison) {
        const bool lives = island.body_of(id).has_value();
        const double seconds = (lives ? now : island.life_records().lived_ticks[id]) * parameters.tick_s;
        return second * seconds + of_health * (lives ? static_cast<double>(health(id)) : 0) +
               food * island.life_records().food_eaten[id] + poison * island.life_records().poison_eaten[id];
    };
    const std::vector<double> by_default = fitness();
    parameters.fitness_per_second = 0.5;
    parameters.fitness_per_health = -2;
    parameters.fitness_per_food = 10;
    parameters.fitness_per_poison = -3.25;
    const std::vector<double> weighted = fitness();
    std::uint32_t food = 0, poison = 0;
    for (std::uint32_t id = 0; id < 30; ++id) {
        EXPECT_EQ(by_default[id], sum(id, 1, 1, 0, 0));
        EXPECT_EQ(weighted[id], sum(id, 0.5, -2, 10, -3.25));
        food += island.life_records().food_eaten[id];
        poison += island.life_records().poison_eaten[id];
    }
    EXPECT_GT(food, 0u);
    EXPECT_GT(poison, 0u);
}

TEST_F(SmallIsland, HashCoversEverything) {
    parameters.island_width_px = parameters.island_height_px = 600;
    parameters.food_count = parameters.poison_count = 40;
    parameters.crate_count = 3;
    parameters.obstacle_count = 2;
    parameters.respawn_s = 0.3;
    begin(hungry());
    const auto recomputed = [&] {
        base::StateHash sum;
        for (std::uint32_t id = 0; id < 30; ++id) {
            const auto g = evolution::column(island.born().genes, id);
            sum += base::EntityHash{5, id}.add(g[0], g[1]).add(g[2], g[3]).add(g[4], g[5]).finish();
        }
        for (std::size_t i = island.bodies().size(); i-- > 0;) { // in any order
            if (!island.bodies().is_void(i)) {
                sum += base::hash_of({.kind = 1,
                                      .id = island.bodies().id[i],
                                      .a = static_cast<std::uint32_t>(island.bodies().x[i]),
                                      .b = static_cast<std::uint32_t>(island.bodies().y[i]),
                                      .c = std::bit_cast<std::uint32_t>(island.bodies().velocity_x[i]),
                                      .d = std::bit_cast<std::uint32_t>(island.bodies().velocity_y[i]),
                                      .e = std::bit_cast<std::uint32_t>(island.living().health[i])});
            }
        }
        for (std::uint32_t i = 0; i < island.crate_count(); ++i) {
            sum += base::EntityHash{4, i}
                       .add(island.boxes().x[i], island.boxes().y[i])
                       .add(island.boxes().velocity_x[i], island.boxes().velocity_y[i])
                       .finish();
        }
        const auto add_items = [&](const Items& items, std::uint32_t kind) {
            for (std::uint32_t item = 0; item < items.size(); ++item) {
                base::EntityHash hash{kind, item};
                if (items.present(item)) {
                    hash.add(items.all()[item].x, items.all()[item].y);
                } else {
                    hash.add(std::uint64_t{items.all()[item].due_tick});
                }
                sum += hash.finish();
            }
        };
        add_items(island.food(), 2);
        add_items(island.poison(), 3);
        return sum;
    };
    while (island.alive_count() > 0) { // includes deaths
        tick();
        ASSERT_EQ(island.hash(), recomputed()) << "tick " << now;
    }
    EXPECT_GT(now, 150u);
}

TEST_F(SmallIsland, FindsTheBodyOfEachId) {
    std::vector<evolution::BodyGenes> chromosomes;
    for (int i = 0; i < 8; ++i) {
        chromosomes.push_back(chromosome_of(0, 0, 40, i % 3 == 0 ? 0.05f : 50, 0, 0));
    }
    begin(chromosomes);
    tick();
    EXPECT_EQ(island.alive_count(), 5u);
    for (const std::uint32_t alive : {1u, 2u, 4u, 5u, 7u}) {
        ASSERT_TRUE(island.body_of(alive).has_value());
        EXPECT_EQ(island.bodies().id[*island.body_of(alive)], alive);
        EXPECT_FALSE(island.bodies().is_void(*island.body_of(alive)));
    }
    tick(); // when the places of the dead have been reused
    tick();
    EXPECT_EQ(island.bodies().id[island.body_of(4).value()], 4u);
    for (const std::uint32_t dead : {0u, 3u, 6u, 8u, 1000u}) {
        EXPECT_FALSE(island.body_of(dead).has_value());
    }
}

TEST_F(SmallIsland, OrganismsStartAtRestWithTheSizesOfTheirGenes) {
    begin({chromosome_of(0, 0, 80, 50, 0, 0), chromosome_of(0, 0, 160, 50, 0, 0)});
    ASSERT_EQ(island.bodies().size(), 2u);
    EXPECT_EQ(island.bodies().radius[0], 8);
    EXPECT_EQ(island.bodies().radius[1], 16);
    EXPECT_FLOAT_EQ(island.bodies().inverse_mass[0], 1 / 0.8f);
    EXPECT_FLOAT_EQ(island.bodies().inverse_mass[1], 1 / 1.6f);
    EXPECT_EQ(island.bodies().velocity_x[1], 0);
}

TEST(GeneSum, IsTheSumOfTheGenes) {
    EXPECT_EQ(gene_sum(chromosome_of(1, 2, 3, 4, 5, 6.5f)), 21.5);
}

TEST(Rastrigin, FollowsItsFormulaWithItsMaximumAt150) {
    EXPECT_NEAR(rastrigin(chromosome_of(150, 150, 150, 150, 150, 150)), 0, 1e-12);
    const evolution::BodyGenes genes = chromosome_of(100, 103, 151, 20, 249.5f, 175);
    double sum = 60;
    for (unsigned i = 0; i < 6; ++i) {
        const double x = (static_cast<double>(genes(i)) - 150) / 25;
        sum += x * x - 10 * std::cos(2 * std::numbers::pi * x);
    }
    EXPECT_NEAR(rastrigin(genes), -sum, 1e-9);
    EXPECT_LT(rastrigin(genes), 0);
}

TEST_F(SmallIsland, HasNoBodiesForAChromosomeFitness) {
    parameters.fitness = parameters::FitnessFunction::GeneSum;
    begin({chromosome_of(1, 2, 3, 4, 5, 6), chromosome_of(10, 20, 30, 40, 50, 60)});
    EXPECT_EQ(island.bodies().size(), 0u);
    EXPECT_EQ(fitness(), (std::vector<double>{21, 210}));
}

TEST(HealthCap, IsAboveZero) {
    parameters::Parameters parameters;
    evolution::BodyGenes genes;
    genes.setConstant(1);
    for (const double per_size : {5e-324, 1e-46, 1e-45, 1e-30, 3.0}) {
        parameters.health_cap_per_size = per_size;
        EXPECT_GT(health_cap(genes, parameters), 0) << per_size;
    }
}

} // namespace
} // namespace evod::simulation
