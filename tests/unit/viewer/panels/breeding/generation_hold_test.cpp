#include "client/viewer/panels/breeding/generation_hold.h"

#include <gtest/gtest.h>

namespace evod::viewer {
namespace {

using HoldAction = GenerationHold::Action;

const GenerationHold::Run run{"default", "a"};

TEST(GenerationHold, RunsOneGenerationThenTheTickThatBreedsTheNext) {
    GenerationHold hold;
    EXPECT_EQ(hold.update(run, evod::v1::RUN_STATE_RUNNING, false), HoldAction::None) << "the hold is off";
    hold.hold(run);
    for (int generation = 0; generation < 2; ++generation) {
        EXPECT_EQ(hold.update(run, evod::v1::RUN_STATE_RUNNING, false), HoldAction::RunOneGeneration);
        EXPECT_EQ(hold.update(run, evod::v1::RUN_STATE_RUNNING, false), HoldAction::None) << "the command was sent";
        EXPECT_EQ(hold.update(run, evod::v1::RUN_STATE_WAITING, false), HoldAction::RunOneTick);
        EXPECT_EQ(hold.update(run, evod::v1::RUN_STATE_WAITING, false), HoldAction::None);
        EXPECT_EQ(hold.update(run, evod::v1::RUN_STATE_RUNNING, true), HoldAction::None) << "that tick runs";
        EXPECT_EQ(hold.update(run, evod::v1::RUN_STATE_PAUSED, false), HoldAction::None);
    }
}

TEST(GenerationHold, APauseInBetweenDoesNotChangeThePlan) {
    GenerationHold hold;
    hold.hold(run);
    EXPECT_EQ(hold.update(run, evod::v1::RUN_STATE_RUNNING, false), HoldAction::RunOneGeneration);
    EXPECT_EQ(hold.update(run, evod::v1::RUN_STATE_PAUSED, false), HoldAction::None);
    EXPECT_EQ(hold.update(run, evod::v1::RUN_STATE_RUNNING, false), HoldAction::None);
    EXPECT_EQ(hold.update(run, evod::v1::RUN_STATE_WAITING, false), HoldAction::RunOneTick);
}

TEST(GenerationHold, SendsNothingToAWorldThatWaitsToBegin) {
    GenerationHold hold;
    hold.hold(run);
    EXPECT_EQ(hold.update(run, evod::v1::RUN_STATE_WAITING, false), HoldAction::None);
    EXPECT_TRUE(hold.on());
}

TEST(GenerationHold, EndsWhenAnotherRunIsShown) {
    // Another world; a replay, whose run has the same id; the world after a reset; a world not yet known.
    const GenerationHold::Run others[] = {{"beside", "b"}, {"default@3", "a"}, {"default", "b"}, {"", ""}};
    for (const GenerationHold::Run& other : others) {
        SCOPED_TRACE(other.world + " " + other.id);
        GenerationHold hold;
        hold.hold(run);
        EXPECT_EQ(hold.update(run, evod::v1::RUN_STATE_RUNNING, false), HoldAction::RunOneGeneration);
        EXPECT_EQ(hold.update(other, evod::v1::RUN_STATE_RUNNING, false), HoldAction::None);
        EXPECT_FALSE(hold.on());
        EXPECT_EQ(hold.update(run, evod::v1::RUN_STATE_RUNNING, false), HoldAction::None)
            << "also when the run is shown again";
    }
}

TEST(GenerationHold, SendsNothingAfterItsRelease) {
    GenerationHold hold;
    hold.hold(run);
    EXPECT_EQ(hold.update(run, evod::v1::RUN_STATE_RUNNING, false), HoldAction::RunOneGeneration);
    hold.release();
    EXPECT_EQ(hold.update(run, evod::v1::RUN_STATE_WAITING, false), HoldAction::None);
}

} // namespace
} // namespace evod::viewer
