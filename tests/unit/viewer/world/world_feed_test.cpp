#include "tests/unit/viewer/world/viewed_world_fixture.h"

#include <set>

namespace evod::viewer {
namespace {

using testing::ElementsAre;

struct WorldFeedTest : ViewedWorldTest {};

TEST_F(WorldFeedTest, ReceivesSnapshotsAndTheLastGeneration) {
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

TEST_F(WorldFeedTest, NamesTheWorldThatTheServerHasChosen) {
    ViewedWorld world{{.connection = server.options(), .world = "", .island = 1}};
    core::FakeSession session = server.accept_and_welcome();
    session.answer_subscription(session.read_request(), 6);
    const auto snapshots = session.read_request();
    EXPECT_EQ(snapshots.subscribe_snapshots().world(), "");
    session.answer_subscription(snapshots, 7);
    send_snapshot(session, 7, 1, 50, "lab");
    until(world, [&] { return world.feed.snapshot() != nullptr; });
    EXPECT_EQ(world.feed.world(), "lab");
    answer_statistics(session, session.read_request());
    world.feed.choose_island(2);
    EXPECT_TRUE(session.read_request().has_unsubscribe());
    EXPECT_EQ(session.read_request().subscribe_snapshots().world(), "lab");
}

TEST_F(WorldFeedTest, CyclesFromTheLastIslandToTheFirst) {
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

TEST_F(WorldFeedTest, ReceivesAllIslandsInOneSubscription) {
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

TEST_F(WorldFeedTest, EveryPlaceHasAUniqueNumber) {
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

TEST_F(WorldFeedTest, KnowsTheGenesOfTheShownRun) {
    ViewedWorld world{wanted()};
    auto session = begin(world);
    until(world, [&] { return session.unread_bytes() > 0; });
    evod::v1::ServerMessage message;
    message.mutable_response()->set_request_id(session.read_request().request_id());
    auto& reported = *message.mutable_response()->mutable_statistics()->mutable_world();
    reported = info("default", evod::v1::RUN_STATE_RUNNING);
    reported.add_gene_names("free0");
    session.send(message);
    until(world, [&] { return world.all_answered(); });
    EXPECT_THAT(world.feed.gene_names(), testing::AllOf(testing::SizeIs(7), testing::Contains("free0")));
    world.show("default", 2);
    EXPECT_THAT(world.feed.gene_names(), testing::SizeIs(7)) << "the same on every island";
    world.show("other", 0);
    EXPECT_THAT(world.feed.gene_names(), ElementsAre());
}

TEST_F(WorldFeedTest, KnowsTheStateOfTheDisk) {
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
    reported.mutable_storage()->set_text("commands are refused: it is full");
    session.send(message);
    until(world, [&] { return world.feed.storage().reason() == "it is full"; });
    auto& storage = *message.mutable_event()->mutable_storage_changed()->mutable_storage();
    storage.set_state(evod::v1::STORAGE_STATE_STALLED);
    storage.set_text("worlds wait for the disk");
    session.send(message);
    until(world, [&] { return core::worlds_wait(world.feed.storage()); });
    EXPECT_TRUE(notices.empty());
    storage.set_state(evod::v1::STORAGE_STATE_KEEPS_UP);
    storage.clear_text();
    message.mutable_event()->set_text("run files can be written again");
    session.send(message);
    until(world, [&] { return !notices.empty(); });
    EXPECT_THAT(notices, ElementsAre("Run files can be written again"));
    EXPECT_FALSE(core::worlds_wait(world.feed.storage()));
}

TEST_F(WorldFeedTest, SubscribesAgainAfterALostConnection) {
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

} // namespace
} // namespace evod::viewer
