#include "server/runtime/snapshot_times.h"

#include "server/base/inline_executor.h"
#include "tests/support/manual_clock.h"

#include <gtest/gtest.h>

namespace evod::runtime {
namespace {

using namespace std::chrono_literals;

class Times : public testing::Test {
  protected:
    static simulation::World make_world() {
        parameters::Parameters p;
        p.population_size = 5;
        p.island_count = 3;
        return {p, base::Seed{1}};
    }
    void tick() {
        base::InlineExecutor executor;
        world.advance_tick(executor);
    }
    bool take_if_due() {
        const bool due = times.is_due(world, clock.now());
        if (due) {
            times.taken(world, clock.now());
        }
        return due;
    }

    support::ManualClock clock;
    simulation::World world = make_world();
    WorldDemand demand{.rate_hz = 10, .all_islands = true, .islands = {}, .newcomers = 1};
    SnapshotTimes times;
};

TEST_F(Times, WithoutViewersNothingIsDue) {
    EXPECT_FALSE(times.is_due(world, clock.now()));
}

TEST_F(Times, SnapshotsFollowAGridAtTheWantedRate) {
    times.set_demand(&demand);
    EXPECT_TRUE(take_if_due()) << "a newcomer gets one at once";
    int taken = 0;
    for (int ms = 0; ms < 10'000; ms += 7) {
        clock.advance(7ms);
        tick();
        taken += take_if_due() ? 1 : 0;
    }
    EXPECT_NEAR(taken, 100, 1);
    clock.advance(1s);
    EXPECT_TRUE(take_if_due()) << "the last tick";
    clock.advance(1s);
    EXPECT_FALSE(take_if_due()) << "the world has not changed";
}

TEST_F(Times, NewcomersAndChangesNeedNotWait) {
    times.set_demand(&demand);
    EXPECT_TRUE(take_if_due());
    times.show_change();
    EXPECT_TRUE(times.shows_change());
    EXPECT_TRUE(take_if_due());
    EXPECT_FALSE(times.shows_change());
    ++demand.newcomers;
    EXPECT_TRUE(take_if_due());
    EXPECT_FALSE(take_if_due());
}

TEST_F(Times, OnlyWantedIslandsThatExistAreListed) {
    times.set_demand(&demand);
    EXPECT_EQ(times.wanted_islands(world), (std::vector<std::uint32_t>{0, 1, 2}));
    demand.all_islands = false;
    demand.islands = {1, 7};
    EXPECT_EQ(times.wanted_islands(world), std::vector<std::uint32_t>{1});
}

} // namespace
} // namespace evod::runtime
