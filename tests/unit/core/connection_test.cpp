#include "proto/codec/delta_codec.h"
#include "proto/codec/tiles.h"
#include "tests/support/waiting.h"
#include "tests/unit/core/fake_server.h"
#include "tests/unit/core/moving_snapshots.h"

#include <gmock/gmock.h>

#include <thread>

namespace evod::core {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

v1::Request run_request(std::uint64_t generations) {
    v1::Request request;
    request.mutable_run()->set_generations(generations);
    return request;
}

TEST(Connection, SendsHelloAndShowsTheWelcome) {
    FakeServer server;
    Connection connection{server.options()};
    FakeSession session = server.accept();
    const auto hello = session.read().hello();
    EXPECT_EQ(hello.protocol_version(), 1U);
    EXPECT_EQ(hello.client_name(), "a test");
    v1::ServerMessage message;
    message.mutable_welcome()->set_protocol_version(1);
    message.mutable_welcome()->set_instance_id("an instance");
    session.send(message);
    const auto welcome = connection.wait_connected(hang);
    ASSERT_TRUE(welcome) << welcome.error().what;
    EXPECT_EQ(welcome->instance_id(), "an instance");
    EXPECT_EQ(connection.status().state, State::Connected);
}

TEST(Connection, WithoutAServerSaysHowToStartOne) {
    FakeServer server;
    const Options options = server.options();
    server.stop_listening();
    Connection connection{options};
    const auto welcome = connection.wait_connected(hang);
    ASSERT_FALSE(welcome);
    EXPECT_EQ(welcome.error().kind, Error::Kind::NoConnection);
    EXPECT_EQ(welcome.error().what, "no server at " + to_text(options.server) + ": start one with `evod`");
    EXPECT_NE(connection.status().state, State::Failed) << "one may be started yet";
}

TEST(Requests, AreNumberedInOrderUnderOneKey) {
    FakeServer server;
    Connection connection{server.options()};
    FakeSession session = server.accept_and_welcome();
    std::string key;
    for (std::uint64_t i = 1; i <= 3; ++i) {
        auto response = connection.send(run_request(i));
        const v1::Request request = session.read_request();
        EXPECT_EQ(request.request_id(), i);
        EXPECT_EQ(request.run().generations(), i);
        EXPECT_EQ(request.client_key().size(), 32U);
        EXPECT_TRUE(key.empty() || request.client_key() == key);
        key = request.client_key();
        session.answer(request, 100 + i);
        EXPECT_EQ(response.get()->applied_tick(), 100 + i);
    }
}

TEST(Requests, TimeOutAndALateReplyIsIgnored) {
    FakeServer server;
    Connection connection{server.options()};
    FakeSession session = server.accept_and_welcome(1); // one request at a time
    ASSERT_TRUE(connection.wait_connected(hang));
    const auto response = connection.request(run_request(1), 20ms);
    ASSERT_FALSE(response);
    EXPECT_EQ(response.error().kind, Error::Kind::Timeout);
    EXPECT_EQ(response.error().what, "no reply within 20 ms");
    session.answer(session.read_request());
    auto next = connection.send(run_request(2));
    session.answer(session.read_request(), 2);
    EXPECT_EQ(next.get()->applied_tick(), 2U) << "the late answer has made room";
}

TEST(Requests, AreAllAnsweredWhenTheConnectionIsDestroyed) {
    FakeServer server;
    std::future<Result<v1::Response>> response;
    {
        Connection connection{server.options()};
        response = connection.send(run_request(1));
    }
    EXPECT_EQ(response.get().error().kind, Error::Kind::Closed);
}

TEST(Reconnection, ShowsTheServersLastRefusal) {
    FakeServer server;
    Connection connection{server.options()};
    {
        FakeSession first = server.accept_and_welcome();
        first.refuse(0, v1::CODE_INVALID_ARGUMENT, "that was not a message");
        first.send_event(1); // the session went on
    }
    {
        FakeSession second = server.accept();
        EXPECT_THAT(connection.status().reason, HasSubstr("closed the connection"));
        EXPECT_FALSE(connection.status().refusal);
        second.welcome();
        second.say_goodbye(v1::CODE_RESOURCE_EXHAUSTED, "this client takes nothing");
    }
    FakeSession third = server.accept();
    EXPECT_THAT(connection.status().reason, HasSubstr("ended the session: this client takes"));
    third.welcome();
    EXPECT_TRUE(wait_until([&] { return connection.status().connected_count == 3; }));
    EXPECT_FALSE(connection.status().refusal);
}

TEST(Subscriptions, PrecedeOtherRequestsAfterALoss) {
    FakeServer server;
    Connection connection{server.options()};
    v1::Request create;
    create.mutable_create_world()->set_name("new");
    auto created = connection.send(create);
    v1::SubscribeSnapshots snapshots;
    snapshots.set_world("new");
    const SubscriptionHandle handle = connection.subscribe(snapshots);
    connection.subscribe(v1::SubscribeEvents{});
    auto ran = connection.send(run_request(1));
    {
        FakeSession session = server.accept_and_welcome();
        const auto request = session.read_request();
        EXPECT_TRUE(request.has_create_world());
        session.answer(request);
        session.answer_subscription(session.read_request(), 1);
        session.answer_subscription(session.read_request(), 2);
        EXPECT_TRUE(session.read_request().has_run());
        EXPECT_TRUE(created.get());
        const auto answer = connection.wait_subscribed(handle, hang);
        ASSERT_TRUE(answer) << answer.error().what;
        EXPECT_EQ(answer->subscription().subscription_id(), 1U);
    }
    FakeSession session = server.accept_and_welcome();
    const v1::Request again = session.read_request();
    EXPECT_EQ(again.subscribe_snapshots().world(), "new");
    session.answer_subscription(again, 8);
    EXPECT_TRUE(session.read_request().has_subscribe_events());
    session.answer(session.read_request(), 5);
    EXPECT_EQ(ran.get()->applied_tick(), 5U);
    session.send_snapshot(8, 0, 99);
    std::shared_ptr<const codec::ReceivedSnapshot> snapshot;
    EXPECT_TRUE(wait_until([&] { return (snapshot = connection.take_snapshot(handle)) != nullptr; }));
    EXPECT_EQ(snapshot->about.tick(), 99U) << "the handle outlives the session";
}

TEST(Snapshots, OnlyTheNewestOfEachIslandIsKept) {
    FakeServer server;
    Connection connection{server.options()};
    const SubscriptionHandle handle = connection.subscribe(v1::SubscribeSnapshots{});
    FakeSession session = server.accept_and_welcome();
    session.answer_subscription(session.read_request(), 1);
    for (const std::uint64_t tick : {10, 20, 30}) {
        session.send_snapshot(1, 0, tick);
        session.send_snapshot(1, 2, tick + 1);
    }
    session.send_snapshot(77, 0, 40); // of a subscription that does not exist
    session.send_event(1);            // comes after all of them
    ASSERT_TRUE(connection.wait_event(hang));
    const auto snapshots = connection.take_snapshots(handle);
    ASSERT_EQ(snapshots.size(), 2U);
    EXPECT_EQ(snapshots[0]->about.tick(), 30U);
    EXPECT_EQ(snapshots[1]->about.tick(), 31U);
    EXPECT_EQ(snapshots[1]->about.island(), 2U);
    EXPECT_FALSE(connection.take_snapshot(handle, 0)) << "taken is taken";
}

TEST(Snapshots, ADamagedOneIsCountedAndDropped) {
    FakeServer server;
    Connection connection{server.options()};
    const SubscriptionHandle handle = connection.subscribe(v1::SubscribeSnapshots{});
    FakeSession session = server.accept_and_welcome();
    session.answer_subscription(session.read_request(), 1);
    v1::SnapshotFrame frame;
    frame.set_width_px(100);
    frame.set_height_px(100);
    codec::encode_plain({}, frame);
    frame.set_island_count(1);
    frame.set_subscription_id(1);
    frame.set_organism_count(1'000'000'000);
    session.send(frame);
    session.send_event(1);
    ASSERT_TRUE(connection.wait_event(hang));
    EXPECT_FALSE(connection.take_snapshot(handle));
    EXPECT_EQ(connection.status().damaged_snapshot_count, 1U);
    EXPECT_THAT(connection.status().last_damage, HasSubstr("plain.organisms"));
    EXPECT_EQ(connection.status().state, State::Connected);
}

std::shared_ptr<const codec::ReceivedSnapshot> snapshot_of_tick(Connection& connection, SubscriptionHandle handle,
                                                                std::uint64_t tick) {
    std::shared_ptr<const codec::ReceivedSnapshot> snapshot;
    EXPECT_TRUE(wait_until([&] {
        if (auto newest = connection.take_snapshot(handle)) {
            snapshot = std::move(newest);
        }
        return snapshot && snapshot->about.tick() == tick;
    }));
    return snapshot;
}

TEST(Snapshots, UseTheMostCompactCodecByDefault) {
    FakeServer server;
    Connection connection{server.options()};
    connection.subscribe(v1::SubscribeSnapshots{});
    v1::SubscribeSnapshots plain;
    plain.set_codec(v1::CODEC_PLAIN);
    connection.subscribe(plain);
    FakeSession session = server.accept_and_welcome();
    const v1::SubscribeSnapshots first = session.read_request().subscribe_snapshots();
    EXPECT_EQ(first.codec(), v1::CODEC_DELTA);
    EXPECT_EQ(first.compression(), v1::COMPRESSION_ZSTD);
    EXPECT_EQ(first.unacknowledged_max(), Connection::unacknowledged_snapshots_max);
    const v1::SubscribeSnapshots second = session.read_request().subscribe_snapshots();
    EXPECT_EQ(second.codec(), v1::CODEC_PLAIN);
    EXPECT_FALSE(second.has_unacknowledged_max());
}

TEST(Snapshots, DeltasAreDecodedAndAcknowledged) {
    FakeServer server;
    Connection connection{server.options()};
    const SubscriptionHandle handle = connection.subscribe(v1::SubscribeSnapshots{});
    FakeSession session = server.accept_and_welcome();
    session.answer_subscription(session.read_request(), 1);
    MovingSnapshots snapshots;
    for (std::uint64_t sequence = 1; sequence <= 3; ++sequence) {
        session.send(sequence == 1 ? snapshots.keyframe() : snapshots.delta());
        const auto message = session.read();
        EXPECT_EQ(message.acknowledge_snapshot().subscription_id(), 1U);
        EXPECT_EQ(message.acknowledge_snapshot().sequence(), sequence);
        const auto snapshot = snapshot_of_tick(connection, handle, sequence);
        ASSERT_TRUE(snapshot);
        EXPECT_EQ(snapshot->entities->organisms.x, codec::Column(1, codec::steps_of(static_cast<float>(sequence - 1))));
        EXPECT_EQ(snapshot->about.width_px(), 100) << "of the keyframe";
    }
}

TEST(Snapshots, DamagedKeyframesEndTheKeyframeRequests) {
    FakeServer server;
    Connection connection{server.options()};
    connection.subscribe(v1::SubscribeSnapshots{});
    FakeSession session = server.accept_and_welcome();
    session.answer_subscription(session.read_request(), 1);
    MovingSnapshots snapshots;
    for (int i = 0; i < 20; ++i) {
        auto damaged = snapshots.keyframe();
        damaged.mutable_body()->back() ^= 1;
        session.send(damaged);
    }
    EXPECT_TRUE(wait_until([&] { return connection.status().damaged_snapshot_count == 20; }));
    EXPECT_EQ(connection.status().keyframe_request_count, 3U);
}

/// A snapshot of one tile, with two organisms in it.
v1::SnapshotFrame tile_snapshot(std::uint64_t sequence, std::uint64_t base_sequence) {
    const auto scene = std::make_shared<const codec::QuantisedSnapshot>(codec::QuantisedSnapshot{
        .organisms = {.id = {5, 6}, .x = {16, 16}, .y = {16, 16}, .width = {16, 16}, .height = {16, 16}}});
    v1::SnapshotFrame frame;
    frame.set_width_px(100);
    frame.set_height_px(100);
    codec::describe(*scene, frame);
    frame.set_codec(v1::CODEC_DELTA);
    frame.set_island_count(1);
    frame.set_subscription_id(1);
    frame.set_sequence(sequence);
    frame.set_tick(sequence);
    codec::SnapshotTiles tiled{scene, codec::tile_layout(100, 100)};
    frame.set_tile_px(tiled.layout().tile_px);
    v1::SnapshotTile& tile = *frame.add_tiles();
    tile.set_detail(v1::DETAIL_FULL);
    tile.set_organism_count(2);
    tile.set_sequence(sequence);
    tile.set_base_sequence(base_sequence);
    codec::BaselineView standing;
    standing.snapshot = tiled.full(0);
    const std::vector<std::uint32_t> still(2);
    standing.organisms = {still, still};
    tile.set_body(base_sequence ? codec::encode_delta(standing, standing.snapshot, 1)
                                : codec::encode_keyframe(standing));
    tile.set_checksum(codec::checksum_of(frame.tile_px(), frame.position_bytes(), tile, tile.body()));
    return frame;
}

TEST(Views, ADamagedTileRequestsAKeyframe) {
    FakeServer server;
    Connection connection{server.options()};
    v1::SubscribeSnapshots subscribe;
    subscribe.mutable_view();
    const SubscriptionHandle handle = connection.subscribe(subscribe);
    FakeSession session = server.accept_and_welcome();
    session.answer_subscription(session.read_request(), 1);
    session.send(tile_snapshot(1, 0));
    EXPECT_TRUE(session.read().has_acknowledge_snapshot());
    const auto first = snapshot_of_tick(connection, handle, 1);
    ASSERT_TRUE(first);
    EXPECT_EQ(first->entities->organisms.id, (codec::Column{5, 6}));
    EXPECT_EQ(first->tiles.size(), 1U);
    auto damaged = tile_snapshot(2, 1);
    damaged.mutable_tiles(0)->mutable_body()->back() ^= 1;
    session.send(damaged);
    EXPECT_TRUE(session.read().has_acknowledge_snapshot());
    EXPECT_EQ(session.read_request().request_keyframe().subscription_id(), 1U);
    session.send(tile_snapshot(3, 2)); // on its way before the request came
    EXPECT_TRUE(session.read().has_acknowledge_snapshot());
    session.send(tile_snapshot(4, 0));
    EXPECT_TRUE(session.read().has_acknowledge_snapshot());
    session.send(tile_snapshot(5, 4));
    EXPECT_TRUE(snapshot_of_tick(connection, handle, 5));
    EXPECT_EQ(connection.status().damaged_snapshot_count, 1U);
    EXPECT_EQ(connection.status().keyframe_request_count, 1U);
}

TEST(Endpoint, IsReadInEveryUsualForm) {
    EXPECT_EQ(parse_endpoint("lab").value(), (Endpoint{"lab", 7744}));
    EXPECT_EQ(parse_endpoint("lab:80").value(), (Endpoint{"lab", 80}));
    EXPECT_EQ(parse_endpoint("[::1]").value(), (Endpoint{"::1", 7744}));
    EXPECT_EQ(parse_endpoint("[fe80::1%eth0]:65535").value(), (Endpoint{"fe80::1%eth0", 65535}));
    EXPECT_EQ(parse_endpoint("::1").value(), (Endpoint{"::1", 7744}));
    EXPECT_EQ(to_text(Endpoint{"::1", 7744}), "[::1]:7744");
    for (const char* wrong : {"", ":80", "lab:", "lab:0", "lab:65536", "lab:80x", "lab:-1", "[::1", "[::1]80", "[]"}) {
        EXPECT_FALSE(parse_endpoint(wrong)) << wrong;
    }
}

} // namespace
} // namespace evod::core
