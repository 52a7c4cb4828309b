#include "server/physics/constant_acceleration.h"

#include <gtest/gtest.h>

#include <string>

namespace evod::physics {
namespace {

constexpr double a = 2, t = 2.4;
constexpr double exact_m = a * t * t / 2, speed_m_s = a * t;
constexpr double unit_roundoff = 0x1p-24; // of float

class ConstantAcceleration : public testing::TestWithParam<int> { // ticks within t
  protected:
    const int ticks = GetParam();
    const double dt = t / ticks;
    const double shift_m = a * t * dt / 2; // distance of each Euler method from the exact position

    StraightMotion moved(Integrator integrator) const { return accelerate_from_rest(integrator, a, dt, ticks); }
    double rounding_m() const { return (ticks + 5) * unit_roundoff * (exact_m + shift_m) + ticks * 0x1p-23; }
};

TEST_P(ConstantAcceleration, ExplicitEulerLagsByHalfATick) {
    EXPECT_NEAR(moved(Integrator::ExplicitEuler).position_m, exact_m - shift_m, rounding_m());
}

TEST_P(ConstantAcceleration, SymplecticEulerLeadsByHalfATick) {
    EXPECT_NEAR(moved(Integrator::SymplecticEuler).position_m, exact_m + shift_m, rounding_m());
}

TEST_P(ConstantAcceleration, TheSpeedIsExactForEveryIntegrator) {
    for (const Integrator integrator :
         {Integrator::SymplecticEuler, Integrator::ExplicitEuler, Integrator::BackwardEuler}) {
        EXPECT_NEAR(moved(integrator).speed_m_s, speed_m_s, (ticks + 3) * unit_roundoff * speed_m_s);
    }
}

TEST_P(ConstantAcceleration, BackwardEqualsSymplecticWithoutDamping) {
    EXPECT_EQ(moved(Integrator::BackwardEuler).position_m, moved(Integrator::SymplecticEuler).position_m);
}

INSTANTIATE_TEST_SUITE_P(Ticks, ConstantAcceleration, testing::Values(3, 6, 12, 24, 48, 240),
                         [](const auto& info) { return std::to_string(info.param); });

TEST(AccelerateFromRest, NoTickLeavesTheBodyAtRest) {
    const StraightMotion start = accelerate_from_rest(Integrator::SymplecticEuler, a, 0.1, 0);
    EXPECT_EQ(start.position_m, 0);
    EXPECT_EQ(start.speed_m_s, 0);
}

} // namespace
} // namespace evod::physics
