#include "client/viewer/watch/watch.h"

#include "tests/support/waiting.h"
#include "tests/unit/core/fake_server.h"

#include <gmock/gmock.h>

#include <set>

namespace evod::viewer {
namespace {

using testing::ElementsAre;

struct WatchTest : testing::Test {
    Watch::Wanted wanted() const { return {.connection = server.options(), .world = "default", .island = 1}; }

    /// Updates until the condition holds; fails if it does not within some seconds.
    template <class Condition>
    void until(Watch& watch, Condition condition) {
        ASSERT_TRUE(wait_until(condition, [&] {
            watch.update(std::chrono::steady_clock::now());
            for (std::string& notice : watch.take_notices()) {
                notices.push_back(std::move(notice));
            }
            take_a_nap();
        }));
    }

    /// Welcomes the viewer and answers its subscriptions, the pictures as number 7; its question comes next.
    core::FakeSession begin(Watch&, evod::v1::Role role = evod::v1::ROLE_UNSPECIFIED) {
        core::FakeSession session = server.accept_and_welcome(0, role);
        const auto events = session.read_request();
        EXPECT_TRUE(events.has_subscribe_events());
        session.answer_subscription(events, 6);
        const auto pictures = session.read_request();
        EXPECT_EQ(pictures.subscribe_snapshots().world(), "default");
        EXPECT_EQ(pictures.subscribe_snapshots().island(), 1u);
        session.answer_subscription(pictures, 7);
        return session;
    }

