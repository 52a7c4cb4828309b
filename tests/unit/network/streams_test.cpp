// Pictures on their way from the outbox to sessions that have not begun to send.
#include "server/network/streams.h"

#include "tests/support/manual_clock.h"

#include <boost/asio/io_context.hpp>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

namespace evod::network {
namespace {

constexpr std::uint32_t many = 1000; // islands, for which one turn is too short

class StreamsTest : public testing::Test {
  protected:
    StreamsTest() { host.clock = &clock; }

    /// Its subscription has number 1.
    SessionPtr subscribed(const std::string& world, v1::Codec codec = v1::CODEC_COLUMNS) {
        const std::uint64_t number = sessions.size() + 1;
        const SessionPtr session = std::make_shared<Session>(tcp::socket{context}, host, number);
        sessions.emplace(number, session);
        SnapshotSubscription subscription;
        subscription.world = world;
        subscription.codec = codec;
        subscription.rate_hz = 60;
        EXPECT_EQ(streams.subscribe(*session, std::move(subscription)), 1u);
        return session;
    }

    void deliver(const std::string& world, std::uint32_t island_count, std::uint64_t tick = 0) {
        auto snapshot = std::make_shared<runtime::Snapshot>();
        snapshot->world = world;
        snapshot->moment.tick = tick;
        snapshot->island_count = island_count;
        snapshot->islands.resize(island_count);
        for (std::uint32_t i = 0; i < island_count; ++i) {
            snapshot->islands[i].island = i;
            snapshot->islands[i].width_px = snapshot->islands[i].height_px = 100;
        }
        runtime::Outbox::Taken taken;
        taken.pictures.push_back({.snapshot = std::move(snapshot), .after_change = true});
        streams.deliver(std::move(taken));
    }

    void send_all() {
        while (streams.send_some(clock.now())) {
            // The next islands.
        }
    }

    /// Ticks of the pictures that wait to be sent, by island.
    static std::vector<std::uint64_t> ticks(const SessionPtr& session) {
        std::vector<std::uint64_t> told;
        for (const auto& [number, island] : session->snapshots.at(1).islands) {
            v1::SnapshotFrame frame;
            EXPECT_TRUE(frame.ParseFromString(*island.waiting.columns));
            EXPECT_EQ(frame.island(), number);
            told.push_back(frame.tick());
        }
        return told;
    }

    static std::size_t waiting_count(const SessionPtr& session) { return session->snapshots.at(1).islands.size(); }

    support::ManualClock clock;
    LimitCounters counters;
    Buffers buffers{std::size_t{1} << 30, [] {}};
    SessionHost host{counters, buffers};
    asio::io_context context;
    Sessions sessions;
    runtime::Demand demand;
    runtime::Mailbox mailbox;
    Streams streams{sessions, demand, mailbox};
};

TEST_F(StreamsTest, OneTurnHandsOutAWorldOfAFewIslands) {
    const SessionPtr viewer = subscribed("few");
    deliver("few", 4, 7);
    EXPECT_FALSE(streams.send_some(clock.now()));
    EXPECT_EQ(ticks(viewer), std::vector<std::uint64_t>(4, 7));
}

TEST_F(StreamsTest, OtherWorldsAreServedBetweenTheTurnsOfALargeOne) {
    const SessionPtr of_many = subscribed("many"), of_few = subscribed("few", v1::CODEC_DELTA);
    deliver("many", many);
    EXPECT_TRUE(streams.send_some(clock.now()));
    EXPECT_GT(waiting_count(of_many), 0u);
    deliver("few", 4);
    for (int turn = 0; turn < 2; ++turn) { // one of each
        EXPECT_TRUE(streams.send_some(clock.now()));
    }
    EXPECT_EQ(waiting_count(of_few), 4u);
    EXPECT_LT(waiting_count(of_many), many);
    send_all();
    EXPECT_EQ(ticks(of_many), std::vector<std::uint64_t>(many, 0));
}

TEST_F(StreamsTest, ThePictureThatComesMeanwhileFollows) {
    const SessionPtr viewer = subscribed("many");
    for (const std::uint64_t tick : {1, 2, 3}) { // 3 replaces 2
        deliver("many", many, tick);
        EXPECT_TRUE(streams.send_some(clock.now()));
    }
    send_all();
    EXPECT_EQ(ticks(viewer), std::vector<std::uint64_t>(many, 3));
    // Of each island the picture of tick 1 was replaced, and the picture of tick 2 was once.
    EXPECT_EQ(viewer->snapshots.at(1).dropped_count, many + 1);
}

TEST_F(StreamsTest, NothingOfAForgottenWorldIsHandedOut) {
    const SessionPtr viewer = subscribed("many", v1::CODEC_DELTA);
    deliver("many", many);
    EXPECT_TRUE(streams.send_some(clock.now()));
    streams.forget_world("many");
    EXPECT_FALSE(streams.send_some(clock.now()));
    EXPECT_EQ(waiting_count(viewer), 0u);
}

TEST_F(StreamsTest, WhoComesAndGoesMeanwhileGetsTheNewestOfAll) {
    const SessionPtr goes = subscribed("many", v1::CODEC_DELTA);
    deliver("many", many);
    EXPECT_TRUE(streams.send_some(clock.now()));
    const SessionPtr comes = subscribed("many", v1::CODEC_DELTA);
    EXPECT_TRUE(streams.unsubscribe(*goes, 1));
    send_all();
    EXPECT_EQ(waiting_count(comes), many);
    EXPECT_TRUE(streams.unsubscribe(*comes, 1));
    deliver("many", many);
    EXPECT_FALSE(streams.send_some(clock.now())) << "nobody is left";
}

} // namespace
} // namespace evod::network
