#include "server/physics/broad_phase.h"

#include "tests/support/thread_executor.h"
#include "tests/unit/physics/scene.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <set>
#include <utility>

namespace evod::physics {
namespace {

/// Circles in a cluster, spread out, or on a line; some void, some beyond the walls.
Scene some_scene(base::RandomStream& random) {
    Scene scene;
    const double width = random.uniform(50, 20'000), height = random.chance(0.3) ? random.uniform(50, 200) : width;
    scene.area = {to_units(width), to_units(height)};
    const double spread = random.chance(0.5) ? 1 : random.uniform(0.01, 0.2);
    const std::uint32_t count = random.below(1500);
    for (std::uint32_t i = 0; i < count; ++i) {
        const double x = random.uniform(-30, width * spread + 30);
        scene.add_circle(x, random.uniform(-30, height * spread + 30), uniform_float(random, 0.5, 20), 1);
    }
    for (std::uint32_t i = 0; i < count / 10; ++i) {
        scene.circles.remove(random.below(count));
    }
    return scene;
}

RC_GTEST_PROP(Strips, HoldEveryCircleThatIsThereInOrder, ()) {
    base::RandomStream random = scene_stream(*rc::gen::arbitrary<std::uint64_t>());
    const Scene scene = some_scene(random);
    Strips one, many;
    base::InlineExecutor executor;
    support::ThreadExecutor threads{3};
    const float reach = uniform_float(random, 1, 200);
    one.sort(scene.circles, scene.area, reach, executor);
    many.sort(scene.circles, scene.area, reach, threads);
    RC_ASSERT(std::equal(one.order().begin(), one.order().end(), many.order().begin(), many.order().end()));
    std::set<std::uint32_t> seen;
    for (std::uint32_t strip = 0; strip < one.strip_count(); ++strip) {
        const base::Range places = one.strip(strip);
        for (std::size_t k = places.begin; k < places.end; ++k) {
            const std::uint32_t i = one.order()[k];
            seen.insert(i);
            RC_ASSERT(one.strip_at(scene.circles.y[i]) == strip);
            RC_ASSERT(one.strip_of_place(k) == strip);
            if (k > places.begin) {
                const std::uint32_t before = one.order()[k - 1];
                RC_ASSERT(std::pair(scene.circles.x[before], scene.circles.id[before]) <
                          std::pair(scene.circles.x[i], scene.circles.id[i]));
            }
        }
    }
    std::size_t there = 0;
    for (std::size_t i = 0; i < scene.circles.size(); ++i) {
        there += !scene.circles.is_void(i);
    }
    RC_ASSERT(seen.size() == there);
    RC_ASSERT(one.order().size() == there);
}

RC_GTEST_PROP(NearPairs, ListEachPairWithinTheSkinOnceAndNoOther, ()) {
    base::RandomStream random = scene_stream(*rc::gen::arbitrary<std::uint64_t>());
    const Scene scene = some_scene(random);
    NearPairs near;
    base::InlineExecutor executor;
    near.renew(scene.circles, scene.boxes, scene.area, executor);
    std::set<std::pair<std::uint32_t, std::uint32_t>> listed;
    for (std::size_t block = 0; block < block_count(scene.circles.size()); ++block) {
        for (const NearPairs::Pair& pair : near.circle_pairs(block)) {
            RC_ASSERT(listed.insert({std::min(pair.a, pair.b), std::max(pair.a, pair.b)}).second);
        }
    }
    std::size_t within = 0;
    const Circles& circles = scene.circles;
    for (std::uint32_t a = 0; a < circles.size(); ++a) {
        for (std::uint32_t b = a + 1; b < circles.size(); ++b) {
            if (circles.is_void(a) || circles.is_void(b)) {
                continue;
            }
            const float dx = distance_px(circles.x[a], circles.x[b]), dy = distance_px(circles.y[a], circles.y[b]);
            const float distance = std::sqrt(dx * dx + dy * dy),
                        reach = circles.radius[a] + circles.radius[b] + near.skin_px();
            if (distance < reach - 0.01f) {
                RC_ASSERT(listed.contains({a, b}));
            }
            within += distance <= reach + 0.01f;
        }
    }
    RC_ASSERT(listed.size() <= within);
}

RC_GTEST_PROP(NearPairs, FindEveryCircleNearAPlaceThoughAllHaveMovedSince, ()) {
    base::RandomStream random = scene_stream(*rc::gen::arbitrary<std::uint64_t>());
    Scene scene = some_scene(random);
    NearPairs near;
    base::InlineExecutor executor;
    near.renew(scene.circles, scene.boxes, scene.area, executor);
    const auto way = static_cast<double>(near.skin_px() / 2 / 1.5f);
    for (std::size_t i = 0; i < scene.circles.size(); ++i) {
        if (!scene.circles.is_void(i)) {
            scene.circles.x[i] += to_units(random.uniform(-way, way));
            scene.circles.y[i] += to_units(random.uniform(-way, way));
        }
    }
    near.circles_strayed(static_cast<float>(2 * way * way));
    for (int query = 0; query < 30; ++query) {
        const Coordinate x = to_units(random.uniform(-50, to_px(scene.area.width) + 50));
        const Coordinate y = to_units(random.uniform(-50, to_px(scene.area.height) + 50));
        const float radius = uniform_float(random, 0, 300);
        std::set<std::uint32_t> found;
        near.for_each_stretch_near(x, y, radius, [&](Strips::Stretch stretch) {
            const base::Range places = near.strips().places(stretch);
            for (std::size_t k = places.begin; k < places.end; ++k) {
                RC_ASSERT(found.insert(near.strips().order()[k]).second);
            }
        });
        for (std::uint32_t i = 0; i < scene.circles.size(); ++i) {
            const float dx = distance_px(x, scene.circles.x[i]), dy = distance_px(y, scene.circles.y[i]);
            if (!scene.circles.is_void(i) && dx * dx + dy * dy <= radius * radius) {
                RC_ASSERT(found.contains(i));
            }
        }
    }
}

TEST(NearPairs, AreWornWhenABodyHasMovedHalfTheSkinAndWhenThereAreOthers) {
    Scene scene;
    scene.add_circle(1000, 1000, 10, 1);
    scene.add_circle(1500, 1000, 10, 1);
    scene.add_box(3000, 1000, 10, 10, 1);
    NearPairs near;
    base::InlineExecutor executor;
    EXPECT_TRUE(near.worn(scene.circles, scene.boxes));
    const auto renew = [&] { near.renew(scene.circles, scene.boxes, scene.area, executor); };
    renew();
    EXPECT_FALSE(near.worn(scene.circles, scene.boxes));
    const float half = near.skin_px() / 2;
    near.circles_strayed((half - 0.02f) * (half - 0.02f));
    EXPECT_FALSE(near.worn(scene.circles, scene.boxes));
    near.circles_strayed(half * half);
    EXPECT_TRUE(near.worn(scene.circles, scene.boxes));
    renew();
    scene.boxes.x[0] += to_units(half);
    EXPECT_TRUE(near.worn(scene.circles, scene.boxes));
    renew();
    scene.add_circle(5000, 1000, 10, 1);
    EXPECT_TRUE(near.worn(scene.circles, scene.boxes));
    renew();
    near.forget();
    EXPECT_TRUE(near.worn(scene.circles, scene.boxes));
}

TEST(NearPairs, OfACrowdOnALargeIslandAreNotFarMoreThanTouch) {
    // An even spread would allow a skin with which each of a crowd has hundreds of neighbours.
    Scene scene;
    scene.area = {to_units(100'000.0), to_units(100'000.0)};
    base::RandomStream random = scene_stream(5);
    for (int i = 0; i < 5000; ++i) {
        scene.add_circle(random.uniform(50, 1800), random.uniform(50, 1800), 10, 1);
    }
    NearPairs near;
    base::InlineExecutor executor;
    near.renew(scene.circles, scene.boxes, scene.area, executor);
    std::size_t pairs = 0;
    for (std::size_t block = 0; block < block_count(scene.circles.size()); ++block) {
        pairs += near.circle_pairs(block).size();
    }
    EXPECT_LT(pairs, 6 * scene.circles.size());
}

} // namespace
} // namespace evod::physics
