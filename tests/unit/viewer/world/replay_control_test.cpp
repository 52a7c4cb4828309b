#include "tests/unit/viewer/world/viewed_world_fixture.h"

namespace evod::viewer {
namespace {

using testing::ElementsAre;

/// A replay of the world, paused.
struct ReplayControlTest : ViewedWorldTest {
    static evod::v1::WorldInfo replay_info(std::uint64_t tick) {
        evod::v1::WorldInfo world = info("default@3", evod::v1::RUN_STATE_PAUSED);
        world.set_tick(tick);
        auto& replay = *world.mutable_replay();
        replay.set_replay_of("default");
        replay.set_first_generation(1);
        replay.set_last_generation(9);
        replay.set_last_tick(900);
        return world;
    }
    static void answer_with(core::FakeSession& session, const evod::v1::Request& request,
                            const evod::v1::WorldInfo& world) {
        evod::v1::ServerMessage message;
        message.mutable_response()->set_request_id(request.request_id());
        *message.mutable_response()->mutable_world() = world;
        session.send(message);
    }
    /// The next request other than queries of the replay's range, which are answered.
    static evod::v1::Request next(core::FakeSession& session) {
        for (;;) {
            const evod::v1::Request request = session.read_request();
            if (!request.has_get_statistics()) {
                return request;
            }
            evod::v1::ServerMessage message;
            message.mutable_response()->set_request_id(request.request_id());
            *message.mutable_response()->mutable_statistics()->mutable_world() =
                request.get_statistics().world() == "default" ? info("default", evod::v1::RUN_STATE_RUNNING)
                                                              : replay_info(100);
            session.send(message);
        }
    }
    /// Forks the world on a server that has the worlds "default" and "default-2".
    static void fork(ViewedWorld& world, core::FakeSession& session) {
        world.replay.fork();
        const auto list = next(session);
        EXPECT_TRUE(list.has_list_worlds());
        evod::v1::ServerMessage message;
        message.mutable_response()->set_request_id(list.request_id());
        for (const char* name : {"default", "default-2"}) {
            message.mutable_response()->mutable_worlds()->add_worlds()->set_name(name);
        }
        session.send(message);
    }
    /// Opens a replay, with number 9 for snapshots.
    core::FakeSession open_replay(ViewedWorld& world, evod::v1::Role role = evod::v1::ROLE_UNSPECIFIED) {
        auto session = begin(world, role);
        show_first_snapshot(world, session, 850);
        world.replay.open({});
        const auto open = session.read_request();
        EXPECT_EQ(open.open_replay().world(), "default");
        answer_with(session, open, replay_info(100));
        until(world, [&] { return world.replay.is_own(); });
        EXPECT_EQ(next(session).unsubscribe().subscription_id(), 7u);
        const auto snapshots = next(session);
        EXPECT_EQ(snapshots.subscribe_snapshots().world(), "default@3");
        session.answer_subscription(snapshots, 9);
        const auto events = next(session);
        EXPECT_EQ(events.subscribe_events().world(), "default@3") << "the events of all worlds exclude replays";
        session.answer_subscription(events, 10);
        send_snapshot(session, 9, 1, 100, "default@3"); // the answers have arrived before it
        until(world, [&] { return world.feed.snapshot() != nullptr; });
        return session;
    }
};

TEST_F(ReplayControlTest, IsAWorldOfItsOwnUntilClosed) {
    ViewedWorld world{wanted()};
    auto session = open_replay(world);
    ASSERT_NE(world.replay.info(), nullptr);
    EXPECT_EQ(world.replay.info()->last_tick(), 900u);
    EXPECT_EQ(world.feed.world(), "default@3");
    EXPECT_EQ(world.feed.island(), 1u);
    world.replay.return_to_present();
    EXPECT_EQ(world.feed.world(), "default");
    EXPECT_EQ(world.replay.info(), nullptr);
    EXPECT_EQ(next(session).unsubscribe().subscription_id(), 10u);
    EXPECT_EQ(next(session).close_replay().world(), "default@3");
    EXPECT_EQ(next(session).unsubscribe().subscription_id(), 9u);
    EXPECT_EQ(next(session).subscribe_snapshots().world(), "default");
}

TEST_F(ReplayControlTest, SendsTheNewestOfSeveralSeeks) {
    ViewedWorld world{wanted()};
    auto session = open_replay(world);
    for (const std::uint64_t tick : {200u, 300u, 400u}) {
        evod::v1::RunMoment moment;
        moment.set_tick(tick);
        world.replay.seek(moment);
    }
    auto seek = next(session);
    EXPECT_EQ(seek.seek().world(), "default@3");
    EXPECT_EQ(seek.seek().to().tick(), 200u);
    answer_with(session, seek, replay_info(200));
    until(world, [&] { return world.feed.control().tick() == 200; });
    seek = next(session);
    EXPECT_EQ(seek.seek().to().tick(), 400u);
    ASSERT_NE(world.replay.target(), nullptr);
    answer_with(session, seek, replay_info(400));
    until(world, [&] { return world.replay.target() == nullptr; });
    EXPECT_EQ(world.feed.control().tick(), 400u);
}

TEST_F(ReplayControlTest, SeeksGenerationsFromTheTargetWithinTheRun) {
    ViewedWorld world{wanted()};
    auto session = open_replay(world);
    evod::v1::RunMoment moment;
    moment.set_generation(4);
    world.replay.seek(moment);
    world.replay.seek_generations(-1);
    world.replay.seek_generations(-1);
    EXPECT_EQ(world.replay.target()->generation(), 2u);
    world.replay.seek_generations(-5);
    EXPECT_EQ(world.replay.target()->generation(), 1u);
    world.replay.seek_generations(50);
    EXPECT_EQ(world.replay.target()->generation(), 9u);
}

TEST_F(ReplayControlTest, NoticesAReplayThatCannotBeOpened) {
    ViewedWorld world{wanted()};
    auto session = begin(world);
    show_first_snapshot(world, session, 850);
    world.replay.open({});
    EXPECT_FALSE(world.all_answered());
    session.refuse(session.read_request().request_id(), evod::v1::CODE_FAILED_PRECONDITION, "the server keeps no runs");
    until(world, [&] { return !notices.empty(); });
    EXPECT_THAT(notices, ElementsAre("The server keeps no runs"));
    EXPECT_FALSE(world.replay.is_own());
    EXPECT_EQ(world.feed.world(), "default");
}

TEST_F(ReplayControlTest, ForksFromTheShownMoment) {
    ViewedWorld world{wanted()};
    auto session = open_replay(world);
    fork(world, session);
    until(world, [&] { return session.unread_bytes() > 0; });
    const auto fork = next(session);
    EXPECT_EQ(fork.fork_world().world(), "default@3");
    EXPECT_EQ(fork.fork_world().name(), "default-3") << "the live world's name with a number that is free";
    EXPECT_FALSE(fork.fork_world().has_at_generation());
    answer_with(session, fork, info("default-3", evod::v1::RUN_STATE_WAITING));
    until(world, [&] { return world.feed.world() == "default-3"; });
    EXPECT_FALSE(world.replay.is_own());
}

TEST_F(ReplayControlTest, AViewerMayCommandItsOwnReplay) {
    ViewedWorld world{wanted()};
    auto session = open_replay(world, evod::v1::ROLE_VIEWER);
    EXPECT_TRUE(world.commands.may_command());
    evod::v1::RunMoment moment;
    moment.set_tick(200);
    world.replay.seek(moment);
    EXPECT_EQ(next(session).seek().to().tick(), 200u);
    world.replay.return_to_present();
    EXPECT_FALSE(world.commands.may_command());
}

} // namespace
} // namespace evod::viewer
