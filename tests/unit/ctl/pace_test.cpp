#include "client/ctl/pace.h"

#include <gtest/gtest.h>

namespace evod::ctl {
namespace {

constexpr Durations durations{.generation_s = 40, .tick_s = 1.0 / 60};

v1::WorldInfo world_at(double factor, double ticks_per_s = 0) {
    v1::WorldInfo world;
    if (factor > 0) {
        world.mutable_speed()->set_real_time_factor(factor);
    } else {
        world.mutable_speed()->set_max(true);
    }
    world.set_ticks_per_s(ticks_per_s);
    return world;
}

TEST(Plan, SaysWhatASpeedMeans) {
    EXPECT_EQ(plan_text(world_at(1), durations, 30),
              "at 1×, a generation of 40.0 s takes 40.0 s: 30 generations take about 20:00 min; evoctl speed max is "
              "faster");
    EXPECT_EQ(plan_text(world_at(20), durations, 1),
              "at 20×, a generation of 40.0 s takes 2.0 s: 1 generation takes about 2.0 s");
    EXPECT_EQ(plan_text(world_at(4), durations, std::nullopt),
              "at 4×, a generation of 40.0 s takes 10.0 s; evoctl speed max is faster");
}

TEST(Plan, PrefersTheMeasuredSpeed) {
    EXPECT_EQ(plan_text(world_at(0, 6000), durations, 10),
              "at max, a generation of 40.0 s takes as long as the server needs: 10 generations take about 4.0 s");
    EXPECT_EQ(plan_text(world_at(0), durations, 10),
              "at max, a generation of 40.0 s takes as long as the server needs");
    EXPECT_EQ(real_s(world_at(100, 600), durations, 40), 4.0) << "a world that is slower than its speed";
}

TEST(Plan, LeavesOutWhatHasBeenSimulated) {
    v1::WorldInfo world = world_at(1);
    world.set_generation_tick(600);
    EXPECT_DOUBLE_EQ(simulated_s_left(world, durations, 2), 70);
    world.set_generation_tick(2400);
    EXPECT_DOUBLE_EQ(simulated_s_left(world, durations, 2), 80) << "this generation has ended";
}

TEST(Progress, IsABarWithTheTimeLeft) {
    EXPECT_EQ(progress_text(0.5, 250), "[██████████          ] 50 %, 4:10 min left");
    EXPECT_EQ(progress_text(1.2, std::nullopt), "[████████████████████] 100 %");
}

} // namespace
} // namespace evod::ctl
