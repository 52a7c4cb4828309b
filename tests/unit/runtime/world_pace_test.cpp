#include "server/runtime/world_pace.h"

#include "tests/support/manual_clock.h"

#include <gtest/gtest.h>

namespace evod::runtime {
namespace {

using namespace std::chrono_literals;

/// A running world with ticks of 10 ms.
class Pace : public testing::Test {
  protected:
    Pace() {
        entry.control.endless = true;
        entry.control.speed = 1.0;
        pace.follow(entry, true, clock.now());
    }
    static simulation::Entry make_entry() {
        parameters::Parameters p;
        p.tick_s = 0.01;
        p.population_size = 5;
        return {"w", {1, 1}, {}, simulation::World{p, base::Seed{1}}};
    }
    /// A tick that takes `time`.
    void tick(Clock::duration time) {
        clock.advance(time);
        pace.advanced(entry, 1, time, clock.now());
    }

    support::ManualClock clock;
    simulation::Entry entry = make_entry();
    WorldPace pace;
};

TEST_F(Pace, TicksAreDueOnAGridOfTheirLength) {
    const auto began = clock.now();
    EXPECT_EQ(pace.due(), began) << "the first tick comes at once";
    tick(1ms);
    EXPECT_EQ(pace.due(), began + 10ms);
    clock.advance(12ms); // 3 ms late
    tick(1ms);
    EXPECT_EQ(pace.due(), began + 20ms) << "the grid stays";
    entry.control.speed = 2.0;
    pace.follow(entry, true, clock.now());
    EXPECT_EQ(pace.due(), clock.now()) << "another speed begins another grid";
    tick(1ms);
    EXPECT_EQ(pace.due(), clock.now() + 4ms);
}

TEST_F(Pace, ALateWorldCatchesUpWithinTheBound) {
    clock.advance(10s);
    tick(1ms);
    EXPECT_EQ(pace.due(), clock.now() - WorldPace::catch_up_max);
}

TEST_F(Pace, AWorldThatLosesTimeIsSlowed) {
    for (int i = 0; i < 200; ++i) {
        tick(11ms);
    }
    EXPECT_TRUE(pace.measure(entry, clock.now()));
    EXPECT_TRUE(entry.slowed);
    EXPECT_NEAR(entry.ticks_per_s, 1000 / 11.0, 0.5);
    EXPECT_FALSE(pace.measure(entry, clock.now() + 100ms)) << "it was measured just now";
    EXPECT_TRUE(pace.follow(entry, false, clock.now())) << "it has stopped";
    EXPECT_FALSE(entry.slowed);
    EXPECT_EQ(entry.ticks_per_s, 0);
    EXPECT_FALSE(pace.follow(entry, false, clock.now()));
}

TEST_F(Pace, TheTimeOfATickIsTheMeanOfSeveral) {
    pace.advanced(entry, 4, 8ms, clock.now());
    EXPECT_EQ(pace.tick_time(), 2ms);
}

} // namespace
} // namespace evod::runtime
