#include "client/viewer/world/viewed_world.h"

#include "tests/support/waiting.h"
#include "tests/unit/core/fake_server.h"

#include <gmock/gmock.h>

#include <set>

namespace evod::viewer {
namespace {

using testing::ElementsAre;

struct ViewedWorldTest : testing::Test {
    WantedWorld wanted() const { return {.connection = server.options(), .world = "default", .island = 1}; }

    /// Updates until the condition holds; fails after some seconds.
    template <class Condition>
    void until(ViewedWorld& world, Condition condition) {
        ASSERT_TRUE(wait_until(condition, [&] {
            world.update(std::chrono::steady_clock::now());
            for (std::string& notice : world.server.take_notices()) {
                notices.push_back(std::move(notice));
            }
            take_a_nap();
        }));
    }

    /// Welcomes the viewer and answers its subscriptions, with number 7 for snapshots. Its first query comes next.
    core::FakeSession begin(ViewedWorld&, evod::v1::Role role = evod::v1::ROLE_UNSPECIFIED) {
        core::FakeSession session = server.accept_and_welcome(0, role);
        const auto events = session.read_request();
        EXPECT_TRUE(events.has_subscribe_events());
        session.answer_subscription(events, 6);
        const auto snapshots = session.read_request();
        EXPECT_EQ(snapshots.subscribe_snapshots().world(), "default");
        EXPECT_EQ(snapshots.subscribe_snapshots().island(), 1u);
        session.answer_subscription(snapshots, 7);
        return session;
    }

    static void send_snapshot(core::FakeSession& session, std::uint32_t subscription_id, std::uint32_t island,
                              std::uint64_t tick, const std::string& world = "default", std::uint64_t sequence = 0) {
        evod::v1::SnapshotFrame frame;
        frame.set_width_px(100);
        frame.set_height_px(100);
        codec::encode_plain({}, frame);
        frame.set_world(world);
        frame.set_run_id("\xaa");
        frame.set_subscription_id(subscription_id);
        frame.set_island(island);
        frame.set_island_count(3);
        frame.set_tick(tick);
        frame.set_sequence(sequence); // 0: not acknowledged
        frame.set_state(evod::v1::RUN_STATE_RUNNING);
        session.send(frame);
    }

    static evod::v1::WorldInfo info(const std::string& name, evod::v1::RunState state) {
        evod::v1::WorldInfo world;
        world.set_name(name);
        world.set_run_id("aa");
        world.set_state(state);
        return world;
    }

    static void answer_statistics(core::FakeSession& session, const evod::v1::Request& question) {
        EXPECT_TRUE(question.has_get_statistics());
        evod::v1::ServerMessage message;
        message.mutable_response()->set_request_id(question.request_id());
        auto& statistics = *message.mutable_response()->mutable_statistics();
        *statistics.mutable_world() = info("default", evod::v1::RUN_STATE_RUNNING);
        for (std::uint32_t island = 0; island < 3; ++island) {
            statistics.add_last()->set_island(island);
            statistics.mutable_last(static_cast<int>(island))->set_fitness_best(100 + island);
        }
        session.send(message);
    }

    /// Sends a snapshot of island 1, and answers the query that it causes.
    void show_first_snapshot(ViewedWorld& world, core::FakeSession& session, std::uint64_t tick) {
        send_snapshot(session, 7, 1, tick);
        until(world, [&] { return world.feed.snapshot() != nullptr; });
        answer_statistics(session, session.read_request());
        until(world, [&] { return world.all_answered(); });
    }

