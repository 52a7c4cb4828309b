#include "server/simulation/behaviour.h"

#include "server/base/inline_executor.h"
#include "tests/support/chi_square.h"
#include "tests/unit/simulation/meadow.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace evod::simulation {
namespace {

using physics::Coordinate;
using physics::to_units;

using support::alpha;

/// One organism next to at most one food item and one poison item. The items are at random places, so the organism is
/// moved next to them.
class OneOrganism : public testing::Test {
  protected:
    Items item_at_most_one(bool there, base::Purpose purpose) {
        Items items;
        items.begin_generation({.placement = purpose,
                                .respawn_purpose = purpose,
                                .kind = 2,
                                .count = there ? 1u : 0u,
                                .radius_px = 4,
                                .respawn = true,
                                .respawn_ticks = 1},
                               base::Seed{1}, 0, 1, {to_units(100.0), to_units(100.0)}, {}, executor);
        return items;
    }
    void SetUp() override {
        food = item_at_most_one(true, base::Purpose::FoodPlacement);
        poison = item_at_most_one(true, base::Purpose::PoisonPlacement);
        none = item_at_most_one(false, base::Purpose::FoodPlacement);
        evolution::BodyGenes genes;
        genes << 50, 1e6f, 100, 100, 500, 500; // sees the whole island and always flees
        bodies.add({.id = 0, .x = to_units(50.0), .y = to_units(50.0), .radius = 10, .mass = 1});
        living.resize(1);
        living.put(0, genes, parameters::Parameters{});
        rules = {.flee_rule = parameters::FleeRule::Nearer,
                 .lookahead_s = 0.3f,
                 .certain_impulse = 200,
                 .force_per_unit = 2};
    }
    void put_beside(const Items& items, double dx, double dy) { // item − organism
        bodies.x[0] = items.all()[0].x - to_units(dx);
        bodies.y[0] = items.all()[0].y - to_units(dy);
    }
    struct Force {
        float x, y;
    };
    Force choose(const Items& foods, const Items& poisons, std::uint32_t tick = 1) {
        look_and_choose(foods, poisons, tick);
        return {forces.x[0], forces.y[0]};
    }
    void look_and_choose(const Items& foods, const Items& poisons, std::uint32_t tick) {
        const base::Range all{0, bodies.size()};
        perception.begin(bodies, living, foods, poisons);
        perception.search(bodies, living, foods, poisons, all);
        live_and_choose(organism_columns(bodies, living, perception, foods, poisons), rules, key, tick, all, forces);
    }
    float dx_to(const Items& items) const { return physics::distance_px(bodies.x[0], items.all()[0].x); }
    float dy_to(const Items& items) const { return physics::distance_px(bodies.y[0], items.all()[0].y); }
    void expect_along(Force force, float x, float y, float size) {
        const float length = std::sqrt(x * x + y * y);
        EXPECT_NEAR(force.x, x / length * size, size * 1e-5f);
        EXPECT_NEAR(force.y, y / length * size, size * 1e-5f);
    }

