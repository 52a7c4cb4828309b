#include "server/simulation/placement.h"

#include "server/base/inline_executor.h"
#include "server/jobs/thread_pool.h"
#include "server/physics/shapes.h"
#include "tests/support/chi_square.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>
#include <vector>

namespace evod::simulation {
namespace {

using physics::Area;
using physics::Boxes;
using physics::Coordinate;
using physics::to_units;

using support::alpha;

TEST(RandomPlace, IsUniformWithinTheWallsByItsRadius) {
    // Pearson chi-square over 10 × 10 equal cells of the places possible for a centre, 99 degrees of freedom.
    const Area area{to_units(300.0), to_units(200.0)};
    const base::RandomKey key{base::Seed{1}, base::Purpose::ScenarioTest, 0, 0};
    std::array<std::uint64_t, 100> cells{};
    for (std::uint32_t i = 0; i < 50'000; ++i) {
        base::RandomStream random{key, i};
        const Place place = random_place(random, area, 10, BoxGrid{});
        const double x = (physics::to_px(place.x) - 10) / 280, y = (physics::to_px(place.y) - 10) / 180;
        ASSERT_TRUE(x >= 0 && x <= 1 && y >= 0 && y <= 1);
        ++cells[static_cast<std::size_t>(std::min(y * 10, 9.0)) * 10 + static_cast<std::size_t>(std::min(x * 10, 9.0))];
    }
    EXPECT_GT(support::p_value_of_equal_cells(cells), alpha);
}

TEST(RandomPlace, ReachesBothWalls) {
    const Area area{to_units(20.0) + 3, to_units(20.0)}; // a circle of radius 10 px has four places
    const base::RandomKey key{base::Seed{2}, base::Purpose::ScenarioTest, 0, 0};
    std::array<std::uint64_t, 4> seen{};
    for (std::uint32_t i = 0; i < 4000; ++i) {
        base::RandomStream random{key, i};
        const Place place = random_place(random, area, 10, BoxGrid{});
        ++seen.at(static_cast<std::size_t>(place.x - to_units(10.0)));
        ASSERT_EQ(place.y, to_units(10.0));
    }
    EXPECT_GT(support::p_value_of_equal_cells(seen), alpha);
}

TEST(RandomPlace, IsUniformOutsideTheBoxes) {
    const Area area{to_units(300.0), to_units(300.0)};
    Boxes boxes;
    boxes.add(to_units(150.0), to_units(150.0), 40, 40, 0); // a circle of radius 10 px: no centre in the middle 100 ×
                                                            // 100 px
    const base::RandomKey key{base::Seed{3}, base::Purpose::ScenarioTest, 0, 0};
    std::array<std::uint64_t, 4> quarters{};
    for (std::uint32_t i = 0; i < 20'000; ++i) {
        base::RandomStream random{key, i};
        const Place place = random_place(random, area, 10, BoxGrid{area, boxes});
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

TEST(PlaceCircles, AreClearOfWallsBoxesAndEachOther) {
    const Area area{to_units(700.0), to_units(500.0)};
    const PlacedBoxes boxes = place_boxes({.obstacle_count = 8,
                                           .crate_count = 8,
                                           .obstacle_half_size_px = 20,
                                           .crate_half_size_px = 10,
                                           .crate_mass_kg = 4},
                                          base::Seed{4}, 0, 1, area);
    Boxes all = boxes.crates;
    for (std::size_t i = 0; i < boxes.obstacles.size(); ++i) {
        all.add(boxes.obstacles.x[i], boxes.obstacles.y[i], 20, 20, 0);
    }
    std::vector<float> radius;
    base::RandomStream random{base::RandomKey{base::Seed{5}, base::Purpose::ScenarioTest, 0, 0}, 0};
    for (int i = 0; i < 250; ++i) {
        radius.push_back(static_cast<float>(random.uniform(2, 16)));
    }
    base::InlineExecutor executor;
    const std::vector<Place> places = place_circles(radius, base::Seed{6}, 0, 1, area, BoxGrid{area, all}, executor);
    ASSERT_EQ(places.size(), radius.size());
    for (std::size_t i = 0; i < places.size(); ++i) {
        ASSERT_GE(places[i].x, to_units(radius[i]));
        ASSERT_LE(places[i].x, area.width - to_units(radius[i]));
        ASSERT_GE(places[i].y, to_units(radius[i]));
        ASSERT_LE(places[i].y, area.height - to_units(radius[i]));
        for (std::size_t j = 0; j < i; ++j) {
            ASSERT_FALSE(circles_touch(places[i], radius[i], places[j], radius[j])) << i << " and " << j;
        }
        for (std::size_t box = 0; box < all.size(); ++box) {
            ASSERT_FALSE(physics::box_circle(physics::distance_px(all.x[box], places[i].x),
                                             physics::distance_px(all.y[box], places[i].y),
                                             {all.half_width[box], all.half_height[box]}, radius[i])
                             .touching);
        }
    }
}

bool clear_of_all(Place place, float radius, const Boxes& boxes) {
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        if (physics::box_circle(physics::distance_px(boxes.x[i], place.x), physics::distance_px(boxes.y[i], place.y),
                                {boxes.half_width[i], boxes.half_height[i]}, radius)
                .touching) {
            return false;
        }
    }
    return true;
}

/// The rule, literally: one organism after another, each at the first of its attempts that is clear of everything.
std::vector<Place> place_one_by_one(const std::vector<float>& radius, base::Seed seed, const Area& area,
                                    const Boxes& boxes) {
    const base::RandomKey key{seed, base::Purpose::OrganismPlacement, 2, 3};
    std::vector<Place> places;
    for (std::uint32_t id = 0; id < radius.size(); ++id) {
        base::RandomStream random{key, id};
        const Coordinate margin = to_units(radius[id]);
        const auto coordinate = [&](Coordinate size) {
            return margin + static_cast<Coordinate>(random.below(static_cast<std::uint32_t>(size - 2 * margin) + 1));
        };
        bool clear = false;
        Place place{};
        while (!clear) {
            place.x = coordinate(area.width);
            place.y = coordinate(area.height);
            clear = clear_of_all(place, radius[id], boxes);
            for (std::size_t other = 0; other < places.size() && clear; ++other) {
                clear = !circles_touch(places[other], radius[other], place, radius[id]);
            }
        }
        places.push_back(place);
    }
    return places;
}

/// An island on which circles of the given radii and a few boxes cover two fifths.
struct Crowd {
    std::vector<float> radius;
    Area area;
    Boxes boxes;

    Crowd(std::size_t count, float least, float greatest) {
        base::RandomStream random{base::RandomKey{base::Seed{10}, base::Purpose::ScenarioTest, 0, 0}, 0};
        double covered = 0;
        for (std::size_t i = 0; i < count; ++i) {
            radius.push_back(static_cast<float>(random.uniform(least, greatest)));
            covered += std::numbers::pi * static_cast<double>(radius.back()) * static_cast<double>(radius.back());
        }
        // The room for a centre ends before the walls, so there is more of it where walls matter.
        const double side = std::sqrt(covered / 0.4) + 2 * static_cast<double>(greatest);
        area = {to_units(1.25 * side), to_units(0.8 * side)};
        const auto half = static_cast<float>(side / 100);
        for (int i = 0; i < 10; ++i) {
            boxes.add(static_cast<Coordinate>(random.below(static_cast<std::uint32_t>(area.width))),
                      static_cast<Coordinate>(random.below(static_cast<std::uint32_t>(area.height))), half, half / 2,
                      0);
        }
    }
};

bool operator==(const Place& a, const Place& b) {
    return a.x == b.x && a.y == b.y;
}

class PlaceCirclesOnAnyThreadCount : public testing::TestWithParam<std::size_t> {};

TEST_P(PlaceCirclesOnAnyThreadCount, EqualsPlacingThemOneByOne) {
    jobs::ThreadPool executor{GetParam()};
    for (const auto& [least, greatest] : {std::pair{20.0f, 20.0f}, {1.0f, 30.0f}}) {
        for (const std::size_t count : {1u, 50u, 6000u}) {
            const Crowd crowd{count, least, greatest};
            const auto places = place_circles(crowd.radius, base::Seed{11}, 2, 3, crowd.area,
                                              BoxGrid{crowd.area, crowd.boxes}, executor);
            const auto expected = place_one_by_one(crowd.radius, base::Seed{11}, crowd.area, crowd.boxes);
            for (std::size_t i = 0; i < count; ++i) {
                ASSERT_TRUE(places[i] == expected[i]) << i << " of " << count;
            }
        }
    }
}
INSTANTIATE_TEST_SUITE_P(Threads, PlaceCirclesOnAnyThreadCount, testing::Values(1, 2, 3, 8, 13));

TEST(PlaceCircles, ManyAreClearOfEachOtherOnACrowdedIsland) {
    const Crowd crowd{40'000, 4, 24};
    jobs::ThreadPool executor{3};
    const auto places =
        place_circles(crowd.radius, base::Seed{12}, 0, 1, crowd.area, BoxGrid{crowd.area, crowd.boxes}, executor);
    std::vector<std::size_t> by_x(places.size());
    std::iota(by_x.begin(), by_x.end(), std::size_t{0});
    std::ranges::sort(by_x, {}, [&](std::size_t i) { return places[i].x; });
    for (std::size_t a = 0; a < by_x.size(); ++a) {
        const std::size_t i = by_x[a];
        ASSERT_TRUE(clear_of_all(places[i], crowd.radius[i], crowd.boxes));
        for (std::size_t b = a + 1; b < by_x.size(); ++b) {
            const std::size_t j = by_x[b];
            if (places[j].x - places[i].x > to_units(49.0)) {
                break;
            }
            ASSERT_FALSE(circles_touch(places[i], crowd.radius[i], places[j], crowd.radius[j])) << i << " and " << j;
        }
    }
}

TEST(PlaceCircles, FindsRoomOnTheLargestIsland) {
    // Coordinates near the limit of 32 bits, and the largest possible radii.
    const Area area{to_units(500'000.0), to_units(500'000.0)};
    base::InlineExecutor executor;
    const std::vector<float> radius(300, 10'000);
    const auto places = place_circles(radius, base::Seed{13}, 2, 3, area, {}, executor);
    const auto expected = place_one_by_one(radius, base::Seed{13}, area, {});
    for (std::size_t i = 0; i < radius.size(); ++i) {
        ASSERT_TRUE(places[i] == expected[i]) << i;
    }
}

TEST(BoxGrid, EqualsATestOfEveryBox) {
    const Area area{to_units(3000.0), to_units(1000.0)};
    base::RandomStream random{base::RandomKey{base::Seed{14}, base::Purpose::ScenarioTest, 0, 0}, 0};
    const auto somewhere = [&] {
        const auto x = static_cast<Coordinate>(random.below(static_cast<std::uint32_t>(area.width) + 1));
        return Place{x, static_cast<Coordinate>(random.below(static_cast<std::uint32_t>(area.height) + 1))};
    };
    for (const std::size_t count : {0u, 1u, 5u, 400u}) {
        Boxes boxes;
        for (std::size_t i = 0; i < count; ++i) {
            const Place place = somewhere();
            boxes.add(place.x, place.y, static_cast<float>(random.uniform(1, 40)),
                      static_cast<float>(random.uniform(1, 40)), 0);
        }
        const BoxGrid grid{area, boxes};
        std::size_t clear = 0;
        for (int query = 0; query < 5000; ++query) {
            const Place place = somewhere();
            const auto size = static_cast<float>(random.uniform(0, 60));
            ASSERT_EQ(grid.clear_of_circle(place, size), clear_of_all(place, size, boxes));
            bool box_clear = true;
            for (std::size_t i = 0; i < boxes.size(); ++i) {
                box_clear &= !physics::box_box(physics::distance_px(boxes.x[i], place.x),
                                               physics::distance_px(boxes.y[i], place.y),
                                               {boxes.half_width[i], boxes.half_height[i]}, {size, size})
                                  .touching;
            }
            ASSERT_EQ(grid.clear_of_box(place, size), box_clear);
            clear += box_clear;
        }
        EXPECT_GT(clear, 0u);
    }
}

TEST(PlaceCircles, LaterOrganismsDoNotChangeEarlierPlaces) {
    const Area area{to_units(500.0), to_units(500.0)};
    base::InlineExecutor executor;
    const auto few = place_circles(std::vector<float>(20, 8), base::Seed{7}, 3, 2, area, {}, executor);
    const auto many = place_circles(std::vector<float>(60, 8), base::Seed{7}, 3, 2, area, {}, executor);
    for (std::size_t i = 0; i < few.size(); ++i) {
        EXPECT_EQ(few[i].x, many[i].x);
        EXPECT_EQ(few[i].y, many[i].y);
    }
}

TEST(PlaceBoxes, AreInsideTheWallsWithCratesClearOfOthers) {
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
        for (std::size_t j = 0; j < i; ++j) {
            ASSERT_TRUE(clear(placed.crates, i, placed.crates, j));
        }
        for (std::size_t j = 0; j < 20; ++j) {
            ASSERT_TRUE(clear(placed.crates, i, placed.obstacles, j));
        }
    }
    for (std::size_t i = 0; i < 20; ++i) {
        EXPECT_EQ(placed.obstacles.inverse_mass[i], 0);
        ASSERT_GE(placed.obstacles.x[i], to_units(15.0));
        ASSERT_LE(placed.obstacles.x[i], area.width - to_units(15.0));
    }
}

TEST(PlaceBoxes, ObstaclesStayInPlaceAndCratesDoNot) {
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

TEST(SpawnMargin, KeepsTheCentresOfEverythingAwayFromWalls) {
    const physics::Area area{physics::to_units(400.0), physics::to_units(300.0)};
    constexpr float margin_px = 90;
    const auto expect_inside = [&](Coordinate x, Coordinate y) {
        const Coordinate margin = physics::to_units(margin_px);
        ASSERT_GE(x, margin);
        ASSERT_LE(x, area.width - margin);
        ASSERT_GE(y, margin);
        ASSERT_LE(y, area.height - margin);
    };
    base::RandomStream random{base::RandomKey{base::Seed{5}, base::Purpose::ScenarioTest, 0, 0}, 0};
    for (int i = 0; i < 2000; ++i) {
        const Place place = random_place(random, area, 10, BoxGrid{}, margin_px);
        expect_inside(place.x, place.y);
    }
    base::InlineExecutor executor;
    for (const Place& place :
         place_circles(std::vector<float>(40, 5), base::Seed{3}, 0, 1, area, {}, executor, margin_px)) {
        expect_inside(place.x, place.y);
    }
    const PlacedBoxes boxes = place_boxes({.obstacle_count = 9,
                                           .crate_count = 9,
                                           .obstacle_half_size_px = 5,
                                           .crate_half_size_px = 4,
                                           .crate_mass_kg = 1,
                                           .margin_px = margin_px},
                                          base::Seed{4}, 0, 1, area);
    for (std::size_t i = 0; i < 9; ++i) {
        expect_inside(boxes.obstacles.x[i], boxes.obstacles.y[i]);
        expect_inside(boxes.crates.x[i], boxes.crates.y[i]);
    }
}

TEST(SpawnMargin, MayRoundToMoreThanHalfOfTheIsland) {
    // A float has no number between 249999.984375 and 250000.
    const double width_px = 499'999.99, margin_px = 249'999.994;
    ASSERT_LT(2 * margin_px, width_px);
    const Area area{to_units(width_px), to_units(500'000.0)};
    const auto margin = static_cast<float>(margin_px);
    ASSERT_GT(2 * to_units(margin), area.width);
    base::RandomStream random{base::RandomKey{base::Seed{1}, base::Purpose::ScenarioTest, 0, 0}, 0};
    const Place place = random_place(random, area, 4, BoxGrid{}, margin);
    EXPECT_EQ(place.x, area.width / 2);
}

TEST(SpawnMargin, NoGreaterThanTheRadiusChangesNothing) {
    const physics::Area area{physics::to_units(400.0), physics::to_units(300.0)};
    const auto draw = [&](float margin_px) {
        base::RandomStream random{base::RandomKey{base::Seed{5}, base::Purpose::ScenarioTest, 0, 1}, 0};
        return random_place(random, area, 10, BoxGrid{}, margin_px);
    };
    EXPECT_EQ(draw(10).x, draw(0).x);
    EXPECT_NE(draw(11).x, draw(0).x);
}

} // namespace
} // namespace evod::simulation
