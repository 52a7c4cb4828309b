#include "client/viewer/panels/breeding/stepper.h"

#include <gtest/gtest.h>

#include <vector>

namespace evod::viewer {
namespace {

TEST(Stepper, GoesThroughEveryMomentInOrderAndBack) {
    Stepper stepper;
    stepper.load(2, 3);
    const std::vector<Moment> all{{BreedingStage::Scaling, 0},  {BreedingStage::Picking, 0},
                                  {BreedingStage::Picking, 1},  {BreedingStage::Breeding, 0},
                                  {BreedingStage::Breeding, 1}, {BreedingStage::Breeding, 2},
                                  {BreedingStage::Done, 0}};
    for (const Moment& moment : all) {
        EXPECT_EQ(stepper.moment(), moment);
        stepper.step();
    }
    EXPECT_TRUE(stepper.at_end());
    for (auto moment = all.rbegin(); moment != all.rend(); ++moment) {
        EXPECT_EQ(stepper.moment(), *moment);
        stepper.back();
    }
    EXPECT_TRUE(stepper.at_begin());
}

TEST(Stepper, GoesFromStageToStage) {
    Stepper stepper;
    stepper.load(2, 3);
    stepper.next_stage();
    EXPECT_EQ(stepper.moment(), (Moment{BreedingStage::Picking, 0}));
    stepper.step();
    stepper.next_stage();
    EXPECT_EQ(stepper.moment(), (Moment{BreedingStage::Breeding, 0}));
    stepper.next_stage();
    stepper.next_stage();
    EXPECT_EQ(stepper.moment().stage, BreedingStage::Done);
    stepper.previous_stage();
    EXPECT_EQ(stepper.moment(), (Moment{BreedingStage::Breeding, 0}));
    stepper.step();
    stepper.previous_stage();
    EXPECT_EQ(stepper.moment(), (Moment{BreedingStage::Breeding, 0})) << "first to the start of the current stage";
    stepper.previous_stage();
    stepper.previous_stage();
    stepper.previous_stage();
    EXPECT_TRUE(stepper.at_begin());
}

TEST(Stepper, SkipsEmptyStages) {
    Stepper stepper;
    stepper.load(0, 1);
    stepper.next_stage();
    EXPECT_EQ(stepper.moment(), (Moment{BreedingStage::Breeding, 0}));
    stepper.load(0, 0);
    stepper.step();
    EXPECT_EQ(stepper.moment().stage, BreedingStage::Done);
}

TEST(Stepper, PlaysAtItsSpeedAtAnyFrameRate) {
    for (const int frames : {1, 7, 300}) {
        Stepper stepper;
        stepper.load(100, 100);
        stepper.set_speed(4);
        stepper.play();
        for (int i = 0; i < frames; ++i) {
            stepper.advance(10.0625 / frames); // 40 steps and a quarter
        }
        EXPECT_EQ(stepper.position(), 40u) << frames;
        EXPECT_TRUE(stepper.playing());
    }
}

TEST(Stepper, StopsAtTheEndAndThenPlaysFromTheStart) {
    Stepper stepper;
    stepper.load(2, 2);
    stepper.play();
    stepper.advance(1e9);
    EXPECT_TRUE(stepper.at_end());
    EXPECT_FALSE(stepper.playing());
    stepper.play_or_stop();
    EXPECT_TRUE(stepper.at_begin());
    EXPECT_TRUE(stepper.playing());
}

TEST(Stepper, AnyMoveByTheUserStopsPlaying) {
    Stepper stepper;
    stepper.load(20, 20);
    for (const auto hand : {&Stepper::step, &Stepper::back, &Stepper::next_stage, &Stepper::previous_stage,
                            &Stepper::to_begin, &Stepper::to_end}) {
        stepper.go_to(3);
        stepper.play();
        (stepper.*hand)();
        EXPECT_FALSE(stepper.playing());
        const std::uint32_t position = stepper.position();
        stepper.advance(100);
        EXPECT_EQ(stepper.position(), position);
    }
}

TEST(Stepper, ClampsItsSpeed) {
    Stepper stepper;
    stepper.set_speed(1e9);
    EXPECT_EQ(stepper.speed(), Stepper::speed_max);
    stepper.set_speed(0);
    EXPECT_EQ(stepper.speed(), Stepper::speed_min);
}

} // namespace
} // namespace evod::viewer
