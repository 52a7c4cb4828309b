#include "server/simulation/items.h"

#include "server/base/inline_executor.h"
#include "server/physics/shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace evod::simulation {
namespace {

base::InlineExecutor executor; // has no state

using physics::Area;
using physics::Boxes;
using physics::Coordinate;
using physics::to_units;

ItemRules rules(std::uint32_t count, std::uint32_t respawn_ticks = 1, bool respawn = true) {
    return {.placement = base::Purpose::FoodPlacement,
            .respawn_purpose = base::Purpose::FoodRespawn,
            .kind = 2,
            .count = count,
            .radius_px = 4,
            .respawn = respawn,
            .respawn_ticks = respawn_ticks};
}

Items some_items(std::uint32_t count, Area area, const Boxes& obstacles = {}, std::uint64_t seed = 1) {
    Items items;
    items.begin_generation(rules(count), base::Seed{seed}, 0, 1, area, BoxGrid{area, obstacles}, executor);
    return items;
}

base::RandomStream stream(std::uint64_t seed) {
    return {base::RandomKey{base::Seed{seed}, base::Purpose::ScenarioTest, 0, 0}, 0};
}

std::uint32_t nearest_of(const Items& items, Coordinate x, Coordinate y, float radius) {
    return items.item_at(items.two_nearest(x, y, radius).place);
}

float square_to(const Items& items, std::uint32_t item, Coordinate x, Coordinate y) {
    const float dx = physics::distance_px(x, items.all()[item].x), dy = physics::distance_px(y, items.all()[item].y);
    return dx * dx + dy * dy;
}

std::uint32_t nearest_by_trying_all(const Items& items, Coordinate x, Coordinate y, float radius) {
    std::uint32_t best = Items::none;
    for (std::uint32_t item = 0; item < items.size(); ++item) {
        if (items.present(item) && square_to(items, item, x, y) <= radius * radius &&
            (best == Items::none || square_to(items, item, x, y) < square_to(items, best, x, y))) {
            best = item;
        }
    }
    return best;
}

float others_square_by_trying_all(const Items& items, Coordinate x, Coordinate y, float radius, std::uint32_t nearest) {
    float least = radius * radius;
    for (std::uint32_t item = 0; item < items.size(); ++item) {
        if (items.present(item) && item != nearest) {
            least = std::min(least, square_to(items, item, x, y));
        }
    }
    return least;
}

using Found = std::vector<std::pair<std::uint32_t, float>>;

Found within_by_trying_all(const Items& items, Coordinate x, Coordinate y, float radius) {
    Found found;
    for (std::uint32_t item = 0; item < items.size(); ++item) {
        if (items.present(item) && square_to(items, item, x, y) <= radius * radius) {
            found.emplace_back(item, square_to(items, item, x, y));
        }
    }
    return found;
}

Found within(const Items& items, Coordinate x, Coordinate y, float radius) {
    Found found;
    items.for_each_within(x, y, radius,
                          [&](std::uint32_t item, std::uint32_t, float square) { found.emplace_back(item, square); });
    std::sort(found.begin(), found.end());
    return found;
}

void expect_queries_agree(const Items& items, const Area& area, base::RandomStream& random, int queries) {
    for (int i = 0; i < queries; ++i) {
        // From up to 10 px beyond the walls, with radii from 0 to the greatest that a gene can have.
        const auto place = [&](Coordinate size) { return to_units(random.uniform(-10, physics::to_px(size) + 10)); };
        const Coordinate x = place(area.width), y = place(area.height);
        const auto radius = static_cast<float>(random.chance(0.2) ? random.uniform(0, 10'000) : random.uniform(0, 200));
        const TwoNearest nearest = items.two_nearest(x, y, radius);
        const std::uint32_t item = items.item_at(nearest.place);
        ASSERT_EQ(item, nearest_by_trying_all(items, x, y, radius));
        if (item != Items::none) {
            ASSERT_EQ(nearest.square, square_to(items, item, x, y));
            ASSERT_EQ(nearest.x, items.all()[item].x);
            ASSERT_EQ(nearest.y, items.all()[item].y);
        }
        ASSERT_EQ(nearest.others_square, others_square_by_trying_all(items, x, y, radius, item));
        ASSERT_EQ(within(items, x, y, radius), within_by_trying_all(items, x, y, radius));
    }
}

base::StateHash recomputed_hash(const Items& items, const std::vector<std::uint32_t>& due) {
    base::StateHash hash;
    for (std::uint32_t item = 0; item < items.size(); ++item) {
        base::EntityHash entity{2, item};
        if (due[item] == 0) {
            entity.add(items.all()[item].x, items.all()[item].y);
        } else {
            entity.add(std::uint64_t{due[item]});
        }
        hash += entity.finish();
    }
    return hash;
}

TEST(Items, AreFoundAsByTestingAll) {
    base::RandomStream random = stream(1);
    for (const std::uint32_t count : {0u, 1u, 7u, 100u, 3000u}) {
        for (const auto& [width, height] : {std::pair{1280.0, 720.0}, {150.0, 5000.0}, {100.0, 100.0}, {5e5, 5e5}}) {
            const Area area{to_units(width), to_units(height)};
            expect_queries_agree(some_items(count, area), area, random, count > 1000 ? 60 : 200);
        }
    }
}

TEST(Items, AreFoundInsideAndOutsideTheirMargin) {
    base::RandomStream random = stream(7);
    const Area area{to_units(2160.0), to_units(1500.0)};
    for (const float margin_px : {1.0f, 300.0f, 740.0f}) {
        ItemRules of_margin = rules(100);
        of_margin.margin_px = margin_px;
        Items items;
        items.begin_generation(of_margin, base::Seed{1}, 0, 1, area, BoxGrid{area, {}}, executor);
        items.add({to_units(5.0), to_units(5.0)});
        items.add({to_units(2150.0), to_units(700.0)});
        expect_queries_agree(items, area, random, 400);
    }
}

TEST(Items, AreFoundWhenThousandsShareACell) {
    // Only a corner is free of obstacles, so all items are in a few cells, far more than fit into a bucket.
    const Area area{to_units(2000.0), to_units(2000.0)};
    Boxes obstacles;
    obstacles.add(to_units(1020.0), to_units(1000.0), 980, 1000, 0);
    obstacles.add(to_units(1000.0), to_units(1030.0), 1000, 970, 0);
    Items items = some_items(4000, area, obstacles);
    for (std::uint32_t item = 0; item < items.size(); ++item) {
        ASSERT_LT(items.all()[item].x, to_units(40.0));
        ASSERT_LT(items.all()[item].y, to_units(60.0));
    }
    base::RandomStream random = stream(2);
    const Area corner{to_units(60.0), to_units(80.0)};
    expect_queries_agree(items, corner, random, 50);
    for (std::uint32_t tick = 1; tick <= 40; ++tick) { // and also while they come and go
        items.reappear(tick, BoxGrid{area, obstacles}, executor);
        for (int eaten = 0; eaten < 150; ++eaten) {
            if (const std::uint32_t item = random.below(items.size()); items.present(item)) {
                items.consume(item, tick);
            }
        }
        expect_queries_agree(items, corner, random, 5);
    }
}

TEST(Items, AtTheRadiusAreFoundAndTiesGoToTheLowestId) {
    Items items = some_items(400, {to_units(300.0), to_units(300.0)});
    base::RandomStream random = stream(3);
    int ties = 0;
    for (int i = 0; i < 4000; ++i) {
        const std::uint32_t a = random.below(400), b = random.below(400);
        // A place equally far from both, in whole units.
        const Coordinate x = items.all()[a].x / 2 + items.all()[b].x / 2,
                         y = items.all()[a].y / 2 + items.all()[b].y / 2;
        const float square = square_to(items, a, x, y);
        ties += a != b && square == square_to(items, b, x, y);
        const float radius = std::sqrt(square);
        ASSERT_EQ(nearest_of(items, x, y, radius), nearest_by_trying_all(items, x, y, radius));
        ASSERT_EQ(within(items, x, y, radius), within_by_trying_all(items, x, y, radius));
    }
    EXPECT_GT(ties, 200);

    const Coordinate x = items.all()[7].x - to_units(3.0), y = items.all()[7].y - to_units(4.0);
    EXPECT_FALSE(within(items, x, y, 5).empty());
    EXPECT_TRUE(std::ranges::any_of(within(items, x, y, 5), [](const auto& found) { return found.first == 7; }));
    EXPECT_FALSE(std::ranges::any_of(within(items, x, y, 4.9999f), [](const auto& found) { return found.first == 7; }));
}

TEST(Items, AtTheSamePlaceTheLowestIdWins) {
    // An island with room for one item: all items are at the same place.
    Items items = some_items(50, {to_units(8.0), to_units(8.0)});
    EXPECT_EQ(nearest_of(items, to_units(4.0), to_units(4.0), 0), 0u);
    items.consume(0, 1);
    EXPECT_EQ(nearest_of(items, to_units(4.0), to_units(4.0), 0), 1u);
    items.consume(2, 1);
    items.consume(1, 1);
    EXPECT_EQ(nearest_of(items, to_units(4.0), to_units(4.0), 1), 3u);
    items.reappear(2, {}, executor);
    EXPECT_EQ(nearest_of(items, to_units(4.0), to_units(4.0), 1), 0u);
}

TEST(Items, ComeAndGoByTheirRulesWithTheRightHash) {
    for (const std::uint32_t respawn_ticks : {1u, 2u, 17u, 100u}) {
        const Area area{to_units(600.0), to_units(400.0)};
        Items items;
        items.begin_generation(rules(300, respawn_ticks), base::Seed{4}, 0, 1, area, {}, executor);
        std::vector<std::uint32_t> due(300, 0);
        ASSERT_EQ(items.hash(), recomputed_hash(items, due));
        base::RandomStream random = stream(respawn_ticks);
        for (std::uint32_t tick = 1; tick <= 400; ++tick) {
            items.reappear(tick, {}, executor);
            for (std::uint32_t& when : due) {
                when = when <= tick ? 0 : when;
            }
            for (int eaten = 0; eaten < 3; ++eaten) {
                if (const std::uint32_t item = random.below(300); due[item] == 0) {
                    items.consume(item, tick);
                    due[item] = tick + respawn_ticks;
                }
            }
            std::uint32_t there = 0;
            for (std::uint32_t item = 0; item < 300; ++item) {
                ASSERT_EQ(items.present(item), due[item] == 0) << "item " << item << ", tick " << tick;
                there += due[item] == 0;
            }
            ASSERT_EQ(items.present_count(), there);
            ASSERT_EQ(items.hash(), recomputed_hash(items, due)) << "tick " << tick;
            if (tick % 20 == 0) {
                expect_queries_agree(items, area, random, 10);
            }
        }
    }
}

TEST(Items, WithoutRespawnStayAway) {
    Items items;
    items.begin_generation(rules(20, 1, false), base::Seed{5}, 0, 1, {to_units(500.0), to_units(500.0)}, {}, executor);
    items.consume(3, 1);
    for (std::uint32_t tick = 2; tick < 1000; ++tick) {
        items.reappear(tick, {}, executor);
    }
    EXPECT_FALSE(items.present(3));
    EXPECT_EQ(items.present_count(), 19u);
}

TEST(Items, AreAlwaysClearOfWallsAndObstacles) {
    const Area area{to_units(400.0), to_units(300.0)};
    Boxes obstacles;
    base::RandomStream random = stream(6);
    for (int i = 0; i < 10; ++i) {
        obstacles.add(to_units(random.uniform(30, 370)), to_units(random.uniform(30, 270)), 25, 15, 0);
    }
    Items items = some_items(500, area, obstacles);
    const auto expect_clear = [&] {
        for (std::uint32_t item = 0; item < items.size(); ++item) {
            ASSERT_GE(items.all()[item].x, to_units(4.0));
            ASSERT_LE(items.all()[item].x, area.width - to_units(4.0));
            ASSERT_GE(items.all()[item].y, to_units(4.0));
            ASSERT_LE(items.all()[item].y, area.height - to_units(4.0));
            for (std::size_t box = 0; box < obstacles.size(); ++box) {
                ASSERT_FALSE(physics::box_circle(physics::distance_px(obstacles.x[box], items.all()[item].x),
                                                 physics::distance_px(obstacles.y[box], items.all()[item].y), {25, 15},
                                                 4)
                                 .touching);
            }
        }
    };
    expect_clear();
    for (std::uint32_t item = 0; item < items.size(); ++item) {
        items.consume(item, 1);
    }
    EXPECT_EQ(nearest_of(items, to_units(200.0), to_units(150.0), 1000), Items::none);
    items.reappear(2, BoxGrid{area, obstacles}, executor);
    EXPECT_EQ(items.present_count(), 500u);
    expect_clear();
}

TEST(Items, ReappearAtAnotherPlace) {
    Items items = some_items(100, {to_units(1000.0), to_units(1000.0)});
    const auto before = items.all();
    for (std::uint32_t item = 0; item < items.size(); ++item) {
        items.consume(item, 5);
    }
    items.reappear(6, {}, executor);
    for (std::uint32_t item = 0; item < items.size(); ++item) {
        EXPECT_NE(items.all()[item].x, before[item].x);
    }
}

} // namespace
} // namespace evod::simulation
