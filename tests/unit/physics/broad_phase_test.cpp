#include "server/physics/broad_phase.h"

#include "server/jobs/thread_pool.h"
#include "tests/unit/physics/test_bodies.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <set>
#include <utility>

namespace evod::physics {
namespace {

/// Circles in a cluster, spread out, or on a line; some void, some beyond the walls.
TestBodies some_scene(base::RandomStream& random) {
    TestBodies setup;
    const double width = random.uniform(50, 20'000), height = random.chance(0.3) ? random.uniform(50, 200) : width;
    setup.area = {to_units(width), to_units(height)};
    const double spread = random.chance(0.5) ? 1 : random.uniform(0.01, 0.2);
    const std::uint32_t count = random.below(1500);
    for (std::uint32_t i = 0; i < count; ++i) {
        const double x = random.uniform(-30, width * spread + 30);
        setup.add_circle(x, random.uniform(-30, height * spread + 30), uniform_float(random, 0.5, 20), 1);
    }
    for (std::uint32_t i = 0; i < count / 10; ++i) {
        setup.circles.remove(random.below(count));
    }
    return setup;
}

RC_GTEST_PROP(Strips, ContainEveryCircleExceptVoidOnesInOrder, ()) {
    base::RandomStream random = test_stream(*rc::gen::arbitrary<std::uint64_t>());
    const TestBodies setup = some_scene(random);
    Strips one, many;
    base::InlineExecutor executor;
    jobs::ThreadPool threads{3};
    const float reach = uniform_float(random, 1, 200);
    one.sort(setup.circles, setup.area, reach, executor);
    many.sort(setup.circles, setup.area, reach, threads);
    RC_ASSERT(std::equal(one.order().begin(), one.order().end(), many.order().begin(), many.order().end()));
    std::set<std::uint32_t> seen;
    for (std::uint32_t strip = 0; strip < one.strip_count(); ++strip) {
        const base::Range places = one.strip(strip);
        for (std::size_t k = places.begin; k < places.end; ++k) {
            const std::uint32_t i = one.order()[k];
            seen.insert(i);
            RC_ASSERT(one.strip_at(setup.circles.y[i]) == strip);
            RC_ASSERT(one.strip_of_place(k) == strip);
            if (k > places.begin) {
                const std::uint32_t before = one.order()[k - 1];
                RC_ASSERT(std::pair(setup.circles.x[before], setup.circles.id[before]) <
                          std::pair(setup.circles.x[i], setup.circles.id[i]));
            }
        }
    }
    std::size_t there = 0;
    for (std::size_t i = 0; i < setup.circles.size(); ++i) {
        there += !setup.circles.is_void(i);
    }
    RC_ASSERT(seen.size() == there);
    RC_ASSERT(one.order().size() == there);
}

RC_GTEST_PROP(NearPairs, ListEachPairWithinTheSkinExactlyOnce, ()) {
    base::RandomStream random = test_stream(*rc::gen::arbitrary<std::uint64_t>());
    const TestBodies setup = some_scene(random);
    NearPairs near;
    base::InlineExecutor executor;
    near.renew(setup.circles, setup.boxes, setup.area, executor);
    std::set<std::pair<std::uint32_t, std::uint32_t>> listed;
    for (std::size_t block = 0; block < block_count(setup.circles.size()); ++block) {
        for (const NearPairs::Pair& pair : near.circle_pairs(block)) {
            RC_ASSERT(listed.insert({std::min(pair.a, pair.b), std::max(pair.a, pair.b)}).second);
        }
    }
    std::size_t within = 0;
    const Circles& circles = setup.circles;
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

RC_GTEST_PROP(NearPairs, FindEveryCircleNearAPlaceAfterMovement, ()) {
    base::RandomStream random = test_stream(*rc::gen::arbitrary<std::uint64_t>());
    TestBodies setup = some_scene(random);
    NearPairs near;
    base::InlineExecutor executor;
    near.renew(setup.circles, setup.boxes, setup.area, executor);
    const auto way = static_cast<double>(near.skin_px() / 2 / 1.5f);
    for (std::size_t i = 0; i < setup.circles.size(); ++i) {
        if (!setup.circles.is_void(i)) {
            setup.circles.x[i] += to_units(random.uniform(-way, way));
            setup.circles.y[i] += to_units(random.uniform(-way, way));
        }
    }
    near.set_displacement_square(static_cast<float>(2 * way * way));
    for (int query = 0; query < 30; ++query) {
        const Coordinate x = to_units(random.uniform(-50, to_px(setup.area.width) + 50));
        const Coordinate y = to_units(random.uniform(-50, to_px(setup.area.height) + 50));
        const float radius = uniform_float(random, 0, 300);
        std::set<std::uint32_t> found;
        near.for_each_stretch_near(x, y, radius, [&](Strips::Stretch stretch) {
            const base::Range places = near.strips().places(stretch);
            for (std::size_t k = places.begin; k < places.end; ++k) {
                RC_ASSERT(found.insert(near.strips().order()[k]).second);
            }
        });
        for (std::uint32_t i = 0; i < setup.circles.size(); ++i) {
            const float dx = distance_px(x, setup.circles.x[i]), dy = distance_px(y, setup.circles.y[i]);
            if (!setup.circles.is_void(i) && dx * dx + dy * dy <= radius * radius) {
                RC_ASSERT(found.contains(i));
            }
        }
    }
}

TEST(NearPairs, AreStaleAfterHalfTheSkinOrWithOtherBodies) {
    TestBodies setup;
    setup.add_circle(1000, 1000, 10, 1);
    setup.add_circle(1500, 1000, 10, 1);
    setup.add_box(3000, 1000, 10, 10, 1);
    NearPairs near;
    base::InlineExecutor executor;
    EXPECT_TRUE(near.stale(setup.circles, setup.boxes));
    const auto renew = [&] { near.renew(setup.circles, setup.boxes, setup.area, executor); };
    renew();
    EXPECT_FALSE(near.stale(setup.circles, setup.boxes));
    const float half = near.skin_px() / 2;
    near.set_displacement_square((half - 0.02f) * (half - 0.02f));
    EXPECT_FALSE(near.stale(setup.circles, setup.boxes));
    near.set_displacement_square(half * half);
    EXPECT_TRUE(near.stale(setup.circles, setup.boxes));
    renew();
    setup.boxes.x[0] += to_units(half);
    EXPECT_TRUE(near.stale(setup.circles, setup.boxes));
    renew();
    setup.add_circle(5000, 1000, 10, 1);
    EXPECT_TRUE(near.stale(setup.circles, setup.boxes));
    renew();
    near.invalidate();
    EXPECT_TRUE(near.stale(setup.circles, setup.boxes));
}

TEST(NearPairs, OfACrowdAreNotManyMoreThanTouchingPairs) {
    // With an even distribution, this skin would be thick enough for hundreds of neighbours per body of the crowd.
    TestBodies setup;
    setup.area = {to_units(100'000.0), to_units(100'000.0)};
    base::RandomStream random = test_stream(5);
    for (int i = 0; i < 5000; ++i) {
        setup.add_circle(random.uniform(50, 1800), random.uniform(50, 1800), 10, 1);
    }
    NearPairs near;
    base::InlineExecutor executor;
    near.renew(setup.circles, setup.boxes, setup.area, executor);
    std::size_t pairs = 0;
    for (std::size_t block = 0; block < block_count(setup.circles.size()); ++block) {
        pairs += near.circle_pairs(block).size();
    }
    EXPECT_LT(pairs, 6 * setup.circles.size());
}

} // namespace
} // namespace evod::physics
