// Organisms move, perceive and eat in the same way everywhere on an island, bit for bit.
#include "tests/unit/simulation/meadow.h"

#include <gtest/gtest.h>

#include <vector>

namespace evod::simulation {
namespace {

using physics::Coordinate;
using physics::to_units;

/// A crowd of organisms, crates, food and poison without respawn, far from the walls, shifted by whole units.
Meadow meadow_at(Coordinate shift_x, Coordinate shift_y) {
    Meadow meadow;
    meadow.area = {to_units(300'000.0), to_units(300'000.0)};
    meadow.rules.force_per_unit = 2;
    base::RandomStream random{base::RandomKey{base::Seed{5}, base::Purpose::ScenarioTest, 0, 0}, 0};
    const auto x = [&] { return to_units(random.uniform(2000, 3500)) + shift_x; };
    const auto y = [&] { return to_units(random.uniform(2000, 3500)) + shift_y; };
    for (int i = 0; i < 1500; ++i) {
        evolution::BodyGenes genes;
        const auto gene = [&](double low, double high) { return static_cast<float>(random.uniform(low, high)); };
        genes << gene(20, 250), gene(20, 250), gene(40, 200), 100, gene(20, 200), gene(20, 200);
        const Coordinate at_x = x();
        meadow.add_organism(at_x, y(), genes);
    }
    const auto places = [&](int count) {
        std::vector<Place> all;
        for (int i = 0; i < count; ++i) {
            const Coordinate at_x = x();
            all.push_back({at_x, y()});
        }
        return all;
    };
    const std::vector<Place> foods = places(600);
    meadow.put_items(foods, places(300), 4, false);
    for (int i = 0; i < 12; ++i) {
        const Coordinate at_x = x();
        meadow.boxes.add(at_x, y(), 20, 15, i < 8 ? 0.3f : 0.0f);
    }
    meadow.begin();
    return meadow;
}

TEST(TheFarCorner, HasTheSameMotionsBitForBit) {
    // By odd numbers of units that are not a multiple of a cell or strip.
    const Coordinate shift_x = to_units(295'000.0) - 1'277, shift_y = to_units(294'500.0) - 91;
    Meadow here = meadow_at(0, 0), there = meadow_at(shift_x, shift_y);
    std::size_t eaten = 0;
    for (std::uint32_t tick = 1; tick <= 240; ++tick) {
        for (Meadow* meadow : {&here, &there}) {
            meadow->perceive();
            meadow->act();
        }
        for (std::size_t i = 0; i < here.bodies.size(); ++i) {
            ASSERT_EQ(there.bodies.x[i] - here.bodies.x[i], shift_x) << "tick " << tick << ", body " << i;
            ASSERT_EQ(there.bodies.y[i] - here.bodies.y[i], shift_y) << "tick " << tick << ", body " << i;
            ASSERT_EQ(there.bodies.velocity_x[i], here.bodies.velocity_x[i]) << "tick " << tick << ", body " << i;
            ASSERT_EQ(there.bodies.velocity_y[i], here.bodies.velocity_y[i]) << "tick " << tick << ", body " << i;
        }
        for (std::size_t i = 0; i < here.boxes.size(); ++i) {
            ASSERT_EQ(there.boxes.x[i] - here.boxes.x[i], shift_x) << "tick " << tick << ", box " << i;
        }
        ASSERT_EQ(there.meals(there.food_claims).size(), here.meals(here.food_claims).size()) << "tick " << tick;
        eaten += here.meals(here.food_claims).size();
        here.eat();
        there.eat();
        for (std::uint32_t item = 0; item < here.food.size(); ++item) {
            ASSERT_EQ(there.food.present(item), here.food.present(item)) << "tick " << tick << ", item " << item;
        }
    }
    EXPECT_GT(eaten, 200u);
}

} // namespace
} // namespace evod::simulation
