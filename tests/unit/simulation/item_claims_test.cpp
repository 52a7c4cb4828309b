#include "tests/unit/simulation/meadow.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <ostream>
#include <set>
#include <utility>
#include <vector>

namespace evod::simulation {
namespace {

using physics::to_units;

Items items_of(std::uint32_t count, base::Purpose placement, physics::Area area, float radius = 4) {
    Items items;
    base::InlineExecutor executor;
    items.begin_generation({.placement = placement,
                            .respawn_purpose = placement,
                            .kind = 2,
                            .count = count,
                            .radius_px = radius,
                            .respawn = true,
                            .respawn_ticks = 1},
                           base::Seed{1}, 0, 1, area, {}, executor);
    return items;
}

/// As if every body might touch an item.
using Meal = Meadow::Meal;

std::vector<Meal> awarded(ItemClaims& claims) {
    const std::size_t count = claims.award();
    std::vector<Meal> meals;
    for (const Touch& touch : claims.touches(0)) {
        if (touch.gets_it) {
            meals.push_back({touch.item, touch.body});
        }
    }
    EXPECT_EQ(meals.size(), count);
    return meals;
}

std::vector<Meal> meals_of(const physics::Circles& bodies, const Items& items) {
    std::vector<std::uint32_t> all(bodies.size());
    std::iota(all.begin(), all.end(), 0u);
    ItemClaims claims;
    claims.begin(1);
    claims.find_touches(0, all, bodies, items);
    return awarded(claims);
}

std::vector<Meal> meals_by_trying_all(const physics::Circles& bodies, const Items& items) {
    std::vector<Meal> meals;
    for (std::uint32_t item = 0; item < items.size(); ++item) {
        if (!items.present(item)) {
            continue;
        }
        float best = 0;
        std::size_t eater = bodies.size();
        for (std::size_t i = 0; i < bodies.size();
             ++i) { // ids increase with the index, so the first of equals has the lower id
            const float dx = physics::distance_px(bodies.x[i], items.all()[item].x);
            const float dy = physics::distance_px(bodies.y[i], items.all()[item].y);
            const float reach = bodies.radius[i] + items.radius_px(), square = dx * dx + dy * dy;
            if (square <= reach * reach && (eater == bodies.size() || square < best)) {
                best = square;
                eater = i;
            }
        }
        if (eater != bodies.size()) {
            meals.push_back({item, static_cast<std::uint32_t>(eater)});
        }
    }
    return meals;
}

void expect_equal(std::vector<Meal> meals, const std::vector<Meal>& expected, const char* what, int tick) {
    ASSERT_EQ(meals.size(), expected.size()) << what << ", tick " << tick;
    std::sort(meals.begin(), meals.end(), [](const Meal& a, const Meal& b) { return a.item < b.item; });
    for (std::size_t i = 0; i < meals.size(); ++i) {
        ASSERT_EQ(meals[i].item, expected[i].item) << what << ", tick " << tick;
        ASSERT_EQ(meals[i].body, expected[i].body) << what << ", tick " << tick;
    }
}

TEST(ItemClaims, GivesAnItemToTheNearestBodyThenTheLowestId) {
    const Items items = items_of(1, base::Purpose::FoodPlacement, {to_units(500.0), to_units(500.0)});
    const auto meal = [&](std::vector<std::pair<double, double>> offsets) {
        physics::Circles bodies;
        std::uint32_t id = 5;
        for (const auto& [dx, dy] : offsets) {
            bodies.add({.id = id++,
                        .x = items.all()[0].x + to_units(dx),
                        .y = items.all()[0].y + to_units(dy),
                        .radius = 10,
                        .mass = 1});
        }
        return meals_of(bodies, items);
    };
    EXPECT_TRUE(meal({{14.01, 0}}).empty());
    ASSERT_EQ(meal({{14, 0}}).size(), 1u) << "a distance equal to the radii is touching";
    EXPECT_EQ(meal({{8, 0}, {0, 7}, {-9, 0}}).front().body, 1u);
    EXPECT_EQ(meal({{8, 0}, {5, 5}, {-3, 4}, {0, 5}, {4, -3}}).front().body, 2u);
}

TEST(ItemClaims, LetsOneOrganismEatSeveralItems) {
    const Items items = items_of(30, base::Purpose::FoodPlacement, {to_units(20.0), to_units(20.0)});
    physics::Circles bodies;
    bodies.add({.id = 0, .x = to_units(10.0), .y = to_units(10.0), .radius = 15, .mass = 1});
    const std::vector<Meal> meals = meals_of(bodies, items);
    ASSERT_EQ(meals.size(), 30u);
    std::set<std::uint32_t> eaten;
    for (const Meal& meal : meals) {
        eaten.insert(meal.item);
    }
    EXPECT_EQ(eaten.size(), 30u);
}

/// Compares the nearest item that each body stores with a test of all items: the same within its radius, and no other
/// item is nearer than the stored bound.
void expect_nearest_are_known(const ViewColumns& view, const physics::Circles& bodies, const Items& items,
                              std::uint32_t tick) {
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        const auto square_to = [&](physics::Coordinate x, physics::Coordinate y) {
            const float dx = physics::distance_px(bodies.x[i], x), dy = physics::distance_px(bodies.y[i], y);
            return dx * dx + dy * dy;
        };
        const float known = square_to(view.x[i], view.y[i]);
        float least = std::numeric_limits<float>::infinity();
        std::uint32_t nearest = Items::none;
        for (std::uint32_t item = 0; item < items.size(); ++item) {
            if (items.present(item) && square_to(items.all()[item].x, items.all()[item].y) < least) {
                least = square_to(items.all()[item].x, items.all()[item].y);
                nearest = item;
            }
        }
        if (least > view.radius[i] * view.radius[i]) {
            ASSERT_GT(known, view.radius[i] * view.radius[i])
                << "perceives a missing item: body " << i << ", tick " << tick;
            continue;
        }
        ASSERT_EQ(view.x[i], items.all()[nearest].x) << "body " << i << ", tick " << tick;
        ASSERT_EQ(view.y[i], items.all()[nearest].y) << "body " << i << ", tick " << tick;
        for (std::uint32_t item = 0; item < items.size(); ++item) {
            if (items.present(item) && item != nearest && view.others[i] > 0) {
                ASSERT_GE(square_to(items.all()[item].x, items.all()[item].y), view.others[i] * view.others[i])
                    << "body " << i << ", tick " << tick;
            }
        }
    }
}

struct Conditions {
    const char* name;
    double width, height; // px
    std::uint32_t organisms, foods, poisons;
    double sight;           // px; greatest
    double crowd_side;      // px; side of the square in which the organisms start
    float max_speed, force; // px/s; kg px/s² a gene unit
    float item_radius;      // px
};
void PrintTo(const Conditions& conditions, std::ostream* out) {
    *out << conditions.name;
}

class AMeadow : public testing::TestWithParam<Conditions> {};

TEST_P(AMeadow, PerceivesAndFeedsLikeATestOfAllItems) {
    const Conditions& c = GetParam();
    Meadow meadow;
    meadow.area = {to_units(c.width), to_units(c.height)};
    meadow.step.max_speed_px_s = c.max_speed;
    meadow.rules.force_per_unit = c.force;
    base::RandomStream random{base::RandomKey{base::Seed{3}, base::Purpose::ScenarioTest, 0, 0}, 0};
    for (std::uint32_t id = 0; id < c.organisms; ++id) {
        evolution::BodyGenes genes;
        const auto gene = [&](double low, double high) { return static_cast<float>(random.uniform(low, high)); };
        genes << gene(20, 250), gene(20, 250), gene(10, 200), 100, gene(0, c.sight), gene(0, c.sight);
        const physics::Coordinate x = to_units(random.uniform(20, std::min(c.width, c.crowd_side) - 20));
        meadow.add_organism(x, to_units(random.uniform(20, std::min(c.height, c.crowd_side) - 20)), genes);
    }
    const auto places = [&](std::uint32_t count) {
        std::vector<Place> all(count);
        for (Place& place : all) {
            place.x = to_units(random.uniform(c.item_radius, c.width - c.item_radius));
            place.y = to_units(random.uniform(c.item_radius, c.height - c.item_radius));
        }
        return all;
    };
    const std::vector<Place> foods = places(c.foods);
    meadow.put_items(foods, places(c.poisons), c.item_radius, true);
    meadow.begin();
    std::size_t eaten = 0, looked = 0;
    for (std::uint32_t tick = 1; tick <= 400; ++tick) {
        meadow.perceive();
        const OrganismColumns columns = meadow.columns();
        expect_nearest_are_known(columns.food, meadow.bodies, meadow.food, tick);
        expect_nearest_are_known(columns.poison, meadow.bodies, meadow.poison, tick);
        if (HasFatalFailure()) {
            return;
        }
        meadow.act();
        looked += static_cast<std::size_t>(std::count_if(
            columns.food.others, columns.food.others + meadow.bodies.size(), [](float others) { return others < 0; }));
        expect_equal(meadow.meals(meadow.food_claims), meals_by_trying_all(meadow.bodies, meadow.food), "food",
                     static_cast<int>(tick));
        expect_equal(meadow.meals(meadow.poison_claims), meals_by_trying_all(meadow.bodies, meadow.poison), "poison",
                     static_cast<int>(tick));
        if (HasFatalFailure()) {
            return;
        }
        eaten += meadow.meals(meadow.food_claims).size() + meadow.meals(meadow.poison_claims).size();
        meadow.eat();
    }
    EXPECT_GT(eaten, 100u);
    EXPECT_GT(looked, 100u);
    EXPECT_LT(looked, std::size_t{400} * c.organisms) << "no organism searches in every tick";
}

INSTANTIATE_TEST_SUITE_P(Conditions, AMeadow,
                         testing::Values(Conditions{"even", 900, 700, 120, 150, 150, 200, 900, 600, 1, 4},
                                         Conditions{"fast", 900, 700, 120, 150, 150, 200, 900, 100'000, 200, 4},
                                         Conditions{"large_items", 900, 700, 120, 150, 150, 200, 900, 600, 20, 30},
                                         Conditions{"far_sighted", 3000, 3000, 100, 200, 150, 1000, 3000, 600, 3, 4},
                                         Conditions{"crowd_in_a_corner", 6000, 6000, 150, 4000, 1000, 300, 300, 600, 5,
                                                    10},
                                         Conditions{"long_and_thin", 20'000, 60, 150, 400, 200, 150, 20'000, 600, 2, 4},
                                         Conditions{"items_everywhere", 700, 700, 10, 9000, 300, 250, 700, 600, 2, 4},
                                         Conditions{"few", 900, 700, 60, 100, 150, 10'000, 900, 600, 1, 4},
                                         Conditions{"hardly_an_item", 5000, 5000, 100, 40, 2, 500, 5000, 600, 20, 60}),
                         testing::PrintToStringParamName());

} // namespace
} // namespace evod::simulation
