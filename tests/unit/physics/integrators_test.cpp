#include "tests/unit/physics/test_bodies.h"

#include "server/base/elementary.h"

#include <gtest/gtest.h>

#include <cmath>

namespace evod::physics {
namespace {

TEST(BackwardEuler, AppliesDampingImplicitly) {
    // v' = (v + a·dt)/(1 + c·dt), x' = x + v'·dt, computed in double; 120 ticks of rounding to 1/4096 px and to float.
    constexpr double rate = 1.7, tick_s = 0.02, acceleration = 500;
    TestBodies setup;
    setup.parameters.integration = integration(Integrator::BackwardEuler, tick_s, rate);
    setup.add_circle(100'000, 100'000, 5, 1, 300);
    double velocity = 300, way = 0;
    for (int tick = 0; tick < 120; ++tick) {
        setup.push(0, static_cast<float>(acceleration), 0);
        setup.step();
        velocity = (velocity + acceleration * tick_s) / (1 + rate * tick_s);
        way += velocity * tick_s;
        ASSERT_NEAR(static_cast<double>(setup.circles.velocity_x[0]), velocity, 1e-2);
        ASSERT_NEAR(to_px(setup.circles.x[0]) - 100'000, way, 0.05) << "after tick " << tick;
    }
}

TEST(ExplicitEuler, MovesByTheOldVelocityPlusImpulses) {
    TestBodies setup;
    setup.parameters.integration = integration(Integrator::ExplicitEuler, 0.1, 0);
    setup.parameters.restitution = 1;
    setup.add_circle(1000, 1000, 5, 1, 10);
    setup.add_circle(1010, 1000, 5, 1); // touching, with depth 0
    setup.push(0, 50, 0);               // 5 px/s in the tick
    setup.step();
    // The bodies approach each other at 15 px/s and exchange velocities: impulses of −15 and +15.
    EXPECT_FLOAT_EQ(setup.circles.velocity_x[0], 0);
    EXPECT_FLOAT_EQ(setup.circles.velocity_x[1], 15);
    EXPECT_EQ(setup.circles.x[0], to_units(1000 + (10 - 15) * 0.1));
    EXPECT_EQ(setup.circles.x[1], to_units(1010 + 15 * 0.1));
}

TEST(ExplicitEuler, MovesByTheOldVelocityAtTheSpeedLimitToo) {
    TestBodies setup;
    setup.parameters.integration = integration(Integrator::ExplicitEuler, 0.1, 0);
    setup.parameters.max_speed_px_s = 600;
    setup.add_circle(1000, 1000, 5, 1, 600);
    setup.push(0, 1000, 0); // 100 px/s in the tick, then limited again
    setup.step();
    EXPECT_FLOAT_EQ(setup.circles.velocity_x[0], 600);
    EXPECT_EQ(setup.circles.x[0], to_units(1060.0));
    EXPECT_EQ(setup.counts.speed_limited, 1u);
}

class AnyIntegrator : public testing::TestWithParam<Integrator> {};

TEST_P(AnyIntegrator, NeverMovesABodyFasterThanTheSpeedLimit) {
    TestBodies setup;
    setup.area = {to_units(500'000.0), to_units(500'000.0)};
    setup.parameters.integration = integration(GetParam(), 1, 0);
    setup.parameters.max_speed_px_s = 5000;
    setup.add_circle(250'000, 250'000, 5, 0.0001f);
    for (int tick = 0; tick < 20; ++tick) {
        const Coordinate before = setup.circles.x[0];
        setup.push(0, tick % 2 == 0 ? 1e7f : -1e7f, 0);
        setup.step();
        ASSERT_LE(std::abs(to_px(setup.circles.x[0]) - to_px(before)), 5001);
    }
}

INSTANTIATE_TEST_SUITE_P(All, AnyIntegrator,
                         testing::Values(Integrator::SymplecticEuler, Integrator::ExplicitEuler,
                                         Integrator::BackwardEuler),
                         testing::PrintToStringParamName());

class DampingOfTheDefaultWorld : public testing::TestWithParam<double> {};

TEST_P(DampingOfTheDefaultWorld, HalvesAVelocityInTheSameTimeForAnyTick) {
    const double half_life_s = 692.8 / 60, tick_s = GetParam();
    TestBodies setup;
    setup.parameters.integration = integration(Integrator::SymplecticEuler, tick_s, damping_rate(0.999));
    setup.add_circle(10'000, 10'000, 5, 1, 100);
    double seconds = 0, before = 100;
    while (setup.circles.velocity_x[0] > 50) {
        before = static_cast<double>(setup.circles.velocity_x[0]);
        setup.step();
        seconds += tick_s;
    }
    const double after = static_cast<double>(setup.circles.velocity_x[0]);
    const double crossing = seconds - tick_s * (50 - after) / (before - after); // between the last two ticks
    // A straight line between the two ticks. The factor of a tick, 1 − 0.06/s · tick_s, is rounded to a float (3e-8).
    EXPECT_NEAR(crossing, half_life_s, half_life_s * (1e-4 + 3e-8 / (0.06 * tick_s)));
}

INSTANTIATE_TEST_SUITE_P(TickLengths, DampingOfTheDefaultWorld,
                         testing::Values(1.0 / 60, 1.0 / 120, 1.0 / 30, 0.001, 0.05));

TEST(Damping, OfOneKeepsEveryVelocity) {
    EXPECT_EQ(damping_rate(1), 0);
    for (const Integrator integrator :
         {Integrator::SymplecticEuler, Integrator::ExplicitEuler, Integrator::BackwardEuler}) {
        EXPECT_EQ(integration(integrator, 1.0 / 60, damping_rate(1)).velocity_kept, 1);
    }
}

} // namespace
} // namespace evod::physics
