#include "tests/unit/physics/test_bodies.h"

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

Totals totals(const TestBodies& setup) {
    Totals sum;
    add_totals(setup.circles, sum);
    add_totals(setup.boxes, sum);
    return sum;
}

/// Circles and crates at random places in a square that is `share` of its area; also obstacles.
TestBodies crowd(double side, double share, int crates, int obstacles, double speed, std::uint64_t seed) {
    TestBodies setup;
    setup.area = {to_units(side), to_units(side)};
    base::RandomStream random = test_stream(seed);
    const auto place = [&] { return random.uniform(12, side - 12); };
    const auto velocity = [&] { return uniform_float(random, -speed, speed); };
    double covered = 0;
    while (covered < share * side * side) {
        const float radius = uniform_float(random, 4, 12);
        covered += 3.14159 * static_cast<double>(radius * radius);
        const double x = place(), y = place();
        const float vx = velocity(), vy = velocity();
        setup.add_circle(x, y, radius, uniform_float(random, 0.4, 2), vx, vy);
    }
    for (int i = 0; i < crates + obstacles; ++i) {
        const double x = place(), y = place();
        const float vx = i < crates ? velocity() : 0, vy = i < crates ? velocity() : 0;
        setup.add_box(x, y, 10, 8, i < crates ? uniform_float(random, 0.1, 2) : 0, vx, vy);
    }
    return setup;
}

TEST(Collisions, ConserveMomentumAndNeverAddKineticEnergy) {
    TestBodies setup = crowd(600, 0.25, 10, 0, 300, 11);
    std::uint64_t contacts = 0;
    for (int tick = 0; tick < 400; ++tick) {
        // Without walls, momentum is conserved. Positions move as in a step.
        Contacts found;
        base::InlineExecutor executor;
        found.find(setup.circles, setup.boxes, setup.area, executor);
        contacts += found.size();
        const Totals before = totals(setup);
        found.resolve(setup.circles, setup.boxes, 0.8f, executor);
        const Totals after = totals(setup);
        // A float has 24 bits: an impulse rounds a velocity by a share of 6e-8.
        ASSERT_NEAR(after.momentum_x, before.momentum_x, before.momentum_size * 1e-6) << "tick " << tick;
        ASSERT_NEAR(after.momentum_y, before.momentum_y, before.momentum_size * 1e-6) << "tick " << tick;
        ASSERT_LE(after.energy, before.energy * (1 + 1e-6)) << "tick " << tick;
        setup.step();
    }
    EXPECT_GT(contacts, 5000u) << "thousands of collisions were seen";
}

TEST(Collisions, WithRestitutionOneKeepTheKineticEnergy) {
    base::RandomStream random = test_stream(12);
    for (int trial = 0; trial < 3000; ++trial) {
        TestBodies setup;
        setup.parameters.restitution = 1;
        setup.add_circle(1000, 1000, 10, uniform_float(random, 0.1, 5), uniform_float(random, -99, 99),
                         uniform_float(random, -99, 99));
        setup.add_circle(1000 + random.uniform(-14, 14), 1000 + random.uniform(-14, 14), 10,
                         uniform_float(random, 0.1, 5), uniform_float(random, -99, 99), uniform_float(random, -99, 99));
        const Totals before = totals(setup);
        setup.step();
        ASSERT_NEAR(totals(setup).energy, before.energy, before.energy * 1e-5);
    }
}

TEST(Step, NeverGainsKineticEnergyInACrowd) {
    TestBodies setup = crowd(500, 0.3, 8, 8, 400, 13);
    double before = totals(setup).energy;
    for (int tick = 0; tick < 2000; ++tick) {
        setup.step();
        const double now = totals(setup).energy;
        ASSERT_LE(now, before * (1 + 1e-6)) << "tick " << tick;
        before = now;
    }
    EXPECT_LT(before, totals(crowd(500, 0.3, 8, 8, 400, 13)).energy / 10);
}

class DenseCrowd : public testing::TestWithParam<Integrator> {};

