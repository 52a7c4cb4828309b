#include "server/simulation/placement.h"

#include "server/physics/shapes.h"
#include "tests/support/chi_square.h"

#include <gtest/gtest.h>

#include <array>
#include <vector>

namespace evod::simulation {
namespace {

using physics::Area;
using physics::Boxes;
using physics::Coordinate;
using physics::to_units;

constexpr double alpha = 1e-6; // share of seeds for which a correct build would fail

TEST(RandomPlace, IsUniformWithinTheWallsByItsRadius) {
    // Pearson chi-square over 10 × 10 equal cells of where a centre can be, 99 degrees of freedom.
    const Area area{to_units(300.0), to_units(200.0)};
    const base::RandomKey key{base::Seed{1}, base::Purpose::ScenarioTest, 0, 0};
    std::array<std::uint64_t, 100> cells{};
    for (std::uint32_t i = 0; i < 50'000; ++i) {
        base::RandomStream random{key, i};
        const Place place = random_place(random, area, 10, {});
        const double x = (physics::to_px(place.x) - 10) / 280, y = (physics::to_px(place.y) - 10) / 180;
        ASSERT_TRUE(x >= 0 && x <= 1 && y >= 0 && y <= 1);
        ++cells[static_cast<std::size_t>(std::min(y * 10, 9.0)) * 10 + static_cast<std::size_t>(std::min(x * 10, 9.0))];
    }
    EXPECT_GT(support::p_value_of_equal_cells(cells), alpha);
}

TEST(RandomPlace, ReachesBothEndsOfWhatTheWallsLeave) {
    const Area area{to_units(20.0) + 3, to_units(20.0)}; // four places for a circle of 10 px
    const base::RandomKey key{base::Seed{2}, base::Purpose::ScenarioTest, 0, 0};
    std::array<std::uint64_t, 4> seen{};
    for (std::uint32_t i = 0; i < 4000; ++i) {
        base::RandomStream random{key, i};
        const Place place = random_place(random, area, 10, {});
        ++seen.at(static_cast<std::size_t>(place.x - to_units(10.0)));
        ASSERT_EQ(place.y, to_units(10.0));
    }
    EXPECT_GT(support::p_value_of_equal_cells(seen), alpha);
}

TEST(RandomPlace, IsUniformOverWhatTheBoxesLeave) {
    const Area area{to_units(300.0), to_units(300.0)};
    Boxes boxes;
    boxes.add(to_units(150.0), to_units(150.0), 40, 40, 0); // with a radius of 10 px: no centre in the middle 100 × 100
    const base::RandomKey key{base::Seed{3}, base::Purpose::ScenarioTest, 0, 0};
    std::array<std::uint64_t, 4> quarters{};
    for (std::uint32_t i = 0; i < 20'000; ++i) {
        base::RandomStream random{key, i};
        const Place place = random_place(random, area, 10, boxes);
        ASSERT_FALSE(physics::box_circle(physics::distance_px(boxes.x[0], place.x),
                                         physics::distance_px(boxes.y[0], place.y), {40, 40}, 10)
                         .touching);
        ++quarters[(place.x > to_units(150.0) ? 1u : 0u) + (place.y > to_units(150.0) ? 2u : 0u)];
    }
    EXPECT_GT(support::p_value_of_equal_cells(quarters), alpha);
}

bool circles_touch(const Place& a, float radius_a, const Place& b, float radius_b) {
    return physics::circle_circle(physics::distance_px(a.x, b.x), physics::distance_px(a.y, b.y), radius_a, radius_b)
        .touching;
}

TEST(PlaceCircles, ClearOfWallsBoxesAndEachOtherInACrowd) {
    const Area area{to_units(700.0), to_units(500.0)};
    const PlacedBoxes boxes = place_boxes({.obstacle_count = 8,
                                           .crate_count = 8,
                                           .obstacle_half_size_px = 20,
                                           .crate_half_size_px = 10,
                                           .crate_mass_kg = 4},
                                          base::Seed{4}, 0, 1, area);
    Boxes all = boxes.crates;
    for (std::size_t i = 0; i < boxes.obstacles.size(); ++i)
        all.add(boxes.obstacles.x[i], boxes.obstacles.y[i], 20, 20, 0);
    std::vector<float> radius;
    base::RandomStream random{base::RandomKey{base::Seed{5}, base::Purpose::ScenarioTest, 0, 0}, 0};
    for (int i = 0; i < 250; ++i)
        radius.push_back(static_cast<float>(random.uniform(2, 16)));
    const std::vector<Place> places = place_circles(radius, base::Seed{6}, 0, 1, area, all);
    ASSERT_EQ(places.size(), radius.size());
    for (std::size_t i = 0; i < places.size(); ++i) {
        ASSERT_GE(places[i].x, to_units(radius[i]));
        ASSERT_LE(places[i].x, area.width - to_units(radius[i]));
        ASSERT_GE(places[i].y, to_units(radius[i]));
        ASSERT_LE(places[i].y, area.height - to_units(radius[i]));
        for (std::size_t j = 0; j < i; ++j)
            ASSERT_FALSE(circles_touch(places[i], radius[i], places[j], radius[j])) << i << " and " << j;
        for (std::size_t box = 0; box < all.size(); ++box)
            ASSERT_FALSE(physics::box_circle(physics::distance_px(all.x[box], places[i].x),
                                             physics::distance_px(all.y[box], places[i].y),
                                             {all.half_width[box], all.half_height[box]}, radius[i])
                             .touching);
    }
}

TEST(PlaceCircles, AnOrganismDoesNotMoveWhenOthersAreBornAfterIt) {
    const Area area{to_units(500.0), to_units(500.0)};
    const auto few = place_circles(std::vector<float>(20, 8), base::Seed{7}, 3, 2, area, {});
    const auto many = place_circles(std::vector<float>(60, 8), base::Seed{7}, 3, 2, area, {});
    for (std::size_t i = 0; i < few.size(); ++i) {
        EXPECT_EQ(few[i].x, many[i].x);
        EXPECT_EQ(few[i].y, many[i].y);
    }
}

TEST(PlaceBoxes, CratesClearOfObstaclesAndOfEachOtherAllInsideTheWalls) {
    const Area area{to_units(600.0), to_units(600.0)};
    const PlacedBoxes placed = place_boxes({.obstacle_count = 20,
                                            .crate_count = 30,
                                            .obstacle_half_size_px = 15,
                                            .crate_half_size_px = 12,
                                            .crate_mass_kg = 2},
                                           base::Seed{8}, 1, 4, area);
    ASSERT_EQ(placed.crates.size(), 30u);
    ASSERT_EQ(placed.obstacles.size(), 20u);
    const auto clear = [](const Boxes& a, std::size_t i, const Boxes& b, std::size_t j) {
        return !physics::box_box(physics::distance_px(a.x[i], b.x[j]), physics::distance_px(a.y[i], b.y[j]),
                                 {a.half_width[i], a.half_height[i]}, {b.half_width[j], b.half_height[j]})
                    .touching;
    };
    for (std::size_t i = 0; i < 30; ++i) {
        EXPECT_FLOAT_EQ(placed.crates.inverse_mass[i], 0.5f);
        ASSERT_GE(placed.crates.x[i], to_units(12.0));
        ASSERT_LE(placed.crates.y[i], area.height - to_units(12.0));
        for (std::size_t j = 0; j < i; ++j)
            ASSERT_TRUE(clear(placed.crates, i, placed.crates, j));
        for (std::size_t j = 0; j < 20; ++j)
            ASSERT_TRUE(clear(placed.crates, i, placed.obstacles, j));
    }
    for (std::size_t i = 0; i < 20; ++i) {
        EXPECT_EQ(placed.obstacles.inverse_mass[i], 0);
        ASSERT_GE(placed.obstacles.x[i], to_units(15.0));
        ASSERT_LE(placed.obstacles.x[i], area.width - to_units(15.0));
    }
}

TEST(PlaceBoxes, ObstaclesStayFromGenerationToGenerationAndCratesDoNot) {
    const Area area{to_units(600.0), to_units(600.0)};
    const BoxRules rules{.obstacle_count = 5,
                         .crate_count = 5,
                         .obstacle_half_size_px = 15,
                         .crate_half_size_px = 12,
                         .crate_mass_kg = 2};
    const PlacedBoxes first = place_boxes(rules, base::Seed{9}, 0, 1, area),
                      next = place_boxes(rules, base::Seed{9}, 0, 2, area);
    EXPECT_EQ(first.obstacles.x, next.obstacles.x);
    EXPECT_NE(first.crates.x, next.crates.x);
}

} // namespace
} // namespace evod::simulation
