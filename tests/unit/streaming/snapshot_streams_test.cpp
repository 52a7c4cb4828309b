#include "server/streaming/snapshot_streams.h"

#include "tests/support/manual_clock.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

namespace evod::streaming {
namespace {

constexpr std::uint32_t many = 1000; // islands, too many for one turn

/// A session that never sends.
struct Session final : SnapshotSender {
    Session(runtime::Clock& clock, metrics::Counter& dropped) : queue{clock, dropped, *this} {}
    void send_snapshots() override { ++sends; }
    void send_snapshots_later() override { ++later_sends; }

    std::uint64_t number = 0;
    SnapshotQueue queue;
    int sends = 0, later_sends = 0;
};

class SnapshotStreamsTest : public testing::Test {
  protected:
    /// A session with one subscription, of id 1.
    Session& subscribed(const std::string& world, v1::Codec codec = v1::CODEC_UNSPECIFIED, double rate_hz = 60,
                        OptionalColumns with = {}) {
        Session& session = *sessions.emplace_back(std::make_unique<Session>(clock, dropped));
        session.number = sessions.size();
        SnapshotSubscription subscription;
        subscription.world = world;
        subscription.rate_hz = rate_hz;
        subscription.with = with;
        if (codec != v1::CODEC_UNSPECIFIED) {
            subscription.codec = codec;
        }
        streams.subscribe(session.number, session.queue, 1, std::move(subscription));
        return session;
    }
    bool unsubscribe(Session& session) { return streams.unsubscribe(session.number, session.queue, 1); }

    void deliver(const std::string& world, std::uint32_t island_count, std::uint64_t tick = 0,
                 bool after_change = true) {
        auto snapshot = std::make_shared<runtime::Snapshot>();
        snapshot->world = world;
        snapshot->moment.tick = tick;
        snapshot->island_count = island_count;
        snapshot->islands.resize(island_count);
        for (std::uint32_t i = 0; i < island_count; ++i) {
            snapshot->islands[i].island = i;
            snapshot->islands[i].width_px = snapshot->islands[i].height_px = 100;
        }
        std::vector<runtime::Outbox::NewestSnapshot> taken;
        taken.push_back({.snapshot = std::move(snapshot), .after_change = after_change});
        streams.deliver(std::move(taken));
    }
    bool distribute() { return streams.distribute(clock.now()); }
    void distribute_all() {
        while (distribute()) {
            // The next islands.
        }
    }

    /// Ticks of the snapshots that wait to be sent, by island.
    static std::vector<std::uint64_t> ticks(Session& session) {
        std::vector<std::uint64_t> ticks;
        while (const OutgoingFrame* outgoing = session.queue.next()) {
            v1::SnapshotFrame frame;
            EXPECT_TRUE(frame.ParseFromString(*outgoing->parts.front()->get()));
            EXPECT_EQ(frame.island(), ticks.size());
            ticks.push_back(frame.tick());
        }
        return ticks;
    }
    static std::size_t waiting_count(Session& session) { return session.queue.subscriptions.at(1).islands.size(); }