TEST_P(DenseCrowd, StaysInsideTheWallsAtHighSpeeds) {
    TestBodies setup = crowd(400, 0.5, 6, 6, 3000, 14);
    setup.parameters.integration = integration(GetParam(), 1.0 / 60, damping_rate(0.999));
    setup.parameters.max_speed_px_s = 6000;
    base::RandomStream random = test_stream(15);
    for (int tick = 0; tick < 1000; ++tick) {
        for (std::size_t i = 0; i < setup.circles.size(); ++i) {
            const float x = uniform_float(random, -1e5, 1e5);
            setup.push(i, x, uniform_float(random, -1e5, 1e5));
        }
        setup.step();
        for (std::size_t i = 0; i < setup.circles.size(); ++i) {
            const Coordinate radius = to_units(setup.circles.radius[i]);
            ASSERT_GE(setup.circles.x[i], radius) << "tick " << tick;
            ASSERT_LE(setup.circles.x[i], setup.area.width - radius) << "tick " << tick;
            ASSERT_GE(setup.circles.y[i], radius) << "tick " << tick;
            ASSERT_LE(setup.circles.y[i], setup.area.height - radius) << "tick " << tick;
        }
        for (std::size_t i = 0; i < setup.boxes.size(); ++i) {
            ASSERT_GE(setup.boxes.x[i], to_units(10.0f)) << "tick " << tick;
            ASSERT_LE(setup.boxes.x[i], setup.area.width - to_units(10.0f)) << "tick " << tick;
        }
    }
}

INSTANTIATE_TEST_SUITE_P(All, DenseCrowd,
                         testing::Values(Integrator::SymplecticEuler, Integrator::ExplicitEuler,
                                         Integrator::BackwardEuler),
                         testing::PrintToStringParamName());

TEST(Step, LimitsSpeedsAndCountsEachTime) {
    TestBodies setup;
    setup.parameters.max_speed_px_s = 600;
    setup.add_circle(1000, 1000, 50, 1, 600, 800);
    setup.add_circle(2000, 1000, 50, 1, 600, 0); // exactly the limit
    setup.add_box(3000, 1000, 50, 50, 1, 0, -900);
    setup.step();
    EXPECT_EQ(setup.counts.speed_limited, 2u);
    EXPECT_NEAR(setup.circles.velocity_x[0], 360, 1e-3);
    EXPECT_NEAR(setup.circles.velocity_y[0], 480, 1e-3);
    EXPECT_EQ(setup.circles.velocity_x[1], 600);
    EXPECT_NEAR(setup.boxes.velocity_y[0], -600, 1e-3);
    EXPECT_EQ(setup.circles.x[0], to_units(1006.0));
}

TEST(Step, LimitsSpeedsAfterTheImpulsesOfCollisions) {
    TestBodies setup;
    setup.parameters.max_speed_px_s = 600;
    setup.parameters.restitution = 1;
    setup.add_circle(1000, 1000, 50, 0.1f);
    setup.add_circle(1099, 1000, 50, 10, -600, 0); // accelerates the light body to nearly 1,200 px/s
    setup.step();
    EXPECT_NEAR(setup.circles.velocity_x[0], -600, 1e-3);
    EXPECT_EQ(setup.counts.speed_limited, 1u);
}

TEST(Step, CountsBodiesThatMoveMoreThanTheirRadius) {
    TestBodies setup;
    setup.add_circle(1000, 1000, 5, 1, 299);
    setup.add_circle(2000, 1000, 5, 1, 301);
    setup.add_box(3000, 1000, 5, 20, 1, 0, 301); // the least half side
    setup.step();
    EXPECT_EQ(setup.counts.too_fast, 2u);
}

TEST(Step, LetsForcesActForOneTick) {
    TestBodies setup;
    setup.add_circle(1000, 1000, 5, 1);
    setup.push(0, 60, 0);
    setup.step();
    setup.step();
    EXPECT_FLOAT_EQ(setup.circles.velocity_x[0], 1);
}

TEST(Step, NeverMovesAnObstacle) {
    TestBodies setup = crowd(300, 0.4, 0, 5, 500, 16);
    const auto x = setup.boxes.x, y = setup.boxes.y;
    for (int tick = 0; tick < 300; ++tick) {
        setup.step();
    }
    EXPECT_EQ(setup.boxes.x, x);
    EXPECT_EQ(setup.boxes.y, y);
}

class AnywhereOnALargeIsland : public testing::TestWithParam<Integrator> {};

TEST_P(AnywhereOnALargeIsland, TheSameBodiesMoveAlikeBitForBit) {
    // Away from the walls; shifted by whole position units that are not a multiple of a cell.
    const Coordinate shift_x = to_units(295'000.0) - 1'277, shift_y = to_units(294'500.0) - 91;
    TestBodies near = crowd(400, 0.3, 6, 6, 300, 17);
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
    TestBodies far = near;
    for (std::size_t i = 0; i < far.circles.size(); ++i) {
        far.circles.x[i] += shift_x;
        far.circles.y[i] += shift_y;
    }
    for (std::size_t i = 0; i < far.boxes.size(); ++i) {
        far.boxes.x[i] += shift_x;
        far.boxes.y[i] += shift_y;
    }
    base::RandomStream random = test_stream(18);
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
