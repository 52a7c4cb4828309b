#include "client/viewer/panels/breeding/generation_hold.h"

#include <gtest/gtest.h>

namespace evod::viewer {
namespace {

using Ask = GenerationHold::Ask;

const GenerationHold::Run run{"default", "a"};

TEST(GenerationHold, RunsOneGenerationThenTheTickThatBreedsTheNext) {
    GenerationHold hold;
    EXPECT_EQ(hold.update(run, evod::v1::RUN_STATE_RUNNING, false), Ask::Nothing) << "it is off";
    hold.hold(run);
    for (int generation = 0; generation < 2; ++generation) {
        EXPECT_EQ(hold.update(run, evod::v1::RUN_STATE_RUNNING, false), Ask::RunOneGeneration);
        EXPECT_EQ(hold.update(run, evod::v1::RUN_STATE_RUNNING, false), Ask::Nothing) << "once is enough";
        EXPECT_EQ(hold.update(run, evod::v1::RUN_STATE_WAITING, false), Ask::RunOneTick);
        EXPECT_EQ(hold.update(run, evod::v1::RUN_STATE_WAITING, false), Ask::Nothing);
        EXPECT_EQ(hold.update(run, evod::v1::RUN_STATE_RUNNING, true), Ask::Nothing) << "of that tick";
        EXPECT_EQ(hold.update(run, evod::v1::RUN_STATE_PAUSED, false), Ask::Nothing);
    }
}

TEST(GenerationHold, APauseInBetweenDoesNotChangeTheGoal) {
    GenerationHold hold;
    hold.hold(run);
    EXPECT_EQ(hold.update(run, evod::v1::RUN_STATE_RUNNING, false), Ask::RunOneGeneration);
    EXPECT_EQ(hold.update(run, evod::v1::RUN_STATE_PAUSED, false), Ask::Nothing);
    EXPECT_EQ(hold.update(run, evod::v1::RUN_STATE_RUNNING, false), Ask::Nothing);
    EXPECT_EQ(hold.update(run, evod::v1::RUN_STATE_WAITING, false), Ask::RunOneTick);
}

TEST(GenerationHold, AWorldThatWaitsToBeginIsLeftAlone) {
    GenerationHold hold;
    hold.hold(run);
    EXPECT_EQ(hold.update(run, evod::v1::RUN_STATE_WAITING, false), Ask::Nothing);
    EXPECT_TRUE(hold.on());
}

TEST(GenerationHold, EndsWithTheRunThatWasMeant) {
    // Another world; its own past, whose run has the same id; itself after a reset; nobody knows yet.
    const GenerationHold::Run others[] = {{"beside", "b"}, {"default@3", "a"}, {"default", "b"}, {"", ""}};
    for (const GenerationHold::Run& other : others) {
        SCOPED_TRACE(other.world + " " + other.id);
        GenerationHold hold;
        hold.hold(run);
        EXPECT_EQ(hold.update(run, evod::v1::RUN_STATE_RUNNING, false), Ask::RunOneGeneration);
        EXPECT_EQ(hold.update(other, evod::v1::RUN_STATE_RUNNING, false), Ask::Nothing);
        EXPECT_FALSE(hold.on());
        EXPECT_EQ(hold.update(run, evod::v1::RUN_STATE_RUNNING, false), Ask::Nothing) << "nor when it is back";
    }
}

TEST(GenerationHold, SwitchedOffItAsksForNothing) {
    GenerationHold hold;
    hold.hold(run);
    EXPECT_EQ(hold.update(run, evod::v1::RUN_STATE_RUNNING, false), Ask::RunOneGeneration);
    hold.let_go();
    EXPECT_EQ(hold.update(run, evod::v1::RUN_STATE_WAITING, false), Ask::Nothing);
}

} // namespace
} // namespace evod::viewer
