#include "client/viewer/world/run_control.h"

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

evod::v1::SnapshotFrame snapshot(evod::v1::RunState state, std::uint64_t tick) {
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

TEST(RunControl, SpaceRunsPausesAndResumes) {
    RunControl control;
    control.update(world(waiting, 0));
    const auto run = control.pause_or_resume();
    ASSERT_TRUE(run && run->has_run());
    EXPECT_FALSE(run->run().has_generations());
    control.answered(nullptr);
    control.update(world(running, 10));
    EXPECT_TRUE(control.pause_or_resume()->has_pause());
    control.answered(nullptr);
    control.update(world(paused, 20));
    const auto resume = control.pause_or_resume();
    EXPECT_TRUE(resume->has_resume());
    EXPECT_EQ(resume->resume().world(), "default");
}

TEST(RunControl, KnowsForWhichFitnessTheWorldWaits) {
    const auto awaited = [](std::uint64_t generation, std::uint32_t islands) {
        evod::v1::AwaitedFitness fitness;
        fitness.set_generation(generation);
        for (std::uint32_t island = 0; island < islands; ++island) {
            fitness.add_islands(island);
        }
        return fitness;
    };
    RunControl control;
    evod::v1::WorldInfo info = world(running, 10);
    *info.mutable_awaited_fitness() = awaited(4, 2);
    control.update(info);
    ASSERT_TRUE(control.awaited_fitness());
    EXPECT_EQ(control.awaited_fitness()->islands_size(), 2);
    control.update(awaited(4, 1));
    EXPECT_EQ(control.awaited_fitness()->islands_size(), 1);
    control.update(awaited(5, 2));
    control.update(awaited(4, 0)); // the event about a command arrives after that of the next generation
    ASSERT_TRUE(control.awaited_fitness());
    EXPECT_EQ(control.awaited_fitness()->generation(), 5u);
    control.update(awaited(5, 0));
    EXPECT_FALSE(control.awaited_fitness());
    control.update(awaited(6, 1));
    evod::v1::SnapshotFrame later = snapshot(running, 20);
    later.set_generation(7);
    control.update(later);
    EXPECT_FALSE(control.awaited_fitness());
}

TEST(RunControl, SpaceRunsAWaitingWorldThatWasStepped) {
    RunControl control;
    control.update(world(waiting, 10));
    EXPECT_TRUE(control.step(1)->has_run_until_tick());
    evod::v1::WorldInfo stepping = world(running, 10);
    stepping.set_run_until_tick(11);
    control.answered(nullptr);
    control.update(stepping);
    control.update(world(paused, 11));
    EXPECT_TRUE(control.pause_or_resume()->has_run());
    control.answered(nullptr);
    control.update(world(running, 12));
    control.update(world(paused, 13));
    EXPECT_TRUE(control.pause_or_resume()->has_resume());
}

TEST(RunControl, ForgetsAStepWhenAnotherClientRunsTheWorld) {
    RunControl control;
    control.update(world(waiting, 10));
    control.step(1);
    control.answered(nullptr);
    control.update(world(paused, 11));
    control.update(world(running, 12));
    control.update(world(paused, 13));
    EXPECT_TRUE(control.pause_or_resume()->has_resume());
}

TEST(RunControl, SendsNothingToAnEndedOrUnknownWorld) {
    RunControl control;
    EXPECT_FALSE(control.pause_or_resume());
    EXPECT_FALSE(control.step(1));
    EXPECT_FALSE(control.faster());
    control.update(world(terminated, 100));
    EXPECT_FALSE(control.pause_or_resume());
    EXPECT_FALSE(control.step(1));
}

TEST(RunControl, RunsGenerationsAndResetsWithOrWithoutASeed) {
    RunControl control;
    EXPECT_FALSE(control.run_generations(3));
    EXPECT_FALSE(control.reset(std::nullopt));
    control.update(world(waiting, 0));
    const auto run = control.run_generations(3);
    EXPECT_EQ(run->run().world(), "default");
    EXPECT_EQ(run->run().generations(), 3u);
    EXPECT_EQ(control.state(), running);
    control.answered(nullptr);
    control.update(world(terminated, 100));
    EXPECT_FALSE(control.run_generations(3)) << "the run has ended";
    EXPECT_FALSE(control.reset(std::nullopt)->reset_world().has_seed());
    EXPECT_EQ(control.reset(0)->reset_world().seed(), 0u);
    EXPECT_TRUE(control.reset(0)->reset_world().has_seed());
}

TEST(RunControl, ClampsTheSpeedToTheServersRange) {
    RunControl control;
    EXPECT_FALSE(control.at_factor(2));
    control.update(world(waiting, 0));
    EXPECT_EQ(control.at_factor(2.5)->set_speed().speed().real_time_factor(), 2.5);
    EXPECT_EQ(control.at_factor(1e9)->set_speed().speed().real_time_factor(), RunControl::factor_max);
}

TEST(RunControl, ASecondPressActsOnWhatTheWindowShows) {
    RunControl control;
    control.update(snapshot(running, 10));
    EXPECT_TRUE(control.pause_or_resume()->has_pause());
    control.update(snapshot(running, 12)); // sent before the server received the pause
    EXPECT_EQ(control.state(), paused);
    EXPECT_TRUE(control.pause_or_resume()->has_resume());
}

TEST(RunControl, IgnoresTheStateOfAnOldSnapshot) {
    RunControl control;
    control.update(snapshot(running, 10));
    control.pause_or_resume();
    const auto response = answer(world(paused, 12));
    EXPECT_FALSE(control.answered(&response));
    control.update(snapshot(running, 12));
    EXPECT_EQ(control.state(), paused);
    control.update(snapshot(running, 13)); // another client resumed it
    EXPECT_EQ(control.state(), running);
}

TEST(RunControl, IgnoresAnAnswerOlderThanTheKnownState) {
    RunControl control;
    control.update(world(paused, 20));
    control.update(world(running, 19));
    EXPECT_EQ(control.state(), paused);
}

TEST(RunControl, AnEventBeforeAnAnswerIsNotUndoneByIt) {
    RunControl control;
    control.update(world(waiting, 10));
    control.step(1);
    control.update(world(paused, 11)); // an event, while the answer waits for the disk
    EXPECT_EQ(control.state(), waiting);
    const evod::v1::Response begun = answer(world(running, 10));
    control.answered(&begun);
    EXPECT_EQ(control.state(), paused);
}

TEST(RunControl, StepsUnderWayAddUp) {
    RunControl control;
    control.update(world(paused, 100));
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
    control.update(world(running, 100));
    EXPECT_TRUE(control.step(1)->has_pause());
    EXPECT_FALSE(control.step(1)) << "delayed like the first";
    const auto response = answer(world(paused, 103));
    const auto step = control.answered(&response);
    ASSERT_TRUE(step && step->has_run_until_tick());
    EXPECT_EQ(step->run_until_tick().tick(), 105u);
}

TEST(RunControl, AStepAfterAPauseCountsFromTheStop) {
    RunControl control;
    control.update(world(paused, 100));
    control.step(60);
    const auto response = answer(world(paused, 120)); // another client paused it on the way
    control.answered(&response);
    EXPECT_EQ(control.step(1)->run_until_tick().tick(), 121u);
}

TEST(RunControl, AStepWaitsForTheAnswerToThePause) {
    RunControl control;
    control.update(world(running, 1));
    control.pause_or_resume();
    EXPECT_FALSE(control.step(1));
    EXPECT_FALSE(control.step(60));
    const auto response = answer(world(paused, 2)); // one tick later than known here
    const auto step = control.answered(&response);
    ASSERT_TRUE(step && step->has_run_until_tick());
    EXPECT_EQ(step->run_until_tick().tick(), 63u);
    const auto stepped = answer(world(paused, 63));
    EXPECT_FALSE(control.answered(&stepped));
}

TEST(RunControl, ResumingForgetsAWaitingStep) {
    RunControl control;
    control.update(world(running, 1));
    control.pause_or_resume();
    control.step(1);
    control.pause_or_resume();
    const auto stopped = answer(world(paused, 2)), going = answer(world(running, 2));
    EXPECT_FALSE(control.answered(&stopped));
    EXPECT_FALSE(control.answered(&going));
    EXPECT_EQ(control.state(), running);
}

TEST(RunControl, ResumingASteppedWorldRunsIt) {
    RunControl control;
    control.update(world(paused, 5));
    EXPECT_TRUE(control.pause_or_resume()->has_resume());
    const auto response = answer(world(waiting, 5));
    const auto next = control.answered(&response);
    ASSERT_TRUE(next && next->has_run());
    const auto run = answer(world(running, 5));
    EXPECT_FALSE(control.answered(&run));
    EXPECT_EQ(control.state(), running);
}

TEST(RunControl, SpeedDoublesAndHalvesWithinTheRange) {
    RunControl control;
    control.update(world(running, 0));
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

TEST(RunControl, SlowerThanTheMaximumIsTheSpeedBefore) {
    RunControl control;
    control.update(world(running, 0));
    control.faster();
    EXPECT_TRUE(control.max_speed()->set_speed().speed().max());
    EXPECT_FALSE(control.faster());
    EXPECT_EQ(control.slower()->set_speed().speed().real_time_factor(), 2);
    control.max_speed();
    EXPECT_EQ(control.max_speed()->set_speed().speed().real_time_factor(), 2);
}

TEST(RunControl, ARefusalRequestsTheState) {
    RunControl control;
    control.update(world(paused, 7));
    control.pause_or_resume();
    evod::v1::Response refusal;
    refusal.mutable_status()->set_code(evod::v1::CODE_RESOURCE_EXHAUSTED);
    const auto question = control.answered(&refusal);
    ASSERT_TRUE(question && question->has_get_statistics());
    EXPECT_EQ(question->get_statistics().world(), "default");
    control.update(world(paused, 7));
    EXPECT_TRUE(control.pause_or_resume()->has_resume());
}

TEST(RunControl, StartsAgainWithAnotherRun) {
    RunControl control;
    control.update(world(paused, 1000));
    auto next = snapshot(running, 3);
    next.set_run_id("b");
    control.update(next);
    EXPECT_EQ(control.tick(), 3u);
    EXPECT_EQ(control.state(), running);
}

TEST(RunControl, TheTickOfAReplayMayDecrease) {
    RunControl control;
    auto past = world(paused, 500);
    past.mutable_replay()->set_last_tick(900);
    past.set_run_until_tick(500); // of a finished step
    control.update(past);
    control.update(snapshot(paused, 500));
    past.set_tick(100);
    control.update(past);
    EXPECT_EQ(control.tick(), 100u);
    control.update(snapshot(paused, 100));
    EXPECT_EQ(control.step(1)->run_until_tick().tick(), 101u);
}

} // namespace
} // namespace evod::viewer
