#include "tests/unit/viewer/world/viewed_world_fixture.h"

namespace evod::viewer {
namespace {

using testing::ElementsAre;

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
    message.mutable_event()->set_text("evoctl 127.0.0.1 set mutation_chance to 0.5, revision 2");
    session.send(message);
    until(world, [&] { return !notices.empty(); });
    EXPECT_THAT(notices, ElementsAre("Evoctl 127.0.0.1 set mutation_chance to 0.5, revision 2"));
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

TEST_F(ViewedWorldTest, LinksToTheShownMoment) {
    ViewedWorld world{wanted()};
    EXPECT_EQ(world.link(), "");
    auto session = begin(world);
    show_first_snapshot(world, session, 50);
    const evod::v1::SnapshotFrame& shown = world.feed.snapshot()->about;
    const std::string moment = "http://lab:7745/#world=default&generation=" + std::to_string(shown.generation()) +
                               "&tick=" + std::to_string(shown.generation_tick());
    EXPECT_THAT(world.link(), testing::StartsWith(moment));
    world.feed.select(4);
    EXPECT_EQ(world.live_link(), "http://lab:7745/#world=default");
    EXPECT_EQ(world.link(), moment + "&island=" + std::to_string(shown.island()) + "&organism=4");
}

} // namespace
} // namespace evod::viewer
