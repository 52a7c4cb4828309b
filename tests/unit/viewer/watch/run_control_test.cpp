#include "client/viewer/watch/run_control.h"

#include <gtest/gtest.h>

namespace evod::viewer {
namespace {

evod::v1::WorldInfo world(evod::v1::RunState state, std::uint64_t tick) {
    evod::v1::WorldInfo info;
    info.set_name("default");
    info.set_run_id("a");
    info.set_tick(tick);
    info.set_state(state);
    info.mutable_speed()->set_real_time_factor(1);
    return info;
}

evod::v1::SnapshotFrame picture(evod::v1::RunState state, std::uint64_t tick) {
    evod::v1::SnapshotFrame frame;
    frame.set_world("default");
    frame.set_run_id("a");
    frame.set_tick(tick);
    frame.set_state(state);
    frame.mutable_speed()->set_real_time_factor(1);
    return frame;
}

evod::v1::Response answer(const evod::v1::WorldInfo& info) {
    evod::v1::Response response;
    *response.mutable_world() = info;
    return response;
}

constexpr auto waiting = evod::v1::RUN_STATE_WAITING, running = evod::v1::RUN_STATE_RUNNING,
               paused = evod::v1::RUN_STATE_PAUSED, terminated = evod::v1::RUN_STATE_TERMINATED;

TEST(RunControl, SpaceRunsAWaitingWorldPausesARunningOneAndResumesAPausedOne) {
    RunControl control;
    control.see(world(waiting, 0));
    const auto run = control.pause_or_resume();
    ASSERT_TRUE(run && run->has_run());
    EXPECT_FALSE(run->run().has_generations());
    control.answered(nullptr);
    control.see(world(running, 10));
    EXPECT_TRUE(control.pause_or_resume()->has_pause());
    control.answered(nullptr);
    control.see(world(paused, 20));
    const auto resume = control.pause_or_resume();
    EXPECT_TRUE(resume->has_resume());
    EXPECT_EQ(resume->resume().world(), "default");
}

TEST(RunControl, AfterAStepOfAWaitingWorldSpaceRunsItForThereIsNothingToResume) {
    RunControl control;
    control.see(world(waiting, 10));
    EXPECT_TRUE(control.step(1)->has_run_until_tick());
    evod::v1::WorldInfo stepping = world(running, 10);
    stepping.set_run_until_tick(11);
    control.answered(nullptr);
    control.see(stepping);
    EXPECT_TRUE(control.stepping());
    control.see(world(paused, 11));
    EXPECT_FALSE(control.stepping());
    EXPECT_TRUE(control.pause_or_resume()->has_run());
    control.answered(nullptr);
    control.see(world(running, 12));
    control.see(world(paused, 13));
    EXPECT_TRUE(control.pause_or_resume()->has_resume());
}

TEST(RunControl, AStepIsForgottenWhenSomebodyElseRunsTheWorld) {
    RunControl control;
    control.see(world(waiting, 10));
    control.step(1);
    control.answered(nullptr);
    control.see(world(paused, 11));
    control.see(world(running, 12));
    control.see(world(paused, 13));
    EXPECT_TRUE(control.pause_or_resume()->has_resume());
}

TEST(RunControl, AsksNothingOfAWorldThatHasEndedOrIsNotKnownYet) {
    RunControl control;
    EXPECT_FALSE(control.pause_or_resume());
    EXPECT_FALSE(control.step(1));
    EXPECT_FALSE(control.faster());
    control.see(world(terminated, 100));
    EXPECT_FALSE(control.pause_or_resume());
    EXPECT_FALSE(control.step(1));
}

TEST(RunControl, RunsGenerationsAndIsResetWithASeedOrTheSameAgain) {
    RunControl control;
    EXPECT_FALSE(control.run_generations(3));
    EXPECT_FALSE(control.reset(std::nullopt));
    control.see(world(waiting, 0));
    const auto run = control.run_generations(3);
    EXPECT_EQ(run->run().world(), "default");
    EXPECT_EQ(run->run().generations(), 3u);
    EXPECT_EQ(control.state(), running);
    control.answered(nullptr);
    control.see(world(terminated, 100));
    EXPECT_FALSE(control.run_generations(3)) << "it has ended";
    EXPECT_FALSE(control.reset(std::nullopt)->reset_world().has_seed());
    EXPECT_EQ(control.reset(0)->reset_world().seed(), 0u);
    EXPECT_TRUE(control.reset(0)->reset_world().has_seed());
}

TEST(RunControl, ASpeedIsPutWithinWhatTheServerTakes) {
    RunControl control;
    EXPECT_FALSE(control.at_factor(2));
    control.see(world(waiting, 0));
    EXPECT_EQ(control.at_factor(2.5)->set_speed().speed().real_time_factor(), 2.5);
    EXPECT_EQ(control.at_factor(1e9)->set_speed().speed().real_time_factor(), RunControl::factor_max);
}

TEST(RunControl, ASecondPressMeansWhatThePersonSees) {
    RunControl control;
    control.see(picture(running, 10));
    EXPECT_TRUE(control.pause_or_resume()->has_pause());
    control.see(picture(running, 12)); // sent before the server heard of the pause
    EXPECT_EQ(control.state(), paused);
    EXPECT_TRUE(control.pause_or_resume()->has_resume());
}

TEST(RunControl, AnOldPictureDoesNotContradictANewerAnswer) {
    RunControl control;
    control.see(picture(running, 10));
    control.pause_or_resume();
    const auto response = answer(world(paused, 12));
    EXPECT_FALSE(control.answered(&response));
    control.see(picture(running, 12));
    EXPECT_EQ(control.state(), paused);
    control.see(picture(running, 13)); // somebody else made it go on
    EXPECT_EQ(control.state(), running);
}

TEST(RunControl, AnAnswerThatWasOvertakenChangesNothing) {
    RunControl control;
    control.see(world(paused, 20));
    control.see(world(running, 19));
    EXPECT_EQ(control.state(), paused);
}

TEST(RunControl, WhatIsToldBeforeAnAnswerHoldsOnceItHasCome) {
    RunControl control;
    control.see(world(waiting, 10));
    control.step(1);
    control.see(world(paused, 11)); // an event, while the answer waits for the disk
    EXPECT_EQ(control.state(), waiting);
    const evod::v1::Response begun = answer(world(running, 10));
    control.answered(&begun);
    EXPECT_EQ(control.state(), paused);
}

TEST(RunControl, StepsAddUpWhileTheyAreUnderWay) {
    RunControl control;
    control.see(world(paused, 100));
    EXPECT_EQ(control.step(1)->run_until_tick().tick(), 101u);
    EXPECT_EQ(control.step(60)->run_until_tick().tick(), 161u);
    evod::v1::WorldInfo stepping = world(running, 100);
    stepping.set_run_until_tick(161);
    const auto response = answer(stepping);
    control.answered(&response);
    control.answered(&response);
    EXPECT_EQ(control.step(1)->run_until_tick().tick(), 162u);
}

TEST(RunControl, ARunningWorldIsPausedBeforeItIsStepped) {
    RunControl control;
    control.see(world(running, 100));
    EXPECT_TRUE(control.step(1)->has_pause());
    EXPECT_FALSE(control.step(1)) << "held with the first";
    const auto response = answer(world(paused, 103));
    const auto step = control.answered(&response);
    ASSERT_TRUE(step && step->has_run_until_tick());
    EXPECT_EQ(step->run_until_tick().tick(), 105u);
}

TEST(RunControl, AStepAfterAPauseCountsFromWhereItStopped) {
    RunControl control;
    control.see(world(paused, 100));
    control.step(60);
    const auto response = answer(world(paused, 120)); // stopped on the way, by somebody
    control.answered(&response);
    EXPECT_EQ(control.step(1)->run_until_tick().tick(), 121u);
}

TEST(RunControl, AStepWaitsForThePauseBeforeItWhichKnowsWhereTheWorldStopped) {
    RunControl control;
    control.see(world(running, 1));
    control.pause_or_resume();
    EXPECT_FALSE(control.step(1));
    EXPECT_FALSE(control.step(60));
    const auto response = answer(world(paused, 2)); // one tick more than was known here
    const auto step = control.answered(&response);
    ASSERT_TRUE(step && step->has_run_until_tick());
    EXPECT_EQ(step->run_until_tick().tick(), 63u);
    const auto stepped = answer(world(paused, 63));
    EXPECT_FALSE(control.answered(&stepped));
}

TEST(RunControl, GoingOnForgetsAStepThatWaitsForAPause) {
    RunControl control;
    control.see(world(running, 1));
    control.pause_or_resume();
    control.step(1);
    control.pause_or_resume();
    const auto stopped = answer(world(paused, 2)), going = answer(world(running, 2));
    EXPECT_FALSE(control.answered(&stopped));
    EXPECT_FALSE(control.answered(&going));
    EXPECT_EQ(control.state(), running);
}

TEST(RunControl, GoingOnWithAWorldThatWasOnlySteppedRunsIt) {
    RunControl control;
    control.see(world(paused, 5));
    EXPECT_TRUE(control.pause_or_resume()->has_resume());
    const auto response = answer(world(waiting, 5));
    const auto next = control.answered(&response);
    ASSERT_TRUE(next && next->has_run());
    const auto run = answer(world(running, 5));
    EXPECT_FALSE(control.answered(&run));
    EXPECT_EQ(control.state(), running);
}

TEST(RunControl, SpeedDoublesAndHalvesWithinWhatTheServerTakes) {
    RunControl control;
    control.see(world(running, 0));
    EXPECT_EQ(control.faster()->set_speed().speed().real_time_factor(), 2);
    EXPECT_EQ(control.faster()->set_speed().speed().real_time_factor(), 4);
    EXPECT_EQ(control.real_time()->set_speed().speed().real_time_factor(), 1);
    EXPECT_EQ(control.slower()->set_speed().speed().real_time_factor(), 0.5);
    for (int i = 0; i < 40; ++i) {
        control.slower();
    }
    EXPECT_EQ(control.speed().real_time_factor(), RunControl::factor_min);
    for (int i = 0; i < 40; ++i) {
        control.faster();
    }
    EXPECT_EQ(control.speed().real_time_factor(), RunControl::factor_max);
}

TEST(RunControl, BackFromTheHighestSpeedIsTheSpeedBefore) {
    RunControl control;
    control.see(world(running, 0));
    control.faster();
    EXPECT_TRUE(control.max_speed()->set_speed().speed().max());
    EXPECT_FALSE(control.faster());
    EXPECT_EQ(control.slower()->set_speed().speed().real_time_factor(), 2);
    control.max_speed();
    EXPECT_EQ(control.max_speed()->set_speed().speed().real_time_factor(), 2);
}

TEST(RunControl, ARefusalAsksHowThingsStand) {
    RunControl control;
    control.see(world(paused, 7));
    control.pause_or_resume();
    evod::v1::Response refusal;
    refusal.mutable_status()->set_code(evod::v1::CODE_RESOURCE_EXHAUSTED);
    const auto question = control.answered(&refusal);
    ASSERT_TRUE(question && question->has_get_statistics());
    EXPECT_EQ(question->get_statistics().world(), "default");
    control.see(world(paused, 7));
    EXPECT_TRUE(control.pause_or_resume()->has_resume());
}

TEST(RunControl, AnotherRunOfTheWorldBeginsAfresh) {
    RunControl control;
    control.see(world(paused, 1000));
    auto next = picture(running, 3);
    next.set_run_id("b");
    control.see(next);
    EXPECT_EQ(control.tick(), 3u);
    EXPECT_EQ(control.state(), running);
}

TEST(RunControl, AWorldThatShowsThePastMayGoBack) {
    RunControl control;
    auto past = world(paused, 500);
    past.mutable_replay()->set_last_tick(900);
    past.set_run_until_tick(500); // of a step that is over
    control.see(past);
    control.see(picture(paused, 500));
    past.set_tick(100);
    control.see(past);
    EXPECT_EQ(control.tick(), 100u);
    control.see(picture(paused, 100));
    EXPECT_EQ(control.step(1)->run_until_tick().tick(), 101u);
}

} // namespace
} // namespace evod::viewer
