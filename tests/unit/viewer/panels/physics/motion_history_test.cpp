#include "client/viewer/panels/physics/motion_history.h"

#include <gmock/gmock.h>

namespace evod::viewer {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

evod::v1::Motion at(std::uint64_t tick, double energy = 0) {
    evod::v1::Motion motion;
    motion.set_tick(tick);
    motion.set_kinetic_energy(energy);
    return motion;
}

std::vector<double> energies(const MotionHistory& history) {
    return history.curve([](const evod::v1::Motion& motion) { return motion.kinetic_energy(); });
}

TEST(MotionHistory, KeepsOneOfEachTick) {
    MotionHistory history;
    EXPECT_TRUE(history.empty());
    history.add(at(3, 1));
    history.add(at(3, 2)); // a paused world returns the same tick again
    history.add(at(9, 4));
    EXPECT_THAT(energies(history), ElementsAre(2, 4));
    EXPECT_EQ(history.last().tick(), 9u);
}

TEST(MotionHistory, ClearsWhenTheTickGoesBack) {
    MotionHistory history;
    history.add(at(30, 1));
    history.add(at(40, 2));
    history.add(at(35, 3));
    EXPECT_THAT(energies(history), ElementsAre(3));
}

TEST(MotionHistory, DropsTheOldest) {
    MotionHistory history;
    for (std::uint64_t tick = 0; tick < MotionHistory::kept + 10; ++tick) {
        history.add(at(tick, static_cast<double>(tick)));
    }
    EXPECT_EQ(history.size(), MotionHistory::kept);
    EXPECT_EQ(energies(history).front(), 10);
}

/// 50 bodies after 100 ticks of a generation.
evod::v1::Motion moving(double share, std::uint64_t too_fast) {
    evod::v1::Motion motion;
    motion.set_tick_s(0.05);
    motion.set_body_count(50);
    motion.set_generation_tick(100);
    motion.set_fastest_px_s(400);
    motion.set_fastest_step_share(share);
    motion.set_too_fast_count(too_fast);
    return motion;
}

TEST(JudgeTick, AcceptsSlowBodies) {
    const TickVerdict verdict = judge_tick(moving(0.64032, 0));
    EXPECT_EQ(verdict.level, TickVerdict::Level::Good);
    EXPECT_EQ(verdict.sentence, "The tick is short enough: the fastest body moves 0.64 of its radius per tick.");
}

TEST(JudgeTick, AcceptsAFewFastBodies) {
    const TickVerdict verdict = judge_tick(moving(1.2, 110)); // as in the default world
    EXPECT_EQ(verdict.level, TickVerdict::Level::Good);
    EXPECT_EQ(verdict.sentence, "The tick is short enough: only on average 1.1 of 50 bodies move further than their "
                                "radius in a tick of this generation. Two such bodies that meet may pass through each "
                                "other.");
}

TEST(JudgeTick, WarnsOfManyFastBodiesAndNamesRemedies) {
    const TickVerdict close = judge_tick(moving(0.8, 200)); // 4 % of all moves
    EXPECT_EQ(close.level, TickVerdict::Level::Close);
    EXPECT_THAT(close.sentence, HasSubstr("nearly too long: on average 2 of 50 bodies"));
    EXPECT_THAT(close.sentence, HasSubstr("Set tick_s to 0.0312 or less, or max_speed_px_s to 250."));
    const TickVerdict fast = judge_tick(moving(2, 1500)); // 30 %
    EXPECT_EQ(fast.level, TickVerdict::Level::TooLong);
    EXPECT_THAT(fast.sentence, HasSubstr("too long: on average 15 of 50 bodies"));
    EXPECT_THAT(fast.sentence, HasSubstr("Set tick_s to 0.0125 or less, or max_speed_px_s to 100."));
    EXPECT_THAT(judge_tick(moving(0.1, 1500)).sentence, HasSubstr("Halve tick_s, to 0.025, or lower max_speed_px_s."));
}

TEST(JudgeTick, AcceptsAnEmptyIsland) {
    evod::v1::Motion motion;
    EXPECT_EQ(judge_tick(motion).level, TickVerdict::Level::Good);
    motion.set_too_fast_count(1); // bodies that have died since
    EXPECT_EQ(judge_tick(motion).level, TickVerdict::Level::TooLong);
}

} // namespace
} // namespace evod::viewer
