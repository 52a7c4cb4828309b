#include "tests/unit/physics/test_bodies.h"

#include "server/physics/shapes.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>

namespace evod::physics {
namespace {

TEST(Impact, OfOneOnThreeKilogramsGivesTextbookVelocities) {
    // 1 kg at +10 into 3 kg at rest, e = 0.8: −3.5 and +4.5; kinetic energy 50 → 36.5.
    TestBodies setup;
    setup.add_circle(1000, 1000, 5, 1, 10);
    setup.add_circle(1009, 1000, 5, 3);
    setup.step();
    const float a = setup.circles.velocity_x[0], b = setup.circles.velocity_x[1];
    EXPECT_NEAR(a, -3.5f, 1e-5f);
    EXPECT_NEAR(b, 4.5f, 1e-5f);
    EXPECT_NEAR(0.5f * a * a + 0.5f * 3 * b * b, 36.5f, 1e-4f);
    EXPECT_EQ(setup.circles.velocity_y[0], 0);
    EXPECT_EQ(setup.circles.velocity_y[1], 0);
}

TEST(Impact, IsTheSameBetweenCratesAndBetweenCrateAndCircle) {
    TestBodies boxes;
    boxes.add_box(1000, 1000, 5, 5, 1, 10);
    boxes.add_box(1009, 1000, 5, 5, 1.0f / 3);
    boxes.step();
    EXPECT_NEAR(boxes.boxes.velocity_x[0], -3.5f, 1e-5f);
    EXPECT_NEAR(boxes.boxes.velocity_x[1], 4.5f, 1e-5f);

    TestBodies mixed;
    mixed.add_circle(1009, 1000, 5, 3);
    mixed.add_box(1000, 1000, 5, 5, 1, 10);
    mixed.step();
    EXPECT_NEAR(mixed.boxes.velocity_x[0], -3.5f, 1e-5f);
    EXPECT_NEAR(mixed.circles.velocity_x[0], 4.5f, 1e-5f);
}

TEST(Impact, OnAnObstacleMovesOnlyTheBodyByRestitution) {
    TestBodies setup;
    setup.add_circle(1000, 1000, 5, 1, 10);
    setup.add_box(1014, 1000, 10, 10, 0);
    const Coordinate obstacle_x = setup.boxes.x[0];
    setup.step();
    EXPECT_FLOAT_EQ(setup.circles.velocity_x[0], -8);
    EXPECT_EQ(setup.boxes.x[0], obstacle_x);
    EXPECT_EQ(setup.boxes.velocity_x[0], 0);
    EXPECT_LE(to_px(setup.circles.x[0]), 999) << "moved out of the obstacle, then back with −8 px/s";
}

TEST(Impact, GivesNoImpulseToSeparatingBodies) {
    TestBodies setup;
    setup.add_circle(1000, 1000, 5, 1, -2);
    setup.add_circle(1009, 1000, 5, 1, 3);
    setup.step();
    EXPECT_EQ(setup.circles.velocity_x[0], -2);
    EXPECT_EQ(setup.circles.velocity_x[1], 3);
}

TEST(Resolving, MovesApartInProportionToInverseMass) {
    TestBodies setup;
    setup.add_circle(1000, 1000, 5, 1);
    setup.add_circle(1006, 1000, 5, 3);
    Contacts contacts;
    base::InlineExecutor executor;
    contacts.find(setup.circles, setup.boxes, setup.area, executor);
    ASSERT_EQ(contacts.size(), 1u);
    contacts.resolve(setup.circles, setup.boxes, 0.8f, executor);
    EXPECT_EQ(setup.circles.x[0], to_units(997.0));
    EXPECT_EQ(setup.circles.x[1], to_units(1007.0));
}

TEST(Resolving, SeparatesCirclesAtEqualCentresAlongX) {
    TestBodies setup;
    setup.add_circle(1000, 1000, 5, 1);
    setup.add_circle(1000, 1000, 5, 1);
    setup.step();
    EXPECT_EQ(setup.circles.x[0], to_units(995.0));
    EXPECT_EQ(setup.circles.x[1], to_units(1005.0));
    EXPECT_EQ(setup.circles.y[0], to_units(1000.0));
}

TEST(Resolving, SeparatesCirclesAtEqualCentresById) {
    for (const bool lower_comes_from_the_right : {false, true}) {
        TestBodies setup;
        setup.parameters.restitution = 0;
        setup.add_circle(lower_comes_from_the_right ? 1040 : 960, 1000, 5, 1);
        setup.add_circle(lower_comes_from_the_right ? 960 : 1040, 1000, 5, 1);
        setup.step(); // lists the pair
        setup.circles.x[0] = setup.circles.x[1] = to_units(1000.0);
        setup.step();
        EXPECT_EQ(setup.circles.x[0], to_units(995.0));
        EXPECT_EQ(setup.circles.x[1], to_units(1005.0));
    }
}

TEST(Contacts, AreNotCountedBetweenRemovedCircles) {
    TestBodies setup;
    for (int i = 0; i < 8; ++i) {
        setup.add_circle(1000 + 3 * i, 1000, 5, 1);
    }
    NearPairs near;
    base::InlineExecutor executor;
    near.renew(setup.circles, setup.boxes, setup.area, executor);
    for (std::size_t i = 0; i < 8; ++i) {
        setup.circles.remove(i);
    }
    Contacts contacts;
    contacts.begin(setup.circles, setup.boxes);
    contacts.find_among_circles(setup.circles, near, 0);
    EXPECT_EQ(contacts.size(), 0u);
}

TEST(Resolving, OneGroupDoesNotInfluenceAnother) {
    // A pile of touching bodies moves bit for bit alike with and without a second pile far away, before or after it in
    // memory.
    const auto pile = [](TestBodies& setup, double x, std::uint64_t seed) {
        base::RandomStream random = test_stream(seed);
        for (int i = 0; i < 30; ++i) {
            setup.add_circle(x + random.uniform(0, 60), 1000 + random.uniform(0, 60), uniform_float(random, 3, 9),
                             uniform_float(random, 0.3, 2), uniform_float(random, -200, 200),
                             uniform_float(random, -200, 200));
        }
    };
    TestBodies alone, with_later, with_earlier;
    pile(alone, 2000, 7);
    pile(with_later, 2000, 7);
    pile(with_later, 9000, 8);
    pile(with_earlier, 9000, 8);
    pile(with_earlier, 2000, 7);
    for (int tick = 0; tick < 200; ++tick) {
        alone.step();
        with_later.step();
        with_earlier.step();
        for (std::size_t i = 0; i < 30; ++i) {
            ASSERT_EQ(alone.circles.x[i], with_later.circles.x[i]) << "tick " << tick << ", body " << i;
            ASSERT_EQ(alone.circles.velocity_y[i], with_later.circles.velocity_y[i]);
            ASSERT_EQ(alone.circles.x[i], with_earlier.circles.x[i + 30]) << "tick " << tick << ", body " << i;
            ASSERT_EQ(alone.circles.velocity_y[i], with_earlier.circles.velocity_y[i + 30]);
        }
    }
}

TEST(Wall, BouncesABodyThatTouchesItAndHeadsOutward) {
    TestBodies setup;
    setup.area = {to_units(100.0), to_units(100.0)};
    setup.add_circle(5, 50, 5, 1, -10, 3);
    setup.step();
    EXPECT_FLOAT_EQ(setup.circles.velocity_x[0], 8);
    EXPECT_FLOAT_EQ(setup.circles.velocity_y[0], 3);
}

TEST(Wall, PutsBodiesBackAndKeepsInwardVelocities) {
    TestBodies setup;
    setup.area = {to_units(100.0), to_units(100.0)};
    setup.add_circle(-30, 130, 5, 1, 6, -6);   // beyond two walls, moving in
    setup.add_circle(120, -7, 5, 1, 10, -10);  // beyond two walls, moving out
    setup.add_box(-50, 50, 10, 10, 0.25f, -4); // a crate
    setup.step();
    EXPECT_EQ(setup.circles.x[0], to_units(5.0));
    EXPECT_EQ(setup.circles.y[0], to_units(95.0));
    EXPECT_FLOAT_EQ(setup.circles.velocity_x[0], 6);
    EXPECT_FLOAT_EQ(setup.circles.velocity_y[0], -6);
    EXPECT_EQ(setup.circles.x[1], to_units(95.0));
    EXPECT_EQ(setup.circles.y[1], to_units(5.0));
    EXPECT_FLOAT_EQ(setup.circles.velocity_x[1], -8);
    EXPECT_FLOAT_EQ(setup.circles.velocity_y[1], 8);
    EXPECT_EQ(setup.boxes.x[0], to_units(10.0));
    EXPECT_FLOAT_EQ(setup.boxes.velocity_x[0], 3.2f);
}

TEST(Wall, BouncesABodyInTheTickInWhichItArrives) {
    TestBodies setup;
    setup.area = {to_units(100.0), to_units(100.0)};
    setup.add_circle(94.9, 50, 5, 1, 60);
    setup.step();
    EXPECT_EQ(setup.circles.x[0], to_units(95.0));
    EXPECT_FLOAT_EQ(setup.circles.velocity_x[0], -48);
}

/// The touching pairs, by testing all pairs.
std::size_t all_touching_pairs(const Circles& circles, const Boxes& boxes) {
    std::size_t count = 0;
    for (std::size_t a = 0; a < circles.size(); ++a) {
        for (std::size_t b = a + 1; b < circles.size(); ++b) {
            count += circle_circle(distance_px(circles.x[a], circles.x[b]), distance_px(circles.y[a], circles.y[b]),
                                   circles.radius[a], circles.radius[b])
                         .touching;
        }
        for (std::size_t b = 0; b < boxes.size(); ++b) {
            count += box_circle(distance_px(boxes.x[b], circles.x[a]), distance_px(boxes.y[b], circles.y[a]),
                                {boxes.half_width[b], boxes.half_height[b]}, circles.radius[a])
                         .touching;
        }
    }
    for (std::size_t a = 0; a < boxes.size(); ++a) {
        for (std::size_t b = a + 1; b < boxes.size(); ++b) {
            count += boxes.inverse_mass[a] + boxes.inverse_mass[b] > 0 &&
                     box_box(distance_px(boxes.x[a], boxes.x[b]), distance_px(boxes.y[a], boxes.y[b]),
                             {boxes.half_width[a], boxes.half_height[a]}, {boxes.half_width[b], boxes.half_height[b]})
                         .touching;
        }
    }
    return count;
}

// Every pair found has been tested for touching, so the sets are equal if the counts are. A pair found twice instead of
// another would have to occur in every random setup.
RC_GTEST_PROP(BroadPhase, FindsTheSamePairsAsTestingAll, ()) {
    TestBodies setup;
    const int width = *rc::gen::inRange(100, 1500), height = *rc::gen::inRange(100, 1500);
    setup.area = {to_units(static_cast<double>(width)), to_units(static_cast<double>(height))};
    base::RandomStream random = test_stream(*rc::gen::arbitrary<std::uint64_t>());
    const bool on_whole_px = *rc::gen::arbitrary<bool>(); // many exact touches
    const auto place = [&](double size) {                 // includes bodies beyond a wall
        const double at = random.uniform(-40, size + 40);
        return on_whole_px ? std::floor(at) : at;
    };
    const double radius_max = random.uniform(1, 40);
    const int circles = *rc::gen::inRange(0, 150), boxes = *rc::gen::inRange(0, 20);
    for (int i = 0; i < circles; ++i) {
        const double x = place(width);
        setup.add_circle(x, place(height),
                         on_whole_px ? 1 + std::floor(uniform_float(random, 0, radius_max))
                                     : uniform_float(random, 0.1, radius_max),
                         1);
    }
    for (int i = 0; i < boxes; ++i) {
        const double x = place(width);
        const double y = place(height);
        const float half = on_whole_px ? 8 : uniform_float(random, 1, 100);
        setup.add_box(x, y, half, on_whole_px ? 16 : uniform_float(random, 1, 100), random.chance(0.5) ? 0.0f : 1.0f);
    }
    Contacts contacts;
    base::InlineExecutor executor;
    contacts.find(setup.circles, setup.boxes, setup.area, executor);
    RC_ASSERT(contacts.size() == all_touching_pairs(setup.circles, setup.boxes));
}

RC_GTEST_PROP(BroadPhase, FindsTouchingBoxesOfFractionalSizes, ()) {
    TestBodies setup;
    const auto part = [] { return static_cast<float>(*rc::gen::inRange(1, 64)) / (8 * units_per_px); };
    const float a = 15 + part(), b = 15 + part();
    setup.add_box(1000, 1000, a, a, 1);
    const auto reach = static_cast<Coordinate>(std::floor((a + b) * units_per_px)); // just touching
    setup.boxes.add(setup.boxes.x[0] + reach, setup.boxes.y[0], b, b, 1);
    Contacts contacts;
    base::InlineExecutor executor;
    contacts.find(setup.circles, setup.boxes, setup.area, executor);
    RC_ASSERT(contacts.size() == all_touching_pairs(setup.circles, setup.boxes));
}

} // namespace
} // namespace evod::physics