    Items food, poison, none;
    LivingOrganisms living;
    physics::Circles bodies;
    BehaviourRules rules{};
    ChosenForces forces;
    Perception perception;
    base::RandomKey key{base::Seed{2}, base::Purpose::Behaviour, 0, 1};
    base::InlineExecutor executor;
};

TEST_F(OneOrganism, SteersToFoodCorrectedForItsVelocity) {
    bodies.velocity_x[0] = 40;
    bodies.velocity_y[0] = -70;
    living.impulse[0] = 90;
    put_beside(food, 20, 10);
    expect_along(choose(food, none), 20 - 40 * 0.3f, 10 + 70 * 0.3f, 180);
    rules.lookahead_s = 0;
    expect_along(choose(food, none), 20, 10, 180);
}

TEST_F(OneOrganism, SeesUpToExactlyItsRadius) {
    living.impulse[0] = 90;
    put_beside(food, 3, 4);
    rules.lookahead_s = 0;
    living.food_radius[0] = 5;
    expect_along(choose(food, none), 3, 4, 180);
    living.food_radius[0] = 4.999f;
    const Force wandering = choose(food, none);
    EXPECT_NEAR(std::hypot(wandering.x, wandering.y), 100, 1e-3) << "normal_speed times force_per_unit";

    living.poison_radius[0] = 5;
    living.impulse[0] = 200;
    put_beside(poison, 3, 4);
    expect_along(choose(none, poison), -3, -4, 400);
    living.poison_radius[0] = 4.999f;
    const Force again = choose(none, poison);
    EXPECT_NEAR(std::hypot(again.x, again.y), 100, 1e-3);
}

TEST_F(OneOrganism, FleesPoisonNearerThanTheNearestFood) {
    rules.lookahead_s = 0;
    put_beside(poison, 1, 2);
    ASSERT_GT(std::hypot(dx_to(food), dy_to(food)), 3);
    living.impulse[0] = 200;
    expect_along(choose(food, poison), -1, -2, 400);
}

TEST_F(OneOrganism, SeeksFoodNearerThanPoisonUnlessItAlwaysFlees) {
    rules.lookahead_s = 0;
    put_beside(food, 1, 2);
    ASSERT_GT(std::hypot(dx_to(poison), dy_to(poison)), 3);
    living.impulse[0] = 200;
    expect_along(choose(food, poison), 1, 2, 400);
    rules.flee_rule = parameters::FleeRule::Always;
    expect_along(choose(food, poison), -dx_to(poison), -dy_to(poison), 400);
    living.poison_radius[0] = 0; // not seen
    expect_along(choose(food, poison), 1, 2, 400);
}

TEST_F(OneOrganism, SeeksFoodAsFarAwayAsPoison) {
    // A poison item at the place of the food: the distances are equal to the last bit.
    const Items twin = item_at_most_one(true, base::Purpose::FoodPlacement);
    rules.lookahead_s = 0;
    living.impulse[0] = 200;
    put_beside(food, 7, -3);
    expect_along(choose(food, twin), 7, -3, 400);
    rules.flee_rule = parameters::FleeRule::Always;
    expect_along(choose(food, twin), -7, 3, 400);
}

TEST_F(OneOrganism, FleesWithChanceProportionalToImpulse) {
    // Binomial counts, as a chi-square test with two cells.
    put_beside(poison, 5, 0);
    rules.lookahead_s = 0;
    for (const float impulse : {0.0f, 20.0f, 100.0f, 190.0f, 200.0f, 250.0f}) {
        living.impulse[0] = impulse;
        constexpr std::uint32_t trials = 20'000;
        std::array<std::uint64_t, 2> counts{};
        for (std::uint32_t tick = 1; tick <= trials; ++tick) {
            const Force force = choose(none, poison, tick);
            ++counts[force.x == -2 * impulse && force.y == 0 && impulse > 0 ? 0 : 1];
        }
        const double chance = std::min(1.0, static_cast<double>(impulse) / 200);
        if (chance == 0 || chance == 1) {
            EXPECT_EQ(counts[0], chance == 0 ? 0u : trials);
            continue;
        }
        const std::array<double, 2> expected{chance * trials, (1 - chance) * trials};
        EXPECT_GT(support::p_value(support::chi_square(counts, expected), 1), alpha) << "impulse " << impulse;
    }
}

TEST_F(OneOrganism, SteersToSeenFoodIfItDoesNotFlee) {
    living.impulse[0] = 0.001f; // almost never flees
    rules.lookahead_s = 0;
    rules.flee_rule = parameters::FleeRule::Always;
    put_beside(food, 6, 8);
    expect_along(choose(food, poison), 6, 8, 0.002f);
}

TEST_F(OneOrganism, WandersInANewUniformDirectionEachTick) {
    // Pearson chi-square over 36 equal sectors.
    std::array<std::uint64_t, 36> sectors{};
    for (std::uint32_t tick = 1; tick <= 36'000; ++tick) {
        const Force force = choose(none, none, tick);
        ASSERT_NEAR(std::hypot(force.x, force.y), 100, 1e-3);
        const double turn =
            std::atan2(static_cast<double>(force.y), static_cast<double>(force.x)) / (2 * 3.14159265358979) + 0.5;
        ++sectors[static_cast<std::size_t>(std::min(turn * 36, 35.0))];
    }
    EXPECT_GT(support::p_value_of_equal_cells(sectors), alpha);
}

TEST_F(OneOrganism, ReplacesADirectionWithoutLengthByARandomOne) {
    living.impulse[0] = 200;
    std::array<std::uint64_t, 4> quarters{};
    const auto count = [&](Force force) {
        ASSERT_NEAR(std::hypot(force.x, force.y), 400, 1e-2);
        ++quarters[(force.x > 0 ? 1u : 0u) + (force.y > 0 ? 2u : 0u)];
    };
    put_beside(poison, 0, 0); // on the poison
    for (std::uint32_t tick = 1; tick <= 2000; ++tick) {
        count(choose(none, poison, tick));
    }
    EXPECT_GT(support::p_value_of_equal_cells(quarters), alpha);
    quarters = {};
    put_beside(food, 3, -6); // the velocity leads exactly there
    rules.lookahead_s = 0.5f;
    bodies.velocity_x[0] = 6;
    bodies.velocity_y[0] = -12;
    for (std::uint32_t tick = 1; tick <= 2000; ++tick) {
        count(choose(food, none, tick));
    }
    EXPECT_GT(support::p_value_of_equal_cells(quarters), alpha);
}

TEST_F(OneOrganism, DrawsDependOnItsIdNotOnItsPlaceInMemory) {
    for (std::uint32_t id = 1; id < 40; ++id) {
        evolution::BodyGenes genes;
        genes << 50, 100, 100, 100, 0, 0;
        bodies.add({.id = id, .x = to_units(50.0), .y = to_units(50.0), .radius = 10, .mass = 1});
        living.resize(id + 1);
        living.put(id, genes, parameters::Parameters{});
    }
    choose(none, none, 9);
    const ChosenForces before = forces;
    std::vector<std::uint32_t> order;
    base::Column<std::uint32_t> spare;
    for (std::uint32_t i = 40; i-- > 0;) {
        if (i != 0 && i != 7 && i != 20) {
            order.push_back(i);
        }
    }
    const physics::Reordering reordering{order, spare, executor};
    bodies.reorder(reordering);
    living.reorder(reordering);
    ASSERT_EQ(bodies.size(), 37u);
    choose(none, none, 9);
    for (std::size_t i = 1; i < bodies.size(); ++i) {
        EXPECT_EQ(forces.x[i], before.x[bodies.id[i]]);
    }
}

TEST_F(OneOrganism, DoesWhatIsPredicted) {
    living.impulse[0] = 200;
    const auto expect = [&](const Items& foods, const Items& poisons, Choice choice, const Items* target) {
        const Coordinate x = bodies.x[0], y = bodies.y[0];
        const float health = living.health[0];
        const std::uint32_t asked[] = {0};
        Intention predicted[1];
        predict_intentions(bodies, living, foods, poisons, nullptr, rules, key, 5, asked, predicted);
        EXPECT_EQ(living.health[0], health);
        const Force done = choose(foods, poisons, 5);
        EXPECT_EQ(predicted->choice, choice);
        EXPECT_EQ(predicted->force_x, done.x);
        EXPECT_EQ(predicted->force_y, done.y);
        EXPECT_EQ(predicted->target_x, target ? target->all()[0].x : x);
        EXPECT_EQ(predicted->target_y, target ? target->all()[0].y : y);
    };
    put_beside(food, 20, 10);
    expect(food, none, Choice::Seek, &food);
    put_beside(poison, 3, -8);
    expect(none, poison, Choice::Flee, &poison);
    expect(food, poison, Choice::Flee, &poison);
    expect(none, none, Choice::Wander, nullptr);
    put_beside(food, 0, 0); // steered to, although the direction has no length
    expect(food, none, Choice::Seek, &food);
    living.impulse[0] = 0; // never flees
    put_beside(poison, 3, -8);
    expect(none, poison, Choice::Wander, nullptr);
}

TEST(Foreseeing, EqualsWhatACrowdThenDoesBitForBit) {
    Meadow meadow;
    meadow.area = {to_units(1600.0), to_units(1200.0)};
    base::RandomStream random{base::RandomKey{base::Seed{3}, base::Purpose::ScenarioTest, 0, 0}, 0};
    const auto place = [&] { return Place{to_units(random.uniform(20, 1580)), to_units(random.uniform(20, 1180))}; };
    for (int i = 0; i < 700; ++i) {
        const Place at = place();
        evolution::BodyGenes genes;
        for (auto& gene : genes) {
            gene = static_cast<float>(random.uniform(60, 120));
        }
        meadow.add_organism(at.x, at.y, genes);
    }
    std::vector<Place> foods(200), poisons(200);
    std::ranges::generate(foods, place);
    std::ranges::generate(poisons, place);
    meadow.put_items(foods, poisons, 4, true);
    meadow.begin();
    meadow.bodies.remove(5); // dead organisms are not asked for
    meadow.perception.remove(5);

    std::vector<std::uint32_t> asked; // more than a block of bodies, from the last to the first
    for (std::uint32_t i = 700; i-- > 0;) {
        if (i != 5) {
            asked.push_back(i);
        }
    }
    std::array<int, 4> counts{};
    for (int tick = 0; tick < 40; ++tick) {
        meadow.perceive();
        std::vector<Intention> predicted(asked.size());
        predict_intentions(meadow.bodies, meadow.living, meadow.food, meadow.poison, nullptr, meadow.rules, meadow.key,
                           meadow.tick, asked, predicted);
        std::vector<float> x(meadow.bodies.x.size()), y(x);
        for (std::size_t block = 0; block < physics::block_count(700); ++block) {
            ChosenForces forces;
            const base::Range range = physics::circles_of_block(700, block);
            auto copy = meadow.living; // loses its health instead of the original
            live_and_choose(organism_columns(meadow.bodies, copy, meadow.perception, meadow.food, meadow.poison),
                            meadow.rules, meadow.key, meadow.tick, range, forces);
            for (std::size_t i = range.begin; i < range.end; ++i) {
                x[i] = forces.x[i - range.begin];
                y[i] = forces.y[i - range.begin];
            }
        }
        for (std::size_t k = 0; k < asked.size(); ++k) {
            ASSERT_EQ(predicted[k].force_x, x[asked[k]]) << "body " << asked[k] << " in tick " << meadow.tick;
            ASSERT_EQ(predicted[k].force_y, y[asked[k]]) << "body " << asked[k] << " in tick " << meadow.tick;
            ++counts[static_cast<std::size_t>(predicted[k].choice)];
        }
        meadow.act();
        meadow.eat();
    }
    EXPECT_EQ(counts[0], 0);
    for (const int choice : {1, 2, 3}) {
        EXPECT_GT(counts[static_cast<std::size_t>(choice)], 100) << "choice " << choice;
    }
}

} // namespace
} // namespace evod::simulation
