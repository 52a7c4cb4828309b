#include "server/network/streams.h"

#include "tests/unit/network/loopback.h"

#include <chrono>

namespace evod::network {
namespace {

using access::Role;

class StreamsTest : public Loopback {
  protected:
    StreamsTest() {
        host.ended = [this](Session& ended) {
            sessions.erase(ended.number());
            streams.forget(ended);
        };
    }

    static v1::Event paused(const std::string& world) {
        v1::Event event;
        event.set_world(world);
        v1::Actor& by = *event.mutable_run_control_changed()->mutable_by();
        by.set_user("anna");
        by.set_client("evoctl");
        by.set_address("127.0.0.1:9");
        return event;
    }
    static streaming::SnapshotSubscription snapshots_of(const std::string& world, double rate_hz) {
        streaming::SnapshotSubscription subscription;
        subscription.world = world;
        subscription.rate_hz = rate_hz;
        return subscription;
    }
    void publish(const std::string& world) {
        streams.publish(paused(world));
        settle();
    }

    runtime::Simulations simulations{false};
    runtime::StreamDemand& demand = simulations.part_of("").demand;
    runtime::Mailbox& mailbox = simulations.mailbox_of("");
    Streams streams{sessions, simulations, memory};
};

TEST_F(StreamsTest, EventsGoToTheSubscribersOfTheirWorld) {
    Client &all = connect(Role::Admin), &one = connect(Role::Admin), &none = connect(Role::Admin);
    streams.subscribe(*all.session, EventSubscription{});
    streams.subscribe(*one.session, EventSubscription{.world = "a"});
    publish("a");
    publish("b");
    ASSERT_EQ(all.events.size(), 2u);
    EXPECT_EQ(all.events[1].world(), "b");
    EXPECT_GT(all.events[1].time_ms(), 0);
    ASSERT_EQ(one.events.size(), 1u);
    EXPECT_EQ(one.events[0].world(), "a");
    EXPECT_TRUE(none.events.empty());
    publish(""); // of the whole server
    EXPECT_EQ(all.events.size(), 3u);
    EXPECT_EQ(one.events.size(), 2u);
}

TEST_F(StreamsTest, UnsubscribingFromNothingChangesNothing) {
    Client& client = connect(Role::Viewer);
    streams.subscribe(*client.session, EventSubscription{});
    mailbox.drain();
    EXPECT_FALSE(streams.unsubscribe(*client.session, 99));
    EXPECT_FALSE(mailbox.pending()) << "the simulation thread is not woken";
    EXPECT_TRUE(streams.unsubscribe(*client.session, 1));
    EXPECT_TRUE(mailbox.pending());
}

TEST_F(StreamsTest, ASubscriptionCountsAsMemoryOfItsSession) {
    Client& client = connect(Role::Viewer);
    const std::size_t before = client.session->held_bytes();
    const std::uint32_t id = streams.subscribe(*client.session, snapshots_of("w", 1));
    EXPECT_GT(client.session->held_bytes(), before);
    EXPECT_TRUE(streams.unsubscribe(*client.session, id));
    EXPECT_EQ(client.session->held_bytes(), before);
}

TEST_F(StreamsTest, EventsOfReplaysGoToTheirOwnSubscribers) {
    const std::string replay = "w@1"; // no name of a world
    Client &all = connect(Role::Admin), &one = connect(Role::Admin);
    streams.subscribe(*all.session, EventSubscription{});
    streams.subscribe(*one.session, EventSubscription{.world = replay});
    publish(replay);
    EXPECT_TRUE(all.events.empty());
    EXPECT_EQ(one.events.size(), 1u);
}

TEST_F(StreamsTest, ASessionWithTwoSubscriptionsGetsAnEventOnce) {
    Client& client = connect(Role::Admin);
    streams.subscribe(*client.session, EventSubscription{});
    streams.subscribe(*client.session, EventSubscription{.world = "a"});
    publish("a");
    EXPECT_EQ(client.events.size(), 1u);
}

TEST_F(StreamsTest, ViewersSeeOnlyTheUserOfAChange) {
    Client &viewer = connect(Role::Viewer), &controller = connect(Role::Controller);
    streams.subscribe(*viewer.session, EventSubscription{});
    streams.subscribe(*controller.session, EventSubscription{});
    publish("a");
    ASSERT_EQ(viewer.events.size(), 1u);
    EXPECT_EQ(viewer.events[0].run_control_changed().by().user(), "anna");
    EXPECT_EQ(viewer.events[0].run_control_changed().by().client(), "");
    EXPECT_EQ(viewer.events[0].run_control_changed().by().address(), "");
    ASSERT_EQ(controller.events.size(), 1u);
    EXPECT_EQ(controller.events[0].run_control_changed().by().client(), "evoctl");
}

TEST_F(StreamsTest, DroppedEventsAreReportedToSubscribers) {
    Client &subscriber = connect(Role::Admin), &other = connect(Role::Admin);
    streams.subscribe(*subscriber.session, EventSubscription{.world = "a"});
    streams.deliver({.deliveries = {}, .dropped_events = {{"", 3}}, .snapshots = {}});
    settle();
    publish("a");
    publish("b");
    std::uint64_t dropped = 0;
    for (const v1::Event& event : subscriber.events) {
        dropped += event.events_dropped().dropped_count();
    }
    EXPECT_EQ(dropped, 3u);
    EXPECT_TRUE(other.events.empty());
}

TEST_F(StreamsTest, DemandFollowsTheSubscriptions) {
    Client& client = connect(Role::Admin);
    EXPECT_FALSE(demand.events_wanted());
    mailbox.drain();
    const std::uint32_t events = streams.subscribe(*client.session, EventSubscription{});
    EXPECT_TRUE(demand.events_wanted());
    EXPECT_TRUE(mailbox.pending()) << "the simulation thread is woken";
    const std::uint32_t slow = streams.subscribe(*client.session, snapshots_of("a", 2));
    const std::uint32_t fast = streams.subscribe(*client.session, snapshots_of("a", 60));
    EXPECT_EQ(demand.take().at("a").rate_hz, 60);
    EXPECT_TRUE(streams.unsubscribe(*client.session, fast));
    EXPECT_EQ(demand.take().at("a").rate_hz, 2);
    EXPECT_TRUE(streams.unsubscribe(*client.session, slow));
    EXPECT_TRUE(demand.take().empty());
    EXPECT_TRUE(streams.unsubscribe(*client.session, events));
    EXPECT_FALSE(demand.events_wanted());
    EXPECT_FALSE(streams.unsubscribe(*client.session, events));
    EXPECT_FALSE(streams.send_keyframes(*client.session, slow));
}

TEST_F(StreamsTest, AnEndedSessionDemandsNothing) {
    Client &first = connect(Role::Admin), &second = connect(Role::Admin);
    streams.subscribe(*first.session, EventSubscription{});
    streams.subscribe(*first.session, snapshots_of("a", 60));
    streams.subscribe(*second.session, snapshots_of("b", 5));
    first.session->close();
    settle();
    EXPECT_FALSE(demand.events_wanted());
    const runtime::WorldDemands worlds = demand.take();
    EXPECT_FALSE(worlds.contains("a"));
    EXPECT_TRUE(worlds.contains("b"));
}

TEST_F(StreamsTest, SnapshotsReachTheirSubscription) {
    Client& client = connect(Role::Admin);
    const std::uint32_t id = streams.subscribe(*client.session, snapshots_of("a", 60));
    auto snapshot = std::make_shared<runtime::Snapshot>();
    snapshot->world = "a";
    snapshot->moment.tick = 17;
    snapshot->island_count = 1;
    snapshot->islands.resize(1);
    snapshot->islands[0].width_px = snapshot->islands[0].height_px = 100;
    runtime::Outbox::Taken taken;
    taken.snapshots.push_back({.snapshot = snapshot, .after_change = true});
    streams.deliver(std::move(taken));
    while (streams.send_some(clock.now())) {
        // The next islands.
    }
    settle();
    ASSERT_EQ(client.snapshots.size(), 1u);
    EXPECT_EQ(client.snapshots[0].subscription_id(), id);
    EXPECT_EQ(client.snapshots[0].world(), "a");
    EXPECT_EQ(client.snapshots[0].tick(), 17u);
}

TEST_F(StreamsTest, TheEndIsAnnouncedToEverySession) {
    Client& client = connect(Role::Viewer); // without a subscription
    streams.announce_end();
    settle();
    ASSERT_EQ(client.events.size(), 1u);
    EXPECT_TRUE(client.events[0].has_server_going_away());
    EXPECT_FALSE(client.ended);
    streams.end_sessions();
    settle();
    EXPECT_TRUE(client.ended);
}

} // namespace
} // namespace evod::network