    static void send_picture(core::FakeSession& session, std::uint32_t subscription_id, std::uint32_t island,
                             std::uint64_t tick, const std::string& world = "default", std::uint64_t sequence = 0) {
        evod::v1::SnapshotFrame frame;
        frame.set_width_px(100);
        frame.set_height_px(100);
        codec::encode({}, frame);
        frame.set_world(world);
        frame.set_run_id("\xaa");
        frame.set_subscription_id(subscription_id);
        frame.set_island(island);
        frame.set_island_count(3);
        frame.set_tick(tick);
        frame.set_sequence(sequence); // 0: it is not acknowledged
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

    /// A picture of island 1, and the answer to what the viewer asks on account of it.
    void show_first_picture(Watch& watch, core::FakeSession& session, std::uint64_t tick) {
        send_picture(session, 7, 1, tick);
        until(watch, [&] { return watch.picture() != nullptr; });
        answer_statistics(session, session.read_request());
        until(watch, [&] { return watch.all_answered(); });
    }

    core::FakeServer server;
    std::vector<std::string> notices;
};

TEST_F(WatchTest, ShowsPicturesOfTheIslandAndKnowsItsLastGeneration) {
    Watch watch{wanted()};
    auto session = begin(watch);
    send_picture(session, 7, 1, 50);
    until(watch, [&] { return watch.picture() != nullptr; });
    EXPECT_EQ(watch.picture()->about.tick(), 50u);
    EXPECT_FALSE(watch.all_answered());
    answer_statistics(session, session.read_request());
    until(watch, [&] { return watch.all_answered(); });
    ASSERT_NE(watch.last_generation(), nullptr);
    EXPECT_EQ(watch.last_generation()->fitness_best(), 101);
}

TEST_F(WatchTest, TurnsFromTheLastIslandToTheFirst) {
    Watch watch{wanted()};
    auto session = begin(watch);
    send_picture(session, 7, 1, 50);
    until(watch, [&] { return watch.picture() != nullptr; });
    answer_statistics(session, session.read_request());
    for (const std::uint32_t island : {2u, 0u}) {
        watch.turn_islands(1);
        EXPECT_EQ(watch.picture(), nullptr) << "nothing of the other island stays";
        EXPECT_TRUE(session.read_request().has_unsubscribe());
        const auto pictures = session.read_request();
        EXPECT_EQ(pictures.subscribe_snapshots().island(), island);
        session.answer_subscription(pictures, 20 + island);
        answer_statistics(session, session.read_request());
        send_picture(session, 20 + island, island, 60);
        until(watch, [&] { return watch.picture() != nullptr; });
        EXPECT_EQ(watch.island(), island);
        EXPECT_EQ(watch.picture()->about.island(), island);
    }
}

TEST_F(WatchTest, ARefusedCommandIsToldAndTheStateIsAskedFor) {
    Watch watch{wanted()};
    auto session = begin(watch);
    show_first_picture(watch, session, 50);
    watch.pause_or_resume();
    const auto pause = session.read_request();
    EXPECT_TRUE(pause.has_pause());
    session.refuse(pause.request_id(), evod::v1::CODE_RESOURCE_EXHAUSTED, "the mailbox is full");
    until(watch, [&] { return !notices.empty(); });
    EXPECT_THAT(notices, ElementsAre("The mailbox is full"));
    answer_statistics(session, session.read_request());
    until(watch, [&] { return watch.all_answered(); });
    EXPECT_EQ(watch.control().state(), evod::v1::RUN_STATE_RUNNING);
}

TEST_F(WatchTest, AViewersCommandsAreNotSentAndTheReasonIsTold) {
    Watch watch{wanted()};
    auto session = begin(watch, evod::v1::ROLE_VIEWER);
    show_first_picture(watch, session, 50);
    EXPECT_FALSE(watch.may_command());
    EXPECT_FALSE(watch.may_create());
    watch.pause_or_resume();
    watch.step(1);
    watch.faster();
    watch.slower();
    watch.real_time();
    watch.max_speed();
    watch.at_factor(2);
    watch.run_generations(1);
    watch.reset(std::nullopt);
    EXPECT_TRUE(watch.all_answered()) << "nothing was sent";
    EXPECT_EQ(watch.control().state(), evod::v1::RUN_STATE_RUNNING) << "and nothing is taken as done";
    EXPECT_THAT(watch.take_notices(), testing::AllOf(testing::SizeIs(9), testing::Each(watch.why_only_watching())));
    watch.fork("other");
    EXPECT_TRUE(watch.all_answered());
    EXPECT_THAT(watch.take_notices(), ElementsAre("Only the role admin may make worlds"));
}

TEST_F(WatchTest, EveryPlaceHasANumberThatNoOtherHas) {
    Watch watch{wanted()}, beside{wanted()};
    std::set<std::uint64_t> numbers{watch.place_number(), beside.place_number()};
    const auto add = [&] { numbers.insert(watch.place_number()); };
    watch.choose_island(2);
    add();
    watch.choose_island(2);
    add(); // the same
    watch.look_at("default", 2);
    add();
    watch.show_all_islands(true);
    add();
    watch.choose_island(0);
    add();
    EXPECT_EQ(numbers.size(), 6u);
}

TEST_F(WatchTest, KnowsTheGenesOfTheRunThatIsShown) {
    Watch watch{wanted()};
    auto session = begin(watch);
    until(watch, [&] { return session.unread_bytes() > 0; });
    evod::v1::ServerMessage message;
    message.mutable_response()->set_request_id(session.read_request().request_id());
    auto& world = *message.mutable_response()->mutable_statistics()->mutable_world();
    world = info("default", evod::v1::RUN_STATE_RUNNING);
    world.add_gene_names("impulse");
    session.send(message);
    until(watch, [&] { return watch.all_answered(); });
    EXPECT_THAT(watch.gene_names(), ElementsAre("impulse"));
    watch.look_at("default", 2);
    EXPECT_THAT(watch.gene_names(), ElementsAre("impulse")) << "of any of its islands";
    watch.look_at("other", 0);
    EXPECT_THAT(watch.gene_names(), ElementsAre());
}

TEST_F(WatchTest, TheEndOfAStepIsHeardAfterItsAnswer) {
    Watch watch{wanted()};
    auto session = begin(watch);
    show_first_picture(watch, session, 50);
    watch.step(1); // pauses it first
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
    until(watch, [&] { return watch.control().tick() == 52; });
    const auto step = session.read_request();
    EXPECT_EQ(step.run_until_tick().tick(), 53u);
    answer_with(step, evod::v1::RUN_STATE_RUNNING);
    event.mutable_event()->set_world("default");
    auto& ended = *event.mutable_event()->mutable_run_control_changed()->mutable_world();
    ended = info("default", evod::v1::RUN_STATE_PAUSED);
    ended.set_tick(53);
    session.send(answer);
    session.send(event);
    // The acknowledgement of a snapshot after them shows that both are there, to be taken in together.
    send_picture(session, 7, 1, 51, "default", 1);
    EXPECT_TRUE(session.read().has_acknowledge_snapshot());
    until(watch, [&] { return watch.all_answered() && watch.control().tick() == 53; });
    EXPECT_EQ(watch.control().state(), evod::v1::RUN_STATE_PAUSED);
}

TEST_F(WatchTest, GoesToTheWorldAfterThisOne) {
    Watch watch{wanted()};
    auto session = begin(watch);
    send_picture(session, 7, 1, 50);
    until(watch, [&] { return watch.picture() != nullptr; });
    answer_statistics(session, session.read_request());
    watch.next_world();
    evod::v1::ServerMessage message;
    message.mutable_response()->set_request_id(session.read_request().request_id());
    for (const char* name : {"alpha", "default", "omega"}) {
        *message.mutable_response()->mutable_worlds()->add_worlds() = info(name, evod::v1::RUN_STATE_WAITING);
    }
    session.send(message);
    until(watch, [&] { return watch.world() == "omega"; });
    EXPECT_EQ(watch.island(), 0u);
    EXPECT_FALSE(watch.control().known());
    EXPECT_TRUE(session.read_request().has_unsubscribe());
    EXPECT_EQ(session.read_request().subscribe_snapshots().world(), "omega");
}

TEST_F(WatchTest, GoesToTheNextWorldOnceItIsConnected) {
    Watch watch{wanted()};
    watch.next_world(); // as a half of the window does that was only just opened
    auto session = begin(watch);
    send_picture(session, 7, 1, 50);
    until(watch, [&] { return watch.picture() != nullptr; });
    answer_statistics(session, session.read_request());
    const auto question = session.read_request();
    ASSERT_TRUE(question.has_list_worlds());
    evod::v1::ServerMessage message;
    message.mutable_response()->set_request_id(question.request_id());
    for (const char* name : {"default", "omega"}) {
        *message.mutable_response()->mutable_worlds()->add_worlds() = info(name, evod::v1::RUN_STATE_WAITING);
    }
    session.send(message);
    until(watch, [&] { return watch.world() == "omega"; });
}

TEST_F(WatchTest, AMissingWorldIsLookedAtAsSoonAsItIsMade) {
    Watch watch{wanted()};
    auto session = server.accept_and_welcome();
    session.answer_subscription(session.read_request(), 6);
    session.refuse(session.read_request().request_id(), evod::v1::CODE_NOT_FOUND, "no such world");
    until(watch, [&] { return watch.refusal().has_value(); });
    watch.update(std::chrono::steady_clock::now()); // asks how the world is doing, if it has not yet
    session.refuse(session.read_request().request_id(), evod::v1::CODE_NOT_FOUND, "no such world");
    EXPECT_EQ(*watch.refusal(), "No such world");
    evod::v1::ServerMessage made;
    made.mutable_event()->set_world("default");
    *made.mutable_event()->mutable_world_created()->mutable_world() = info("default", evod::v1::RUN_STATE_WAITING);
    session.send(made);
    until(watch, [&] { return !watch.refusal(); });
    auto request = session.read_request();
    if (request.has_unsubscribe()) {
        request = session.read_request();
    }
    EXPECT_EQ(request.subscribe_snapshots().world(), "default");
}

TEST_F(WatchTest, TellsOfOthersChangesAndFollowsThem) {
    Watch watch{wanted()};
    auto session = begin(watch);
    send_picture(session, 7, 1, 50);
    until(watch, [&] { return watch.picture() != nullptr; });
    answer_statistics(session, session.read_request());
    evod::v1::ServerMessage message;
    message.mutable_event()->set_world("default");
    auto& changed = *message.mutable_event()->mutable_parameters_changed();
    changed.mutable_by()->set_client("evoctl");
    changed.mutable_by()->set_address("127.0.0.1");
    changed.add_changed()->set_name("mutation_chance");
    session.send(message);
    until(watch, [&] { return !notices.empty(); });
    EXPECT_THAT(notices, ElementsAre("evoctl 127.0.0.1 changed mutation_chance"));
    auto paused = info("default", evod::v1::RUN_STATE_PAUSED);
    paused.set_tick(60);
    *message.mutable_event()->mutable_run_control_changed()->mutable_world() = paused;
    session.send(message);
    until(watch, [&] { return watch.control().state() == evod::v1::RUN_STATE_PAUSED; });
    message.mutable_event()->mutable_generation_finished()->add_statistics()->set_island(1);
    message.mutable_event()->mutable_generation_finished()->mutable_statistics(0)->set_fitness_best(222);
    session.send(message);
    until(watch, [&] { return watch.last_generation() && watch.last_generation()->fitness_best() == 222; });
}

TEST_F(WatchTest, KnowsHowItStandsWithTheDisk) {
    Watch watch{wanted()};
    auto session = begin(watch);
    until(watch, [&] { return session.unread_bytes() > 0; });
    const auto question = session.read_request();
    evod::v1::ServerMessage message;
    message.mutable_response()->set_request_id(question.request_id());
    auto& world = *message.mutable_response()->mutable_statistics()->mutable_world();
    world = info("default", evod::v1::RUN_STATE_RUNNING);
    world.mutable_storage()->set_state(evod::v1::STORAGE_STATE_FAILING);
    world.mutable_storage()->set_reason("it is full");
    session.send(message);
    until(watch, [&] { return watch.storage().reason() == "it is full"; });
    auto& told = *message.mutable_event()->mutable_storage_changed()->mutable_storage();
    told.set_state(evod::v1::STORAGE_STATE_STALLED);
    session.send(message);
    until(watch, [&] { return core::worlds_wait(watch.storage()); });
    EXPECT_TRUE(notices.empty());
    told.set_state(evod::v1::STORAGE_STATE_KEEPS_UP);
    session.send(message);
    until(watch, [&] { return !notices.empty(); });
    EXPECT_THAT(notices, ElementsAre("Run files can be written again"));
    EXPECT_FALSE(core::worlds_wait(watch.storage()));
}

TEST_F(WatchTest, AfterALostConnectionEverythingIsAskedForAgain) {
    Watch watch{wanted()};
    {
        auto session = begin(watch);
        show_first_picture(watch, session, 50);
    }
    until(watch, [&] { return watch.connection_status().state != core::State::Connected; });
    EXPECT_NE(watch.picture(), nullptr) << "the last picture stays in sight";
    auto session = begin(watch);
    until(watch, [&] { return !watch.all_answered(); });
    answer_statistics(session, session.read_request());
    send_picture(session, 7, 1, 70);
    until(watch, [&] { return watch.picture()->about.tick() == 70; });
}

TEST_F(WatchTest, WithoutAConnectionItDoesNotSayThatTheWorldRuns) {
    Watch watch{wanted()};
    {
        auto session = begin(watch);
        send_picture(session, 7, 1, 50);
        until(watch, [&] { return watch.picture() != nullptr; });
        answer_statistics(session, session.read_request());
        until(watch, [&] { return watch.state_words() == "running"; });
        EXPECT_EQ(watch.no_connection(), "");
        session.say_goodbye(evod::v1::CODE_UNAUTHENTICATED, "the token has been revoked");
    }
    until(watch, [&] { return watch.state_words() == "no connection"; });
    ASSERT_NE(watch.picture(), nullptr) << "the last is still shown";
}

TEST_F(WatchTest, AReplayThatIsOverSaysSoAndIsNotRun) {
    Watch watch{wanted()};
    auto session = begin(watch);
    send_picture(session, 7, 1, 899);
    until(watch, [&] { return watch.picture() != nullptr; });
    const auto question = session.read_request();
    ASSERT_TRUE(question.has_get_statistics());
    evod::v1::ServerMessage message;
    message.mutable_response()->set_request_id(question.request_id());
    auto& world = *message.mutable_response()->mutable_statistics()->mutable_world();
    world = info("default", evod::v1::RUN_STATE_WAITING);
    world.set_tick(899);
    world.mutable_replay()->set_last_tick(900);
    session.send(message);
    until(watch, [&] { return watch.replay() != nullptr; });
    EXPECT_FALSE(watch.at_the_end());
    EXPECT_EQ(watch.state_words(), "waiting – Space runs");
    message.Clear();
    message.mutable_event()->set_world("default");
    auto& told = *message.mutable_event()->mutable_run_control_changed()->mutable_world();
    told = info("default", evod::v1::RUN_STATE_PAUSED);
    told.set_tick(900);
    told.mutable_replay()->set_last_tick(900);
    session.send(message);
    until(watch, [&] { return watch.at_the_end(); });
    EXPECT_EQ(watch.state_words(), "at the end of the recording");
    watch.pause_or_resume();
    watch.step(1);
    watch.next_world();
    EXPECT_TRUE(session.read_request().has_list_worlds()) << "nothing else was sent";
    until(watch, [&] { return notices.size() == 2; });
    EXPECT_THAT(notices[0], testing::HasSubstr("the end of the recording"));
}

TEST_F(WatchTest, AllIslandsComeOverOneSubscription) {
    Watch::Wanted all = wanted();
    all.all_islands = true;
    Watch watch{all};
    core::FakeSession session = server.accept_and_welcome();
    session.answer_subscription(session.read_request(), 6);
    const auto pictures = session.read_request();
    EXPECT_FALSE(pictures.subscribe_snapshots().has_island());
    session.answer_subscription(pictures, 7);
    for (const std::uint32_t island : {0u, 1u, 2u}) {
        send_picture(session, 7, island, 50 + island);
    }
    until(watch, [&] { return watch.picture_of(0) && watch.picture_of(1) && watch.picture_of(2); });
    answer_statistics(session, session.read_request());
    EXPECT_EQ(watch.island_count(), 3u);
    EXPECT_EQ(watch.picture()->about.tick(), 51u) << "of the island that is chosen";
    watch.turn_islands(1);
    EXPECT_EQ(watch.picture()->about.tick(), 52u) << "there already";
    watch.show_all_islands(false);
    EXPECT_TRUE(session.read_request().has_unsubscribe());
    EXPECT_EQ(session.read_request().subscribe_snapshots().island(), 2u);
}

/// In the past of the world, paused.
struct PastTest : WatchTest {
    static evod::v1::WorldInfo past(std::uint64_t tick) {
        evod::v1::WorldInfo world = info("default@3", evod::v1::RUN_STATE_PAUSED);
        world.set_tick(tick);
        auto& recording = *world.mutable_replay();
        recording.set_replay_of("default");
        recording.set_first_generation(1);
        recording.set_last_generation(9);
        recording.set_last_tick(900);
        return world;
    }
    static void answer_with(core::FakeSession& session, const evod::v1::Request& request,
                            const evod::v1::WorldInfo& world) {
        evod::v1::ServerMessage message;
        message.mutable_response()->set_request_id(request.request_id());
        *message.mutable_response()->mutable_world() = world;
        session.send(message);
    }
    /// The next request but for questions how far the past reaches, which are answered.
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
                                                              : past(100);
            session.send(message);
        }
    }
    /// Watches the past, with pictures as subscription 9.
    core::FakeSession look_back(Watch& watch, evod::v1::Role role = evod::v1::ROLE_UNSPECIFIED) {
        auto session = begin(watch, role);
        show_first_picture(watch, session, 850);
        watch.open_replay({});
        const auto open = session.read_request();
        EXPECT_EQ(open.open_replay().world(), "default");
        answer_with(session, open, past(100));
        until(watch, [&] { return watch.opened_past(); });
        EXPECT_EQ(next(session).unsubscribe().subscription_id(), 7u);
        const auto pictures = next(session);
        EXPECT_EQ(pictures.subscribe_snapshots().world(), "default@3");
        session.answer_subscription(pictures, 9);
        const auto events = next(session);
        EXPECT_EQ(events.subscribe_events().world(), "default@3") << "those of all worlds leave it out";
        session.answer_subscription(events, 10);
        send_picture(session, 9, 1, 100, "default@3"); // once it is there the answers are, too
        until(watch, [&] { return watch.picture() != nullptr; });
        return session;
    }
};

TEST_F(PastTest, IsAWorldOfItsOwnUntilOneReturnsToThePresent) {
    Watch watch{wanted()};
    auto session = look_back(watch);
    ASSERT_NE(watch.replay(), nullptr);
    EXPECT_EQ(watch.replay()->last_tick(), 900u);
    EXPECT_EQ(watch.world(), "default@3");
    EXPECT_EQ(watch.island(), 1u);
    watch.return_to_present();
    EXPECT_EQ(watch.world(), "default");
    EXPECT_EQ(watch.replay(), nullptr);
    EXPECT_EQ(next(session).unsubscribe().subscription_id(), 10u);
    EXPECT_EQ(next(session).close_replay().world(), "default@3");
    EXPECT_EQ(next(session).unsubscribe().subscription_id(), 9u);
    EXPECT_EQ(next(session).subscribe_snapshots().world(), "default");
}

TEST_F(PastTest, OfManySeeksTheNewestFollowsTheOneUnderWay) {
    Watch watch{wanted()};
    auto session = look_back(watch);
    for (const std::uint64_t tick : {200u, 300u, 400u}) {
        evod::v1::RunMoment moment;
        moment.set_tick(tick);
        watch.seek(moment);
    }
    auto seek = next(session);
    EXPECT_EQ(seek.seek().world(), "default@3");
    EXPECT_EQ(seek.seek().to().tick(), 200u);
    answer_with(session, seek, past(200));
    until(watch, [&] { return watch.control().tick() == 200; });
    seek = next(session);
    EXPECT_EQ(seek.seek().to().tick(), 400u);
    ASSERT_NE(watch.sought(), nullptr);
    answer_with(session, seek, past(400));
    until(watch, [&] { return watch.sought() == nullptr; });
    EXPECT_EQ(watch.control().tick(), 400u);
}

TEST_F(PastTest, GenerationsAreTurnedFromTheOneLastAskedForAndWithinTheRun) {
    Watch watch{wanted()};
    auto session = look_back(watch);
    evod::v1::RunMoment moment;
    moment.set_generation(4);
    watch.seek(moment);
    watch.turn_generations(-1);
    watch.turn_generations(-1);
    EXPECT_EQ(watch.sought()->generation(), 2u);
    watch.turn_generations(-5);
    EXPECT_EQ(watch.sought()->generation(), 1u);
    watch.turn_generations(50);
    EXPECT_EQ(watch.sought()->generation(), 9u);
}

TEST_F(PastTest, APastThatCannotBeOpenedIsTold) {
    Watch watch{wanted()};
    auto session = begin(watch);
    show_first_picture(watch, session, 850);
    watch.open_replay({});
    EXPECT_FALSE(watch.all_answered());
    session.refuse(session.read_request().request_id(), evod::v1::CODE_FAILED_PRECONDITION, "the server keeps no runs");
    until(watch, [&] { return !notices.empty(); });
    EXPECT_THAT(notices, ElementsAre("The server keeps no runs"));
    EXPECT_FALSE(watch.opened_past());
    EXPECT_EQ(watch.world(), "default");
}

TEST_F(PastTest, AForkIsMadeFromWhatIsShown) {
    Watch watch{wanted()};
    auto session = look_back(watch);
    watch.fork("other");
    const auto fork = next(session);
    EXPECT_EQ(fork.fork_world().world(), "default@3");
    EXPECT_EQ(fork.fork_world().name(), "other");
    EXPECT_FALSE(fork.fork_world().has_at_generation());
    answer_with(session, fork, info("other", evod::v1::RUN_STATE_WAITING));
    until(watch, [&] { return watch.forked() == "other"; });
    watch.return_to_present();
    EXPECT_EQ(watch.forked(), "other") << "still beside it";
    watch.look_at("elsewhere", 0);
    EXPECT_EQ(watch.forked(), "");
}

TEST_F(PastTest, AForkThatIsDeletedIsForgotten) {
    Watch watch{wanted()};
    auto session = look_back(watch);
    watch.fork("other");
    answer_with(session, next(session), info("other", evod::v1::RUN_STATE_WAITING));
    until(watch, [&] { return watch.forked() == "other"; });
    evod::v1::ServerMessage deleted;
    deleted.mutable_event()->set_world("other");
    deleted.mutable_event()->mutable_world_deleted()->mutable_by()->set_user("somebody");
    session.send(deleted);
    until(watch, [&] { return watch.forked().empty(); });
}

TEST_F(PastTest, AViewerMayRunItsOwnLookAtThePast) {
    Watch watch{wanted()};
    auto session = look_back(watch, evod::v1::ROLE_VIEWER);
    EXPECT_TRUE(watch.may_command());
    evod::v1::RunMoment moment;
    moment.set_tick(200);
    watch.seek(moment);
    EXPECT_EQ(next(session).seek().to().tick(), 200u);
    watch.return_to_present();
    EXPECT_FALSE(watch.may_command());
}

} // namespace
} // namespace evod::viewer
