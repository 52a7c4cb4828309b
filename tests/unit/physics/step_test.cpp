#include "tests/unit/physics/scene.h"

#include <gtest/gtest.h>

#include <cmath>

namespace evod::physics {
namespace {

struct Totals {
    double momentum_x = 0, momentum_y = 0, energy = 0, momentum_size = 0;
};

void add_totals(const Bodies& bodies, Totals& totals) {
    for (std::size_t i = 0; i < bodies.x.size(); ++i) {
        if (bodies.inverse_mass[i] == 0) {
            continue;
        }
        const double mass = 1 / static_cast<double>(bodies.inverse_mass[i]);
        const double vx = static_cast<double>(bodies.velocity_x[i]), vy = static_cast<double>(bodies.velocity_y[i]);
        totals.momentum_x += mass * vx;
        totals.momentum_y += mass * vy;
        totals.energy += mass * (vx * vx + vy * vy) / 2;
        totals.momentum_size += mass * std::sqrt(vx * vx + vy * vy);
    }
}

Totals totals(const Scene& scene) {
    Totals sum;
    add_totals(scene.circles, sum);
    add_totals(scene.boxes, sum);
    return sum;
}

/// Circles and crates at random in a square, as far as `share` of its area; obstacles too.
Scene crowd(double side, double share, int crates, int obstacles, double speed, std::uint64_t seed) {
    Scene scene;
    scene.area = {to_units(side), to_units(side)};
    base::RandomStream random = scene_stream(seed);
    const auto place = [&] { return random.uniform(12, side - 12); };
    const auto velocity = [&] { return uniform_float(random, -speed, speed); };
    double covered = 0;
    while (covered < share * side * side) {
        const float radius = uniform_float(random, 4, 12);
        covered += 3.14159 * static_cast<double>(radius * radius);
        const double x = place(), y = place();
        const float vx = velocity(), vy = velocity();
        scene.add_circle(x, y, radius, uniform_float(random, 0.4, 2), vx, vy);
    }
    for (int i = 0; i < crates + obstacles; ++i) {
        const double x = place(), y = place();
        const float vx = i < crates ? velocity() : 0, vy = i < crates ? velocity() : 0;
        scene.add_box(x, y, 10, 8, i < crates ? uniform_float(random, 0.1, 2) : 0, vx, vy);
    }
    return scene;
}

TEST(Collisions, ConserveMomentumAndNeverAddKineticEnergy) {
    Scene scene = crowd(600, 0.25, 10, 0, 300, 11);
    std::uint64_t contacts = 0;
    for (int tick = 0; tick < 400; ++tick) {
        // Without the walls: momentum goes nowhere else. Positions move as they do in a step.
        Contacts found;
        base::InlineExecutor executor;
        found.find(scene.circles, scene.boxes, scene.area, executor);
        contacts += found.size();
        const Totals before = totals(scene);
        found.resolve(scene.circles, scene.boxes, 0.8f, executor);
        const Totals after = totals(scene);
        // A float has 24 bits: an impulse rounds a velocity by 6e-8 of it.
        ASSERT_NEAR(after.momentum_x, before.momentum_x, before.momentum_size * 1e-6) << "tick " << tick;
        ASSERT_NEAR(after.momentum_y, before.momentum_y, before.momentum_size * 1e-6) << "tick " << tick;
        ASSERT_LE(after.energy, before.energy * (1 + 1e-6)) << "tick " << tick;
        scene.step();
    }
    EXPECT_GT(contacts, 5000u) << "thousands of collisions were seen";
}

TEST(Collisions, OfPerfectRestitutionKeepTheKineticEnergyOfAPair) {
    base::RandomStream random = scene_stream(12);
    for (int trial = 0; trial < 3000; ++trial) {
        Scene scene;
        scene.parameters.restitution = 1;
        scene.add_circle(1000, 1000, 10, uniform_float(random, 0.1, 5), uniform_float(random, -99, 99),
                         uniform_float(random, -99, 99));
        scene.add_circle(1000 + random.uniform(-14, 14), 1000 + random.uniform(-14, 14), 10,
                         uniform_float(random, 0.1, 5), uniform_float(random, -99, 99), uniform_float(random, -99, 99));
        const Totals before = totals(scene);
        scene.step();
        ASSERT_NEAR(totals(scene).energy, before.energy, before.energy * 1e-5);
    }
}

TEST(Step, LosesKineticEnergyTickByTickInACrowdAmongWallsAndObstacles) {
    Scene scene = crowd(500, 0.3, 8, 8, 400, 13);
    double before = totals(scene).energy;
    for (int tick = 0; tick < 2000; ++tick) {
        scene.step();
        const double now = totals(scene).energy;
        ASSERT_LE(now, before * (1 + 1e-6)) << "tick " << tick;
        before = now;
    }
    EXPECT_LT(before, totals(crowd(500, 0.3, 8, 8, 400, 13)).energy / 10);
}

class DenseCrowd : public testing::TestWithParam<Integrator> {};

TEST_P(DenseCrowd, StaysInsideTheWallsAtHighSpeeds) {
    Scene scene = crowd(400, 0.5, 6, 6, 3000, 14);
    scene.parameters.integration = integration(GetParam(), 1.0 / 60, damping_rate(0.999));
    scene.parameters.max_speed_px_s = 6000;
    base::RandomStream random = scene_stream(15);
    for (int tick = 0; tick < 1000; ++tick) {
        for (std::size_t i = 0; i < scene.circles.size(); ++i) {
            const float x = uniform_float(random, -1e5, 1e5);
            scene.push(i, x, uniform_float(random, -1e5, 1e5));
        }
        scene.step();
        for (std::size_t i = 0; i < scene.circles.size(); ++i) {
            const Coordinate radius = to_units(scene.circles.radius[i]);
            ASSERT_GE(scene.circles.x[i], radius) << "tick " << tick;
            ASSERT_LE(scene.circles.x[i], scene.area.width - radius) << "tick " << tick;
            ASSERT_GE(scene.circles.y[i], radius) << "tick " << tick;
            ASSERT_LE(scene.circles.y[i], scene.area.height - radius) << "tick " << tick;
        }
        for (std::size_t i = 0; i < scene.boxes.size(); ++i) {
            ASSERT_GE(scene.boxes.x[i], to_units(10.0f)) << "tick " << tick;
            ASSERT_LE(scene.boxes.x[i], scene.area.width - to_units(10.0f)) << "tick " << tick;
        }
    }
}

INSTANTIATE_TEST_SUITE_P(All, DenseCrowd,
                         testing::Values(Integrator::SymplecticEuler, Integrator::ExplicitEuler,
                                         Integrator::BackwardEuler),
                         testing::PrintToStringParamName());

TEST(Step, CutsSpeedsToTheGreatestAllowedAndCountsEachTime) {
    Scene scene;
    scene.parameters.max_speed_px_s = 600;
    scene.add_circle(1000, 1000, 50, 1, 600, 800);
    scene.add_circle(2000, 1000, 50, 1, 600, 0); // just allowed
    scene.add_box(3000, 1000, 50, 50, 1, 0, -900);
    scene.step();
    EXPECT_EQ(scene.counts.speed_limited, 2u);
    EXPECT_NEAR(scene.circles.velocity_x[0], 360, 1e-3);
    EXPECT_NEAR(scene.circles.velocity_y[0], 480, 1e-3);
    EXPECT_EQ(scene.circles.velocity_x[1], 600);
    EXPECT_NEAR(scene.boxes.velocity_y[0], -600, 1e-3);
    EXPECT_EQ(scene.circles.x[0], to_units(1006.0));
}

TEST(Step, LimitsSpeedsAfterTheImpulsesOfCollisions) {
    Scene scene;
    scene.parameters.max_speed_px_s = 600;
    scene.parameters.restitution = 1;
    scene.add_circle(1000, 1000, 50, 0.1f);
    scene.add_circle(1099, 1000, 50, 10, -600, 0); // throws the light one with nearly 1,200 px/s
    scene.step();
    EXPECT_NEAR(scene.circles.velocity_x[0], -600, 1e-3);
    EXPECT_EQ(scene.counts.speed_limited, 1u);
}

TEST(Step, CountsBodiesThatMoveMoreThanTheirRadius) {
    Scene scene;
    scene.add_circle(1000, 1000, 5, 1, 299);
    scene.add_circle(2000, 1000, 5, 1, 301);
    scene.add_box(3000, 1000, 5, 20, 1, 0, 301); // the least half side
    scene.step();
    EXPECT_EQ(scene.counts.too_fast, 2u);
}

TEST(Step, LetsForcesActForOneTick) {
    Scene scene;
    scene.add_circle(1000, 1000, 5, 1);
    scene.push(0, 60, 0);
    scene.step();
    scene.step();
    EXPECT_FLOAT_EQ(scene.circles.velocity_x[0], 1);
}

TEST(Step, NeverMovesAnObstacle) {
    Scene scene = crowd(300, 0.4, 0, 5, 500, 16);
    const auto x = scene.boxes.x, y = scene.boxes.y;
    for (int tick = 0; tick < 300; ++tick) {
        scene.step();
    }
    EXPECT_EQ(scene.boxes.x, x);
    EXPECT_EQ(scene.boxes.y, y);
}

class AnywhereOnALargeIsland : public testing::TestWithParam<Integrator> {};

TEST_P(AnywhereOnALargeIsland, TheSameSceneMovesBitForBitAlike) {
    // Away from the walls; shifted by whole position units, and by no multiple of a cell.
    const Coordinate shift_x = to_units(295'000.0) - 1'277, shift_y = to_units(294'500.0) - 91;
    Scene near = crowd(400, 0.3, 6, 6, 300, 17);
    near.area = {to_units(300'000.0), to_units(300'000.0)};
    near.parameters.integration = integration(GetParam(), 1.0 / 60, damping_rate(0.999));
    for (Coordinate& x : near.circles.x) {
        x += to_units(2'000.0);
    }
    for (Coordinate& y : near.circles.y) {
        y += to_units(2'000.0);
    }
    for (Coordinate& x : near.boxes.x) {
        x += to_units(2'000.0);
    }
    for (Coordinate& y : near.boxes.y) {
        y += to_units(2'000.0);
    }
    Scene far = near;
    for (std::size_t i = 0; i < far.circles.size(); ++i) {
        far.circles.x[i] += shift_x;
        far.circles.y[i] += shift_y;
    }
    for (std::size_t i = 0; i < far.boxes.size(); ++i) {
        far.boxes.x[i] += shift_x;
        far.boxes.y[i] += shift_y;
    }
    base::RandomStream random = scene_stream(18);
    for (int tick = 0; tick < 120; ++tick) {
        for (std::size_t i = 0; i < near.circles.size(); ++i) {
            const float x = uniform_float(random, -300, 300), y = uniform_float(random, -300, 300);
            near.push(i, x, y);
            far.push(i, x, y);
        }
        near.step();
        far.step();
        for (std::size_t i = 0; i < near.circles.size(); ++i) {
            ASSERT_EQ(far.circles.x[i] - near.circles.x[i], shift_x) << "tick " << tick << ", body " << i;
            ASSERT_EQ(far.circles.y[i] - near.circles.y[i], shift_y) << "tick " << tick << ", body " << i;
            ASSERT_EQ(far.circles.velocity_x[i], near.circles.velocity_x[i]) << "tick " << tick << ", body " << i;
            ASSERT_EQ(far.circles.velocity_y[i], near.circles.velocity_y[i]) << "tick " << tick << ", body " << i;
        }
        for (std::size_t i = 0; i < near.boxes.size(); ++i) {
            ASSERT_EQ(far.boxes.x[i] - near.boxes.x[i], shift_x);
        }
    }
}

INSTANTIATE_TEST_SUITE_P(All, AnywhereOnALargeIsland,
                         testing::Values(Integrator::SymplecticEuler, Integrator::ExplicitEuler,
                                         Integrator::BackwardEuler),
                         testing::PrintToStringParamName());

} // namespace
} // namespace evod::physics