    core::FakeServer server;
    std::vector<std::string> notices;
};

TEST_F(ViewedWorldTest, ReceivesSnapshotsAndTheLastGeneration) {
    ViewedWorld world{wanted()};
    auto session = begin(world);
    send_snapshot(session, 7, 1, 50);
    until(world, [&] { return world.feed.snapshot() != nullptr; });
    EXPECT_EQ(world.feed.snapshot()->about.tick(), 50u);
    EXPECT_FALSE(world.all_answered());
    answer_statistics(session, session.read_request());
    until(world, [&] { return world.all_answered(); });
    ASSERT_NE(world.feed.last_generation(), nullptr);
    EXPECT_EQ(world.feed.last_generation()->fitness_best(), 101);
}

TEST_F(ViewedWorldTest, CyclesFromTheLastIslandToTheFirst) {
    ViewedWorld world{wanted()};
    auto session = begin(world);
    send_snapshot(session, 7, 1, 50);
    until(world, [&] { return world.feed.snapshot() != nullptr; });
    answer_statistics(session, session.read_request());
    for (const std::uint32_t island : {2u, 0u}) {
        world.feed.cycle_island(1);
        EXPECT_EQ(world.feed.snapshot(), nullptr) << "snapshots of the other island are dropped";
        EXPECT_TRUE(session.read_request().has_unsubscribe());
        const auto snapshots = session.read_request();
        EXPECT_EQ(snapshots.subscribe_snapshots().island(), island);
        session.answer_subscription(snapshots, 20 + island);
        answer_statistics(session, session.read_request());
        send_snapshot(session, 20 + island, island, 60);
        until(world, [&] { return world.feed.snapshot() != nullptr; });
        EXPECT_EQ(world.feed.island(), island);
        EXPECT_EQ(world.feed.snapshot()->about.island(), island);
    }
}

TEST_F(ViewedWorldTest, NoticesARefusedCommandAndRequestsTheState) {
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

TEST_F(ViewedWorldTest, DoesNotSendAViewersCommandsAndSaysWhy) {
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
    world.replay.fork("other");
    EXPECT_TRUE(world.all_answered());
    EXPECT_THAT(world.server.take_notices(), ElementsAre("Only the role admin may make worlds"));
}

TEST_F(ViewedWorldTest, EveryPlaceHasAUniqueNumber) {
    ViewedWorld world{wanted()}, beside{wanted()};
    std::set<std::uint64_t> numbers{world.feed.place_number(), beside.feed.place_number()};
    const auto add = [&] { numbers.insert(world.feed.place_number()); };
    world.feed.choose_island(2);
    add();
    world.feed.choose_island(2);
    add(); // unchanged
    world.show("default", 2);
    add();
    world.feed.show_all_islands(true);
    add();
    world.feed.choose_island(0);
    add();
    EXPECT_EQ(numbers.size(), 6u);
}

TEST_F(ViewedWorldTest, KnowsTheGenesOfTheShownRun) {
    ViewedWorld world{wanted()};
    auto session = begin(world);
    until(world, [&] { return session.unread_bytes() > 0; });
    evod::v1::ServerMessage message;
    message.mutable_response()->set_request_id(session.read_request().request_id());
    auto& reported = *message.mutable_response()->mutable_statistics()->mutable_world();
    reported = info("default", evod::v1::RUN_STATE_RUNNING);
    reported.add_gene_names("impulse");
    session.send(message);
    until(world, [&] { return world.all_answered(); });
    EXPECT_THAT(world.feed.gene_names(), ElementsAre("impulse"));
    world.show("default", 2);
    EXPECT_THAT(world.feed.gene_names(), ElementsAre("impulse")) << "the same on every island";
    world.show("other", 0);
    EXPECT_THAT(world.feed.gene_names(), ElementsAre());
}

TEST_F(ViewedWorldTest, TakesTheEndOfAStepAfterItsAnswer) {
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

TEST_F(ViewedWorldTest, ShowsTheNextWorld) {
    ViewedWorld world{wanted()};
    auto session = begin(world);
    send_snapshot(session, 7, 1, 50);
    until(world, [&] { return world.feed.snapshot() != nullptr; });
    answer_statistics(session, session.read_request());
    world.show_next_world();
    evod::v1::ServerMessage message;
    message.mutable_response()->set_request_id(session.read_request().request_id());
    for (const char* name : {"alpha", "default", "omega"}) {
        *message.mutable_response()->mutable_worlds()->add_worlds() = info(name, evod::v1::RUN_STATE_WAITING);
    }
    session.send(message);
    until(world, [&] { return world.feed.world() == "omega"; });
    EXPECT_EQ(world.feed.island(), 0u);
    EXPECT_FALSE(world.feed.control().known());
    EXPECT_TRUE(session.read_request().has_unsubscribe());
    EXPECT_EQ(session.read_request().subscribe_snapshots().world(), "omega");
}

TEST_F(ViewedWorldTest, ShowsTheNextWorldOnceConnected) {
    ViewedWorld world{wanted()};
    world.show_next_world(); // before the connection is made
    auto session = begin(world);
    send_snapshot(session, 7, 1, 50);
    until(world, [&] { return world.feed.snapshot() != nullptr; });
    answer_statistics(session, session.read_request());
    const auto question = session.read_request();
    ASSERT_TRUE(question.has_list_worlds());
    evod::v1::ServerMessage message;
    message.mutable_response()->set_request_id(question.request_id());
    for (const char* name : {"default", "omega"}) {
        *message.mutable_response()->mutable_worlds()->add_worlds() = info(name, evod::v1::RUN_STATE_WAITING);
    }
    session.send(message);
    until(world, [&] { return world.feed.world() == "omega"; });
}

TEST_F(ViewedWorldTest, ShowsAMissingWorldOnceItIsMade) {
    ViewedWorld world{wanted()};
    auto session = server.accept_and_welcome();
    session.answer_subscription(session.read_request(), 6);
    session.refuse(session.read_request().request_id(), evod::v1::CODE_NOT_FOUND, "no such world");
    until(world, [&] { return world.refusal().has_value(); });
    world.update(std::chrono::steady_clock::now()); // requests statistics, if not done yet
    session.refuse(session.read_request().request_id(), evod::v1::CODE_NOT_FOUND, "no such world");
    EXPECT_EQ(*world.refusal(), "No such world");
    evod::v1::ServerMessage made;
    made.mutable_event()->set_world("default");
    *made.mutable_event()->mutable_world_created()->mutable_world() = info("default", evod::v1::RUN_STATE_WAITING);
    session.send(made);
    until(world, [&] { return !world.refusal(); });
    auto request = session.read_request();
    if (request.has_unsubscribe()) {
        request = session.read_request();
    }
    EXPECT_EQ(request.subscribe_snapshots().world(), "default");
}

TEST_F(ViewedWorldTest, NoticesChangesOfOtherClients) {
    ViewedWorld world{wanted()};
    auto session = begin(world);
    send_snapshot(session, 7, 1, 50);
    until(world, [&] { return world.feed.snapshot() != nullptr; });
    answer_statistics(session, session.read_request());
    evod::v1::ServerMessage message;
    message.mutable_event()->set_world("default");
    auto& changed = *message.mutable_event()->mutable_parameters_changed();
    changed.mutable_by()->set_client("evoctl");
    changed.mutable_by()->set_address("127.0.0.1");
    changed.add_changed()->set_name("mutation_chance");
    session.send(message);
    until(world, [&] { return !notices.empty(); });
    EXPECT_THAT(notices, ElementsAre("evoctl 127.0.0.1 changed mutation_chance"));
    auto paused = info("default", evod::v1::RUN_STATE_PAUSED);
    paused.set_tick(60);
    *message.mutable_event()->mutable_run_control_changed()->mutable_world() = paused;
    session.send(message);
    until(world, [&] { return world.feed.control().state() == evod::v1::RUN_STATE_PAUSED; });
    message.mutable_event()->mutable_generation_finished()->add_statistics()->set_island(1);
    message.mutable_event()->mutable_generation_finished()->mutable_statistics(0)->set_fitness_best(222);
    session.send(message);
    until(world, [&] { return world.feed.last_generation() && world.feed.last_generation()->fitness_best() == 222; });
}

TEST_F(ViewedWorldTest, KnowsTheStateOfTheDisk) {
    ViewedWorld world{wanted()};
    auto session = begin(world);
    until(world, [&] { return session.unread_bytes() > 0; });
    const auto question = session.read_request();
    evod::v1::ServerMessage message;
    message.mutable_response()->set_request_id(question.request_id());
    auto& reported = *message.mutable_response()->mutable_statistics()->mutable_world();
    reported = info("default", evod::v1::RUN_STATE_RUNNING);
    reported.mutable_storage()->set_state(evod::v1::STORAGE_STATE_FAILING);
    reported.mutable_storage()->set_reason("it is full");
    session.send(message);
    until(world, [&] { return world.feed.storage().reason() == "it is full"; });
    auto& storage = *message.mutable_event()->mutable_storage_changed()->mutable_storage();
    storage.set_state(evod::v1::STORAGE_STATE_STALLED);
    session.send(message);
    until(world, [&] { return core::worlds_wait(world.feed.storage()); });
    EXPECT_TRUE(notices.empty());
    storage.set_state(evod::v1::STORAGE_STATE_KEEPS_UP);
    session.send(message);
    until(world, [&] { return !notices.empty(); });
    EXPECT_THAT(notices, ElementsAre("Run files can be written again"));
    EXPECT_FALSE(core::worlds_wait(world.feed.storage()));
}

TEST_F(ViewedWorldTest, SubscribesAgainAfterALostConnection) {
    ViewedWorld world{wanted()};
    {
        auto session = begin(world);
        show_first_snapshot(world, session, 50);
    }
    until(world, [&] { return world.server.status().state != core::State::Connected; });
    EXPECT_NE(world.feed.snapshot(), nullptr) << "the last snapshot is still shown";
    auto session = begin(world);
    until(world, [&] { return !world.all_answered(); });
    answer_statistics(session, session.read_request());
    send_snapshot(session, 7, 1, 70);
    until(world, [&] { return world.feed.snapshot()->about.tick() == 70; });
}

TEST_F(ViewedWorldTest, ShowsNoRunningStateWithoutAConnection) {
    ViewedWorld world{wanted()};
    {
        auto session = begin(world);
        send_snapshot(session, 7, 1, 50);
        until(world, [&] { return world.feed.snapshot() != nullptr; });
        answer_statistics(session, session.read_request());
        until(world, [&] { return world.state_text() == "running"; });
        EXPECT_EQ(world.server.problem(), "");
        session.say_goodbye(evod::v1::CODE_UNAUTHENTICATED, "the token has been revoked");
    }
    until(world, [&] { return world.state_text() == "no connection"; });
    ASSERT_NE(world.feed.snapshot(), nullptr) << "the last is still shown";
}

TEST_F(ViewedWorldTest, DoesNotRunAReplayAtItsEnd) {
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

TEST_F(ViewedWorldTest, ReceivesAllIslandsInOneSubscription) {
    WantedWorld all = wanted();
    all.all_islands = true;
    ViewedWorld world{all};
    core::FakeSession session = server.accept_and_welcome();
    session.answer_subscription(session.read_request(), 6);
    const auto snapshots = session.read_request();
    EXPECT_FALSE(snapshots.subscribe_snapshots().has_island());
    session.answer_subscription(snapshots, 7);
    for (const std::uint32_t island : {0u, 1u, 2u}) {
        send_snapshot(session, 7, island, 50 + island);
    }
    until(world, [&] { return world.feed.snapshot_of(0) && world.feed.snapshot_of(1) && world.feed.snapshot_of(2); });
    answer_statistics(session, session.read_request());
    EXPECT_EQ(world.feed.island_count(), 3u);
    EXPECT_EQ(world.feed.snapshot()->about.tick(), 51u) << "of the chosen island";
    world.feed.cycle_island(1);
    EXPECT_EQ(world.feed.snapshot()->about.tick(), 52u) << "it had arrived before";
    world.feed.show_all_islands(false);
    EXPECT_TRUE(session.read_request().has_unsubscribe());
    EXPECT_EQ(session.read_request().subscribe_snapshots().island(), 2u);
}

/// A replay of the world, paused.
struct ReplayTest : ViewedWorldTest {
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

TEST_F(ReplayTest, IsAWorldOfItsOwnUntilClosed) {
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

TEST_F(ReplayTest, SendsTheNewestOfSeveralSeeks) {
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

TEST_F(ReplayTest, SeeksGenerationsFromTheTargetWithinTheRun) {
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

TEST_F(ReplayTest, NoticesAReplayThatCannotBeOpened) {
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

TEST_F(ReplayTest, ForksFromTheShownMoment) {
    ViewedWorld world{wanted()};
    auto session = open_replay(world);
    world.replay.fork("other");
    const auto fork = next(session);
    EXPECT_EQ(fork.fork_world().world(), "default@3");
    EXPECT_EQ(fork.fork_world().name(), "other");
    EXPECT_FALSE(fork.fork_world().has_at_generation());
    answer_with(session, fork, info("other", evod::v1::RUN_STATE_WAITING));
    until(world, [&] { return world.replay.forked() == "other"; });
    world.replay.return_to_present();
    EXPECT_EQ(world.replay.forked(), "other") << "the fork is still there";
    world.show("elsewhere", 0);
    EXPECT_EQ(world.replay.forked(), "");
}

TEST_F(ReplayTest, ForgetsADeletedFork) {
    ViewedWorld world{wanted()};
    auto session = open_replay(world);
    world.replay.fork("other");
    answer_with(session, next(session), info("other", evod::v1::RUN_STATE_WAITING));
    until(world, [&] { return world.replay.forked() == "other"; });
    evod::v1::ServerMessage deleted;
    deleted.mutable_event()->set_world("other");
    deleted.mutable_event()->mutable_world_deleted()->mutable_by()->set_user("alice");
    session.send(deleted);
    until(world, [&] { return world.replay.forked().empty(); });
}

TEST_F(ReplayTest, AViewerMayCommandItsOwnReplay) {
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
