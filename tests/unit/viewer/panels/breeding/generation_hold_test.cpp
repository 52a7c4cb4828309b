#include "client/viewer/panels/breeding/generation_hold.h"

#include <gtest/gtest.h>

namespace evod::viewer {
namespace {

using Ask = GenerationHold::Ask;

TEST(GenerationHold, RunsOneGenerationThenTheTickThatBreedsTheNext) {
    GenerationHold hold;
    EXPECT_EQ(hold.update("a", evod::v1::RUN_STATE_RUNNING, false), Ask::Nothing) << "it is off";
    hold.set(true);
    for (int generation = 0; generation < 2; ++generation) {
        EXPECT_EQ(hold.update("a", evod::v1::RUN_STATE_RUNNING, false), Ask::RunOneGeneration);
        EXPECT_EQ(hold.update("a", evod::v1::RUN_STATE_RUNNING, false), Ask::Nothing) << "once is enough";
        EXPECT_EQ(hold.update("a", evod::v1::RUN_STATE_WAITING, false), Ask::RunOneTick);
        EXPECT_EQ(hold.update("a", evod::v1::RUN_STATE_WAITING, false), Ask::Nothing);
        EXPECT_EQ(hold.update("a", evod::v1::RUN_STATE_RUNNING, true), Ask::Nothing) << "of that tick";
        EXPECT_EQ(hold.update("a", evod::v1::RUN_STATE_PAUSED, false), Ask::Nothing);
    }
}

TEST(GenerationHold, APauseInBetweenDoesNotChangeTheGoal) {
    GenerationHold hold;
    hold.set(true);
    EXPECT_EQ(hold.update("a", evod::v1::RUN_STATE_RUNNING, false), Ask::RunOneGeneration);
    EXPECT_EQ(hold.update("a", evod::v1::RUN_STATE_PAUSED, false), Ask::Nothing);
    EXPECT_EQ(hold.update("a", evod::v1::RUN_STATE_RUNNING, false), Ask::Nothing);
    EXPECT_EQ(hold.update("a", evod::v1::RUN_STATE_WAITING, false), Ask::RunOneTick);
}

TEST(GenerationHold, AWorldThatWaitsToBeginIsLeftAlone) {
    GenerationHold hold;
    hold.set(true);
    EXPECT_EQ(hold.update("a", evod::v1::RUN_STATE_WAITING, false), Ask::Nothing);
}

TEST(GenerationHold, AResetWorldIsNotBegunByIt) {
    GenerationHold hold;
    hold.set(true);
    EXPECT_EQ(hold.update("a", evod::v1::RUN_STATE_RUNNING, false), Ask::RunOneGeneration);
    EXPECT_EQ(hold.update("b", evod::v1::RUN_STATE_WAITING, false), Ask::Nothing);
    EXPECT_EQ(hold.update("b", evod::v1::RUN_STATE_RUNNING, false), Ask::RunOneGeneration);
}

TEST(GenerationHold, SwitchedOffItAsksForNothing) {
    GenerationHold hold;
    hold.set(true);
    EXPECT_EQ(hold.update("a", evod::v1::RUN_STATE_RUNNING, false), Ask::RunOneGeneration);
    hold.set(false);
    EXPECT_EQ(hold.update("a", evod::v1::RUN_STATE_WAITING, false), Ask::Nothing);
}

} // namespace
} // namespace evod::viewer
