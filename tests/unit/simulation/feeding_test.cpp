#include "server/simulation/feeding.h"

#include "server/base/inline_executor.h"
#include "server/base/random.h"
#include "server/physics/step.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <utility>
#include <vector>

namespace evod::simulation {
namespace {

using physics::to_units;

Items items_of(std::uint32_t count, base::Purpose placement, physics::Area area, float radius = 4) {
    Items items;
    items.begin_generation({.placement = placement,
                            .respawn_purpose = placement,
                            .kind = 2,
                            .count = count,
                            .radius_px = radius,
                            .respawn = true,
                            .respawn_ticks = 1},
                           base::Seed{1}, 0, 1, area, {});
    return items;
}

/// As if nobody knew what had been seen: everyone is looked at.
struct Blind {
    Sight sight;
    std::vector<float> distance;
    explicit Blind(const physics::Circles& bodies) : sight{bodies.x, bodies.y, {}, {}}, distance(bodies.size(), 0) {}
};

std::vector<Meal> meals_of(const physics::Circles& bodies, const Items& items) {
    Feeding feeding;
    base::InlineExecutor executor;
    const Blind blind{bodies};
    return feeding.meals(bodies, items, blind.sight, blind.distance, executor);
}

std::vector<Meal> meals_by_trying_all(const physics::Circles& bodies, const Items& items) {
    std::vector<Meal> meals;
    for (std::uint32_t item = 0; item < items.size(); ++item) {
        if (!items.present(item))
            continue;
        float best = 0;
        std::size_t eater = bodies.size();
        for (std::size_t i = 0; i < bodies.size();
             ++i) { // ids rise with the index, so the first of equals has the lower
            const float dx = physics::distance_px(bodies.x[i], items.x()[item]);
            const float dy = physics::distance_px(bodies.y[i], items.y()[item]);
            const float reach = bodies.radius[i] + items.radius_px(), square = dx * dx + dy * dy;
            if (square <= reach * reach && (eater == bodies.size() || square < best)) {
                best = square;
                eater = i;
            }
        }
        if (eater != bodies.size())
            meals.push_back({item, static_cast<std::uint32_t>(eater)});
    }
    return meals;
}

void expect_equal(const std::vector<Meal>& meals, const std::vector<Meal>& expected, const char* what, int tick) {
    ASSERT_EQ(meals.size(), expected.size()) << what << ", tick " << tick;
    for (std::size_t i = 0; i < meals.size(); ++i) {
        ASSERT_EQ(meals[i].item, expected[i].item) << what << ", tick " << tick;
        ASSERT_EQ(meals[i].body, expected[i].body) << what << ", tick " << tick;
    }
}

TEST(Feeding, GivesAnItemToItsNearestToucherAndOfEquallyNearOnesToTheLowestId) {
    const Items items = items_of(1, base::Purpose::FoodPlacement, {to_units(500.0), to_units(500.0)});
    const auto meal = [&](std::vector<std::pair<double, double>> offsets) {
        physics::Circles bodies;
        std::uint32_t id = 5;
        for (const auto& [dx, dy] : offsets)
            bodies.add(id++, items.x()[0] + to_units(dx), items.y()[0] + to_units(dy), 10, 1);
        return meals_of(bodies, items);
    };
    EXPECT_TRUE(meal({{14.01, 0}}).empty());
    ASSERT_EQ(meal({{14, 0}}).size(), 1u) << "a distance equal to the radii is touching";
    EXPECT_EQ(meal({{8, 0}, {0, 7}, {-9, 0}}).front().body, 1u);
    EXPECT_EQ(meal({{8, 0}, {5, 5}, {-3, 4}, {0, 5}, {4, -3}}).front().body, 2u);
}

TEST(Feeding, LetsOneOrganismEatSeveral) {
    const Items items = items_of(30, base::Purpose::FoodPlacement, {to_units(20.0), to_units(20.0)});
    physics::Circles bodies;
    bodies.add(0, to_units(10.0), to_units(10.0), 15, 1);
    const std::vector<Meal> meals = meals_of(bodies, items);
    ASSERT_EQ(meals.size(), 30u);
    std::set<std::uint32_t> eaten;
    for (const Meal& meal : meals)
        eaten.insert(meal.item);
    EXPECT_EQ(eaten.size(), 30u);
}

struct Speeds {
    float max_speed, force;
    float item_radius;
};
class ARunningIsland : public testing::TestWithParam<Speeds> {};

TEST_P(ARunningIsland, NeverMissesAMealForWhatWasSeen) {
    // Organisms with the longest and the shortest sight, slow and fast; food and poison against trying all, each tick.
    const physics::Area area{to_units(900.0), to_units(700.0)};
    Items food = items_of(150, base::Purpose::FoodPlacement, area, GetParam().item_radius);
    Items poison = items_of(150, base::Purpose::PoisonPlacement, area, GetParam().item_radius);
    base::RandomStream random{base::RandomKey{base::Seed{3}, base::Purpose::ScenarioTest, 0, 0}, 0};
    Living living;
    physics::Circles bodies;
    for (std::uint32_t id = 0; id < 120; ++id) {
        evolution::Chromosome genes;
        const auto gene = [&](double low, double high) { return static_cast<float>(random.uniform(low, high)); };
        genes << gene(20, 250), gene(20, 250), gene(10, 200), 100, gene(0, 200), gene(0, 200);
        living.add(genes, Parameters{});
        const BodyShape shape = body_shape(genes(evolution::BodySize), Parameters{});
        bodies.add(id, to_units(random.uniform(20, 880)), to_units(random.uniform(20, 680)), shape.radius_px,
                   shape.mass_kg);
    }
    physics::Boxes boxes;
    physics::Stepper stepper;
    const physics::StepParameters step{.integration =
                                           physics::integration(physics::Integrator::SymplecticEuler, 1.0 / 60, 0.06),
                                       .restitution = 0.8f,
                                       .max_speed_px_s = GetParam().max_speed};
    const BehaviourRules rules{
        .flee_rule = FleeRule::Nearer, .lookahead_s = 0.3f, .certain_impulse = 200, .force_per_unit = GetParam().force};
    const base::RandomKey key{base::Seed{4}, base::Purpose::Behaviour, 0, 1};
    base::InlineExecutor executor;
    Sight sight;
    Feeding feeding;
    std::size_t eaten = 0;
    for (std::uint32_t tick = 1; tick <= 600; ++tick) {
        food.reappear(tick, boxes);
        poison.reappear(tick, boxes);
        perceive_and_choose(living, food, poison, rules, key, tick, bodies, sight, executor);
        stepper.step(bodies, boxes, area, step, executor);
        const std::vector<Meal> meals = feeding.meals(bodies, food, sight, sight.food_distance, executor);
        expect_equal(meals, meals_by_trying_all(bodies, food), "food", static_cast<int>(tick));
        const std::vector<Meal> poisoned = feeding.meals(bodies, poison, sight, sight.poison_distance, executor);
        expect_equal(poisoned, meals_by_trying_all(bodies, poison), "poison", static_cast<int>(tick));
        if (HasFatalFailure())
            return;
        for (const Meal& meal : meals)
            food.consume(meal.item, tick);
        for (const Meal& meal : poisoned)
            poison.consume(meal.item, tick);
        eaten += meals.size() + poisoned.size();
    }
    EXPECT_GT(eaten, 300u);
}

INSTANTIATE_TEST_SUITE_P(Speeds, ARunningIsland,
                         testing::Values(Speeds{600, 1, 4}, Speeds{100'000, 200, 4}, Speeds{600, 20, 30}));

} // namespace
} // namespace evod::simulation
