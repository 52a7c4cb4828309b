#include "tests/unit/viewer/world/viewed_world_fixture.h"

namespace evod::viewer {
namespace {

using testing::ElementsAre;

struct WorldCommandsTest : ViewedWorldTest {};

TEST_F(WorldCommandsTest, NoticesARefusedCommandAndRequestsTheState) {
    ViewedWorld world{wanted()};
    auto session = begin(world);
    show_first_snapshot(world, session, 50);
    world.commands.pause_or_resume();
    const auto pause = session.read_request();
    EXPECT_TRUE(pause.has_pause());
    session.refuse(pause.request_id(), evod::v1::CODE_RESOURCE_EXHAUSTED, "the mailbox is full");
    until(world, [&] { return !notices.empty(); });
    EXPECT_THAT(notices, ElementsAre("The mailbox is full"));
    answer_statistics(session, session.read_request());
    until(world, [&] { return world.all_answered(); });
    EXPECT_EQ(world.feed.control().state(), evod::v1::RUN_STATE_RUNNING);
}

TEST_F(WorldCommandsTest, DoesNotSendAViewersCommandsAndSaysWhy) {
    ViewedWorld world{wanted()};
    auto session = begin(world, evod::v1::ROLE_VIEWER);
    show_first_snapshot(world, session, 50);
    EXPECT_FALSE(world.commands.may_command());
    EXPECT_FALSE(world.server.may_create());
    world.commands.pause_or_resume();
    world.commands.step(1);
    world.commands.faster();
    world.commands.slower();
    world.commands.real_time();
    world.commands.max_speed();
    world.commands.at_factor(2);
    world.commands.run_generations(1);
    world.commands.reset(std::nullopt);
    EXPECT_TRUE(world.all_answered()) << "nothing was sent";
    EXPECT_EQ(world.feed.control().state(), evod::v1::RUN_STATE_RUNNING) << "and no effect is assumed";
    EXPECT_THAT(world.server.take_notices(),
                testing::AllOf(testing::SizeIs(9), testing::Each(world.commands.read_only_reason())));
    world.replay.fork();
    EXPECT_TRUE(world.all_answered());
    EXPECT_THAT(world.server.take_notices(), ElementsAre(std::string{no_creation_text}));
}

TEST_F(WorldCommandsTest, TakesTheEndOfAStepAfterItsAnswer) {
    ViewedWorld world{wanted()};
    auto session = begin(world);
    show_first_snapshot(world, session, 50);
    world.commands.step(1); // pauses it first
    evod::v1::ServerMessage answer, event;
    const auto answer_with = [&](const evod::v1::Request& request, evod::v1::RunState state) {
        answer.mutable_response()->set_request_id(request.request_id());
        *answer.mutable_response()->mutable_world() = info("default", state);
        answer.mutable_response()->mutable_world()->set_tick(52);
    };
    const auto pause = session.read_request();
    EXPECT_TRUE(pause.has_pause());
    answer_with(pause, evod::v1::RUN_STATE_PAUSED);
    session.send(answer);
    until(world, [&] { return world.feed.control().tick() == 52; });
    const auto step = session.read_request();
    EXPECT_EQ(step.run_until_tick().tick(), 53u);
    answer_with(step, evod::v1::RUN_STATE_RUNNING);
    event.mutable_event()->set_world("default");
    auto& ended = *event.mutable_event()->mutable_run_control_changed()->mutable_world();
    ended = info("default", evod::v1::RUN_STATE_PAUSED);
    ended.set_tick(53);
    session.send(answer);
    session.send(event);
    // The acknowledgement of a later snapshot proves that both have arrived, so one update() takes them in together.
    send_snapshot(session, 7, 1, 51, "default", 1);
    EXPECT_TRUE(session.read().has_acknowledge_snapshot());
    until(world, [&] { return world.all_answered() && world.feed.control().tick() == 53; });
    EXPECT_EQ(world.feed.control().state(), evod::v1::RUN_STATE_PAUSED);
}

TEST_F(WorldCommandsTest, DoesNotRunAReplayAtItsEnd) {
    ViewedWorld world{wanted()};
    auto session = begin(world);
    send_snapshot(session, 7, 1, 899);
    until(world, [&] { return world.feed.snapshot() != nullptr; });
    const auto question = session.read_request();
    ASSERT_TRUE(question.has_get_statistics());
    evod::v1::ServerMessage message;
    message.mutable_response()->set_request_id(question.request_id());
    auto& reported = *message.mutable_response()->mutable_statistics()->mutable_world();
    reported = info("default", evod::v1::RUN_STATE_WAITING);
    reported.set_tick(899);
    reported.mutable_replay()->set_last_tick(900);
    session.send(message);
    until(world, [&] { return world.replay.info() != nullptr; });
    EXPECT_FALSE(world.replay.at_end());
    EXPECT_EQ(world.state_text(), "waiting – Space runs");
    message.Clear();
    message.mutable_event()->set_world("default");
    auto& event_world = *message.mutable_event()->mutable_run_control_changed()->mutable_world();
    event_world = info("default", evod::v1::RUN_STATE_PAUSED);
    event_world.set_tick(900);
    event_world.mutable_replay()->set_last_tick(900);
    session.send(message);
    until(world, [&] { return world.replay.at_end(); });
    EXPECT_EQ(world.state_text(), "at the end of the replay");
    world.commands.pause_or_resume();
    world.commands.step(1);
    world.show_next_world();
    EXPECT_TRUE(session.read_request().has_list_worlds()) << "nothing else was sent";
    until(world, [&] { return notices.size() == 2; });
    EXPECT_THAT(notices[0], testing::HasSubstr("the end of the replay"));
}

} // namespace
} // namespace evod::viewer