    support::ManualClock clock;
    metrics::Counter dropped;
    std::vector<std::unique_ptr<Session>> sessions;
    SnapshotStreams streams;
};

TEST_F(SnapshotStreamsTest, OneTurnDistributesAFewIslands) {
    Session& viewer = subscribed("few");
    deliver("few", 4, 7);
    EXPECT_FALSE(distribute());
    EXPECT_EQ(viewer.sends, 1);
    EXPECT_EQ(ticks(viewer), std::vector<std::uint64_t>(4, 7));
}

TEST_F(SnapshotStreamsTest, OptionalColumnsAreSentToThoseWhoWantThem) {
    Session &without = subscribed("w"), &with_headings = subscribed("w", v1::CODEC_PLAIN, 60, {.headings = true}),
            &with_both = subscribed("w", v1::CODEC_PLAIN, 60, {.headings = true, .species = true});
    auto snapshot = std::make_shared<runtime::Snapshot>();
    snapshot->world = "w";
    snapshot->island_count = 1;
    snapshot->islands.resize(1);
    runtime::OrganismsSnapshot& organisms = snapshot->islands[0].organisms;
    organisms.place_of.assign(1, 0U);
    organisms.x.assign(1, 0);
    organisms.y.assign(1, 0);
    for (auto* column : {&organisms.radius_px, &organisms.health, &organisms.heading}) {
        column->assign(1, 0.F);
    }
    organisms.species = {simulation::Species::Predator};
    organisms.alive_count = 1;
    std::vector<runtime::Outbox::NewestSnapshot> taken;
    taken.push_back({.snapshot = std::move(snapshot), .after_change = true});
    streams.deliver(std::move(taken));
    distribute_all();
    const auto counts = [](Session& session) {
        v1::SnapshotFrame frame;
        EXPECT_TRUE(frame.ParseFromString(*session.queue.next()->parts.front()->get()));
        EXPECT_EQ(frame.plain().organisms().id_size(), 1);
        return std::pair{frame.plain().organisms().heading_size(), frame.plain().organisms().species_size()};
    };
    EXPECT_EQ(counts(with_both), (std::pair{1, 1}));
    EXPECT_EQ(counts(with_headings), (std::pair{1, 0}));
    EXPECT_EQ(counts(without), (std::pair{0, 0}));
}

TEST_F(SnapshotStreamsTest, RequestedKeyframesComeOncePerPeriod) {
    Session& viewer = subscribed("few", v1::CODEC_DELTA, 10);
    deliver("few", 4, 7);
    distribute_all();
    EXPECT_EQ(ticks(viewer).size(), 4U);
    EXPECT_EQ(streams.send_keyframes(viewer.queue, 1), 4U);
    EXPECT_EQ(ticks(viewer).size(), 4U);
    EXPECT_EQ(streams.send_keyframes(viewer.queue, 1), 4U);
    EXPECT_EQ(streams.send_keyframes(viewer.queue, 1), 4U) << "they cost as much";
    EXPECT_TRUE(ticks(viewer).empty());
    clock.advance(std::chrono::milliseconds{100});
    EXPECT_EQ(ticks(viewer).size(), 4U);
    clock.advance(std::chrono::milliseconds{100});
    EXPECT_TRUE(ticks(viewer).empty());
    EXPECT_EQ(streams.send_keyframes(viewer.queue, 2), std::nullopt);
}

TEST_F(SnapshotStreamsTest, ARareStreamGivesKeyframesEachSecond) {
    Session& viewer = subscribed("few", v1::CODEC_DELTA, 0.001);
    deliver("few", 1, 7);
    distribute_all();
    for (int second = 0; second < 3; ++second) {
        streams.send_keyframes(viewer.queue, 1);
        clock.advance(std::chrono::seconds{1});
        EXPECT_EQ(ticks(viewer).size(), 1U);
    }
}

TEST_F(SnapshotStreamsTest, OtherWorldsAreServedBetweenTurns) {
    Session &of_many = subscribed("many"), &of_few = subscribed("few", v1::CODEC_DELTA);
    deliver("many", many);
    EXPECT_TRUE(distribute());
    EXPECT_GT(waiting_count(of_many), 0U);
    deliver("few", 4);
    for (int turn = 0; turn < 2; ++turn) { // one of each
        EXPECT_TRUE(distribute());
    }
    EXPECT_EQ(waiting_count(of_few), 4U);
    EXPECT_LT(waiting_count(of_many), many);
    distribute_all();
    EXPECT_EQ(ticks(of_many), std::vector<std::uint64_t>(many, 0));
}

TEST_F(SnapshotStreamsTest, TheNextSnapshotFollowsTheOneInProgress) {
    Session& viewer = subscribed("many");
    for (const std::uint64_t tick : {1, 2, 3}) { // 3 replaces 2
        deliver("many", many, tick);
        EXPECT_TRUE(distribute());
    }
    distribute_all();
    // For each island the snapshot of tick 1 was replaced, and the snapshot of tick 2 was replaced once.
    EXPECT_EQ(viewer.queue.subscriptions.at(1).dropped_count, many + 1);
    EXPECT_EQ(dropped.value(), many + 1);
    EXPECT_EQ(ticks(viewer), std::vector<std::uint64_t>(many, 3));
}

TEST_F(SnapshotStreamsTest, ADeletedWorldIsNotDistributed) {
    Session& viewer = subscribed("many", v1::CODEC_DELTA);
    deliver("many", many);
    EXPECT_TRUE(distribute());
    streams.forget_world("many");
    EXPECT_FALSE(distribute());
    EXPECT_EQ(waiting_count(viewer), 0U);
}

TEST_F(SnapshotStreamsTest, AViewerThatJoinsMidwayGetsAllIslands) {
    Session& leaves = subscribed("many", v1::CODEC_DELTA);
    deliver("many", many);
    EXPECT_TRUE(distribute());
    Session& joins = subscribed("many", v1::CODEC_DELTA);
    EXPECT_TRUE(unsubscribe(leaves));
    EXPECT_FALSE(unsubscribe(leaves));
    distribute_all();
    EXPECT_EQ(waiting_count(joins), many);
    EXPECT_TRUE(unsubscribe(joins));
    deliver("many", many);
    EXPECT_FALSE(distribute()) << "there is no viewer";
    EXPECT_TRUE(streams.demand().empty());
}

TEST_F(SnapshotStreamsTest, AViewerThatJoinsAGroupGetsTheNewest) {
    for (const v1::Codec codec : {v1::CODEC_UNSPECIFIED, v1::CODEC_DELTA}) {
        subscribed("few", codec);
        deliver("few", 2, 9);
        distribute_all();
        const std::uint64_t newcomers = streams.demand().at("few").newcomers;
        Session& joins = subscribed("few", codec);
        EXPECT_EQ(streams.demand().at("few").newcomers, newcomers);
        EXPECT_EQ(ticks(joins), std::vector<std::uint64_t>(2, 9));
    }
}

TEST_F(SnapshotStreamsTest, EachGroupKeepsItsRate) {
    using namespace std::chrono_literals;
    Session &often = subscribed("few", v1::CODEC_DELTA, 10), &rarely = subscribed("few", v1::CODEC_DELTA, 2);
    EXPECT_EQ(streams.demand().at("few").rate_hz, 10);
    int often_count = 0, rarely_count = 0;
    for (std::uint64_t tick = 0; tick < 100; ++tick) {
        deliver("few", 1, tick, false);
        distribute_all();
        while (often.queue.next() != nullptr) {
            ++often_count;
        }
        while (rarely.queue.next() != nullptr) {
            ++rarely_count;
        }
        clock.advance(100ms);
    }
    EXPECT_EQ(often_count, 100);
    EXPECT_EQ(rarely_count, 20);
}

TEST_F(SnapshotStreamsTest, AForgottenSessionHasNoDemand) {
    Session& gone = subscribed("few");
    streams.forget(gone.number);
    EXPECT_TRUE(streams.demand().empty());
    deliver("few", 1);
    EXPECT_FALSE(distribute());
    EXPECT_EQ(gone.sends, 0);
}

} // namespace
} // namespace evod::streaming
