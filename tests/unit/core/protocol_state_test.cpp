#include "client/core/protocol_state.h"
#include "tests/unit/core/moving_snapshots.h"

#include <gmock/gmock.h>

namespace evod::core {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

v1::Request events_request() {
    v1::Request request;
    request.mutable_subscribe_events();
    return request;
}

v1::Request snapshots_request() {
    v1::Request request;
    request.mutable_subscribe_snapshots()->set_codec(v1::CODEC_DELTA);
    request.mutable_subscribe_snapshots()->set_unacknowledged_max(8);
    return request;
}

std::string text_of(const Result<v1::Response>& result) {
    return result ? "tick " + std::to_string(result->applied_tick()) : result.error().what;
}

/// A client and the server's end of its session, at a time that the test sets.
class ProtocolTest : public testing::Test {
  protected:
    /// Performs the output as a Connection does.
    void perform() {
        output = protocol->take_output();
        sent += output.bytes;
        for (Outcome& outcome : output.outcomes) {
            outcome.handler(std::move(outcome.result));
        }
        for (v1::Event& event : output.events) {
            events.push(std::move(event));
        }
    }
    void start(Options options = {}) {
        protocol.emplace(std::move(options), "a key", 1, now);
        perform();
    }
    void receive(const std::string& bytes) {
        protocol->received(std::as_bytes(std::span{bytes}), now);
        perform();
    }
    void receive(const v1::ServerMessage& message) { receive(codec::encode_frame(codec::Channel::Control, message)); }
    void receive(const v1::SnapshotFrame& frame) { receive(codec::encode_frame(codec::Channel::Stream, frame)); }
    void welcome(std::uint32_t requests_in_flight_max = 0) {
        protocol->opened(now);
        perform();
        EXPECT_TRUE(read().has_hello());
        v1::ServerMessage message;
        message.mutable_welcome()->set_protocol_version(1);
        message.mutable_welcome()->mutable_limits()->set_requests_in_flight_max(requests_in_flight_max);
        receive(message);
    }
    void lose(Ending ending = {.reason = "the cable was cut"}) {
        protocol->lost(std::move(ending), now);
        perform();
    }
    /// Lets time pass until the client wants to do something.
    void wait() {
        now = output.wake_at;
        protocol->advance(now);
        perform();
    }
    void reconnect(std::uint32_t requests_in_flight_max = 0) {
        wait();
        ASSERT_TRUE(output.connection_wanted);
        welcome(requests_in_flight_max);
    }
    void request(std::uint64_t generations, std::chrono::milliseconds timeout = 10s) {
        v1::Request request;
        request.mutable_run()->set_generations(generations);
        protocol->request(
            request, [this](const Result<v1::Response>& result) { outcomes.push_back(text_of(result)); }, timeout, now);
        perform();
    }
    void subscribe(std::uint32_t handle, v1::Request request) {
        protocol->subscriptions().add({handle}, std::move(request));
        perform();
    }
    void answer(std::uint64_t request_id, std::uint64_t tick) {
        v1::ServerMessage message;
        message.mutable_response()->set_request_id(request_id);
        message.mutable_response()->set_applied_tick(tick);
        receive(message);
    }
    void answer_subscription(const v1::Request& request, std::uint32_t server_id) {
        v1::ServerMessage message;
        message.mutable_response()->set_request_id(request.request_id());
        message.mutable_response()->mutable_subscription()->set_subscription_id(server_id);
        receive(message);
    }
    void say_goodbye(v1::Code code) {
        v1::ServerMessage message;
        message.mutable_goodbye()->mutable_status()->set_code(code);
        message.mutable_goodbye()->mutable_status()->set_message("go away");
        receive(message);
    }
    /// The next message that the client has sent; an empty one if there is none.
    v1::ClientMessage read() {
        reader.feed(std::as_bytes(std::span{sent}));
        sent.clear();
        const auto frame = reader.next().value();
        return frame ? codec::parse_body<v1::ClientMessage>(frame->body).value() : v1::ClientMessage{};
    }
    v1::Request read_request() { return read().request(); }

    TimePoint now{};
    std::optional<ProtocolState> protocol;
    ProtocolState::Output output; // the last one
    EventQueue events{3};
    std::vector<std::string> outcomes; // the results of request(), in the order of the calls of its handler
    std::string sent;
    codec::FrameReader reader{codec::server_limits};
};

using Handshake = ProtocolTest;

TEST_F(Handshake, SendsHelloAndTakesTheWelcome) {
    start({.token = "secret", .client_name = "a test"});
    EXPECT_TRUE(output.connection_wanted);
    EXPECT_EQ(output.bytes, "") << "the TCP connection is not open yet";
    protocol->opened(now);
    perform();
    const v1::Hello hello = read().hello();
    EXPECT_EQ(hello.protocol_version(), codec::protocol_version);
    EXPECT_EQ(hello.client_name(), "a test");
    EXPECT_EQ(hello.token(), "secret");
    v1::ServerMessage message;
    message.mutable_welcome()->set_protocol_version(codec::protocol_version);
    message.mutable_welcome()->set_instance_id("an instance");
    receive(message);
    EXPECT_EQ(output.status.state, State::Connected);
    EXPECT_EQ(output.status.welcome->instance_id(), "an instance");
    EXPECT_EQ(output.wake_at, TimePoint::max()) << "no deadline is left";
}

TEST_F(Handshake, JoinsOnceAndComesBackAsTheSameMember) {
    start({.join = Options::Join{.code = "KTRMXB", .name = "Ada"}});
    protocol->opened(now);
    perform();
    const v1::Hello first = read().hello();
    EXPECT_EQ(first.join().code(), "KTRMXB");
    EXPECT_EQ(first.join().name(), "Ada");
    EXPECT_EQ(first.token(), "");
    v1::ServerMessage message;
    message.mutable_welcome()->set_protocol_version(codec::protocol_version);
    message.mutable_welcome()->mutable_membership()->set_token("of Ada");
    receive(message);
    for (int session = 0; session < 2; ++session) { // the second Welcome contains no token
        lose();
        wait();
        protocol->opened(now);
        perform();
        const v1::Hello again = read().hello();
        EXPECT_FALSE(again.has_join());
        EXPECT_EQ(again.token(), "of Ada");
        message.mutable_welcome()->mutable_membership()->clear_token();
        receive(message);
    }
}

TEST_F(Handshake, HasADeadlineForEachPart) {
    start({.server = {"lab", 1}, .connect_timeout = 7ms});
    EXPECT_EQ(output.wake_at, TimePoint{7ms});
    wait();
    EXPECT_EQ(output.status.reason, "no connection with lab:1 within 7 ms: check the address and the network");
    EXPECT_FALSE(output.connection_wanted);
    wait();
    protocol->opened(now);
    perform();
    wait();
    EXPECT_EQ(output.status.reason, "no Welcome from lab:1 within 7 ms: check the address and the network");
    EXPECT_EQ(output.status.state, State::Lost);
}

TEST_F(Handshake, ARefusalIsFinalUnlessTheServerIsFull) {
    for (const auto& [code, state] : {std::pair{v1::CODE_RESOURCE_EXHAUSTED, State::Lost},
                                      {v1::CODE_UNAVAILABLE, State::Lost},
                                      {v1::CODE_INVALID_ARGUMENT, State::Failed},
                                      {v1::CODE_UNAUTHENTICATED, State::Failed}}) {
        start();
        protocol->opened(now);
        say_goodbye(code);
        EXPECT_EQ(output.status.state, state);
        EXPECT_THAT(output.status.reason, HasSubstr("refused us: "));
        EXPECT_EQ(output.status.token_needed, code == v1::CODE_UNAUTHENTICATED);
        EXPECT_EQ(output.status.refusal->code(), code);
        EXPECT_EQ(output.wake_at == TimePoint::max(), state == State::Failed);
        sent.clear();
    }
}

TEST_F(Handshake, OnlyAWelcomeMayComeFirst) {
    v1::ServerMessage event, other_version;
    event.mutable_event();
    other_version.mutable_welcome()->set_protocol_version(2);
    for (const auto& [bytes, reason] :
         {std::pair{std::string{"SSH-2.0-OpenSSH_9.2\r\n"}, "is not an evod server"},
          {codec::encode_frame(codec::Channel::Control, event), "first message is not a Welcome"},
          {codec::encode_frame(codec::Channel::Stream, v1::SnapshotFrame{}), "first message is a snapshot"},
          {codec::encode_frame(codec::Channel::Control, other_version), "version 2, this program version 1"}}) {
        start();
        protocol->opened(now);
        receive(bytes);
        EXPECT_EQ(output.status.state, State::Failed);
        EXPECT_THAT(output.status.reason, HasSubstr(reason));
        EXPECT_FALSE(output.connection_wanted);
    }
}

using RequestsWithoutSockets = ProtocolTest;

TEST_F(RequestsWithoutSockets, AreSentAgainWithTheSameNumber) {
    start();
    welcome();
    request(1);
    request(2);
    const v1::Request first = read_request(), second = read_request();
    EXPECT_EQ(first.client_key(), "a key");
    EXPECT_EQ(second.request_id(), first.request_id() + 1);
    answer(second.request_id(), 20);
    lose();
    EXPECT_EQ(output.bytes, "");
    reconnect();
    EXPECT_EQ(read_request().SerializeAsString(), first.SerializeAsString());
    EXPECT_FALSE(read().has_request()) << "the second has its answer";
    answer(first.request_id(), 10);
    answer(first.request_id(), 11);
    EXPECT_EQ(outcomes, (std::vector<std::string>{"tick 20", "tick 10"})) << "exactly once each";
}

TEST_F(RequestsWithoutSockets, UnknownAnswersAreIgnored) {
    start();
    welcome(1); // half of it, but at least one
    request(1);
    request(2);
    answer(2, 1); // not sent yet, because one is the limit
    answer(0, 1);
    answer(99, 1);
    EXPECT_EQ(outcomes, std::vector<std::string>{});
    answer(1, 5);
    answer(2, 6);
    EXPECT_EQ(outcomes, (std::vector<std::string>{"tick 5", "tick 6"}));
}

TEST_F(RequestsWithoutSockets, StayWithinTheServersLimit) {
    start();
    for (std::uint64_t i = 1; i <= 5; ++i) {
        request(i);
    }
    welcome(5);
    EXPECT_EQ(read_request().run().generations(), 1U);
    EXPECT_EQ(read_request().run().generations(), 2U);
    EXPECT_FALSE(read().has_request());
    answer(2, 1);
    EXPECT_EQ(read_request().run().generations(), 3U);
    EXPECT_FALSE(read().has_request());
    lose();
    reconnect(6);
    for (const std::uint64_t i : {1U, 3U, 4U}) {
        EXPECT_EQ(read_request().run().generations(), i);
    }
    EXPECT_FALSE(read().has_request());
}

TEST_F(RequestsWithoutSockets, ALateAnswerMakesRoom) {
    start();
    welcome(1);
    request(1, 20ms);
    request(2, 50ms);
    EXPECT_EQ(output.wake_at, TimePoint{20ms});
    wait();
    EXPECT_EQ(outcomes, std::vector<std::string>{"no reply within 20 ms"});
    EXPECT_EQ(read_request().run().generations(), 1U);
    EXPECT_FALSE(read().has_request()) << "the first still occupies the server";
    answer(1, 1);
    EXPECT_EQ(read_request().run().generations(), 2U);
    answer(2, 2);
    EXPECT_EQ(outcomes.back(), "tick 2");
    EXPECT_EQ(output.wake_at, TimePoint::max());
}

TEST_F(RequestsWithoutSockets, ATimeoutExplainsALoss) {
    start();
    welcome();
    lose();
    request(1, 1ms);
    wait();
    EXPECT_EQ(outcomes, std::vector<std::string>{"no reply within 1 ms: the cable was cut"});
}

TEST_F(RequestsWithoutSockets, LongerThanTheLimitAreRefused) {
    start();
    v1::Request request;
    request.mutable_create_world()->set_name(std::string(2 << 20, 'x'));
    protocol->request(
        request,
        [&](const Result<v1::Response>& result) {
            EXPECT_EQ(result.error().kind, Error::Kind::Usage);
            outcomes.push_back(text_of(result));
        },
        1s, now);
    perform();
    ASSERT_EQ(outcomes.size(), 1U);
    EXPECT_THAT(outcomes[0], HasSubstr("bytes long, allowed 1048576"));
}

TEST_F(RequestsWithoutSockets, FailWithTheLastSession) {
    start({.reconnect = false});
    welcome();
    request(1);
    lose();
    request(2);
    EXPECT_EQ(outcomes, (std::vector<std::string>{"the cable was cut", "the cable was cut"}));
    EXPECT_EQ(output.status.state, State::Failed);
    EXPECT_EQ(output.wake_at, TimePoint::max());
}

TEST_F(RequestsWithoutSockets, FailIfTheServerStaysAway) {
    start({.backoff_min = 60s, .backoff_max = 60s, .unreachable_max = 2s});
    welcome();
    request(1, 1h);
    EXPECT_EQ(output.wake_at, now + 1h);
    now += 5s;
    lose();
    EXPECT_EQ(output.wake_at, now + 2s);
    wait();
    EXPECT_EQ(outcomes, std::vector<std::string>{"the cable was cut"});
    request(2, 1h);
    EXPECT_EQ(output.wake_at, now) << "the server has been away for too long already";
    wait();
    EXPECT_EQ(outcomes.size(), 2U);
    sent.clear();
    reconnect();
    request(3, 1h);
    EXPECT_EQ(read_request().run().generations(), 3U);
}

TEST_F(RequestsWithoutSockets, AreFinishedByClose) {
    start();
    welcome();
    request(1);
    protocol->close();
    perform();
    request(2);
    EXPECT_EQ(outcomes, (std::vector<std::string>(2, "the connection was closed by this program")));
    EXPECT_FALSE(output.connection_wanted);
    EXPECT_EQ(output.wake_at, TimePoint::max());
}

using Reconnecting = ProtocolTest;

TEST_F(Reconnecting, WaitsTwiceAsLongEachTime) {
    start({.backoff_min = 100ms, .backoff_max = 500ms});
    for (int round = 0; round < 2; ++round) {
        for (const auto most : {100ms, 200ms, 400ms, 500ms, 500ms}) {
            lose();
            EXPECT_EQ(output.status.state, State::Lost);
            EXPECT_GE(output.wake_at, now + most / 2 - 1ms);
            EXPECT_LE(output.wake_at, now + most);
            wait();
            EXPECT_TRUE(output.connection_wanted);
        }
        welcome(); // after it the waits are short again
    }
    EXPECT_EQ(output.status.connected_count, 2U);
}

TEST_F(Reconnecting, FollowsDamagedFrames) {
    for (const std::string& damaged : {std::string{"nonsense"}, std::string("EV\x01\x01\x02\x00\x00\x00\xff\xff", 10),
                                       std::string("EV\x01\x02\x02\x00\x00\x00\xff\xff", 10)}) {
        start();
        welcome();
        receive(damaged);
        EXPECT_THAT(output.status.reason, HasSubstr("sent damaged data"));
        EXPECT_EQ(output.status.state, State::Lost);
        EXPECT_FALSE(output.connection_wanted);
        reconnect();
        EXPECT_EQ(output.status.state, State::Connected) << "nothing of the damaged stream is left";
    }
}

TEST_F(Reconnecting, FollowsNumbersThatNoProgramCanUse) {
    start();
    welcome();
    v1::ServerMessage message;
    message.mutable_response()->mutable_description()->add_parameters()->set_max(
        std::numeric_limits<double>::quiet_NaN());
    receive(codec::encode_frame(codec::Channel::Control, message));
    EXPECT_THAT(output.status.reason, HasSubstr("sent damaged data: evod.v1.ParameterDescription.max"));
    EXPECT_EQ(output.status.state, State::Lost);
}

TEST_F(Reconnecting, UsesTheAnswersBeforeTheDamage) {
    start();
    welcome();
    request(1);
    v1::ServerMessage message;
    message.mutable_response()->set_request_id(1);
    message.mutable_response()->set_applied_tick(7);
    receive(codec::encode_frame(codec::Channel::Control, message) + "nonsense");
    EXPECT_EQ(outcomes, std::vector<std::string>{"tick 7"});
    EXPECT_EQ(output.status.state, State::Lost);
}

TEST_F(Reconnecting, TakesFramesInPiecesOfAnySize) {
    start();
    welcome();
    request(1);
    v1::ServerMessage message;
    message.mutable_response()->set_request_id(1);
    for (const char byte : codec::encode_frame(codec::Channel::Control, message)) {
        EXPECT_TRUE(outcomes.empty());
        receive(std::string(1, byte));
    }
    EXPECT_EQ(outcomes, std::vector<std::string>{"tick 0"});
}

TEST_F(Reconnecting, DependsOnTheGoodbye) {
    for (const auto& [code, state] :
         {std::pair{v1::CODE_RESOURCE_EXHAUSTED, State::Lost}, {v1::CODE_UNAUTHENTICATED, State::Failed}}) {
        start();
        welcome();
        say_goodbye(code);
        EXPECT_EQ(output.status.state, state);
        EXPECT_FALSE(output.connection_wanted);
        EXPECT_THAT(output.status.reason, HasSubstr("ended the session: go away"));
        EXPECT_EQ(output.status.token_needed, code == v1::CODE_UNAUTHENTICATED);
        EXPECT_EQ(output.status.refusal->message(), "go away");
    }
}

TEST_F(Reconnecting, NamesAnAnnouncedShutdown) {
    start({.server = {"lab", 1}});
    welcome();
    v1::ServerMessage message;
    message.mutable_event()->mutable_server_going_away();
    receive(message);
    lose();
    EXPECT_EQ(output.status.reason, "the server at lab:1 was shut down");
    reconnect();
    lose();
    EXPECT_EQ(output.status.reason, "the cable was cut");
}

using SubscriptionsWithoutSockets = ProtocolTest;

TEST_F(SubscriptionsWithoutSockets, AreRenewedBeforeOtherRequests) {
    start();
    request(1);
    subscribe(1, events_request());
    welcome();
    EXPECT_TRUE(read_request().has_run()) << "in the order of the calls";
    const v1::Request first = read_request();
    EXPECT_TRUE(first.has_subscribe_events());
    answer_subscription(first, 4);
    EXPECT_EQ(output.answers.at({1}).subscription().subscription_id(), 4U);
    lose();
    EXPECT_TRUE(output.answers.empty());
    reconnect();
    const v1::Request second = read_request();
    EXPECT_TRUE(second.has_subscribe_events());
    EXPECT_NE(second.request_id(), first.request_id());
    EXPECT_TRUE(read_request().has_run());
    EXPECT_FALSE(read().has_request());
}

TEST_F(SubscriptionsWithoutSockets, AreRequestedOnceInASession) {
    start();
    subscribe(1, events_request());
    lose();
    reconnect();
    EXPECT_TRUE(read_request().has_subscribe_events());
    EXPECT_FALSE(read().has_request());
    lose(); // before the answer
    reconnect();
    EXPECT_TRUE(read_request().has_subscribe_events());
    EXPECT_FALSE(read().has_request());
}

TEST_F(SubscriptionsWithoutSockets, ARefusalIsKept) {
    start();
    welcome();
    subscribe(1, events_request());
    v1::ServerMessage message;
    message.mutable_response()->set_request_id(read_request().request_id());
    message.mutable_response()->mutable_status()->set_code(v1::CODE_NOT_FOUND);
    receive(message);
    EXPECT_FALSE(accepted(output.answers.at({1})));
    lose();
    reconnect();
    EXPECT_TRUE(read_request().has_subscribe_events()) << "the next session may accept it";
}

TEST_F(SubscriptionsWithoutSockets, EndAfterALateAnswerToo) {
    start();
    welcome();
    subscribe(1, events_request());
    const v1::Request asked = read_request();
    protocol->subscriptions().remove({1});
    perform();
    EXPECT_FALSE(read().has_request());
    answer_subscription(asked, 3);
    EXPECT_EQ(read_request().unsubscribe().subscription_id(), 3U);
    EXPECT_TRUE(output.answers.empty());
    lose();
    reconnect();
    EXPECT_FALSE(read().has_request()) << "neither is renewed";
}

TEST_F(SubscriptionsWithoutSockets, DamageRequestsAKeyframeOnce) {
    start();
    welcome();
    subscribe(1, snapshots_request());
    answer_subscription(read_request(), 1);
    MovingSnapshots snapshots;
    receive(snapshots.keyframe());
    EXPECT_EQ(output.snapshots.at({1}).at(0)->about.tick(), 1U);
    EXPECT_EQ(read().acknowledge_snapshot().sequence(), 1U);
    auto damaged = snapshots.delta();
    damaged.mutable_body()->back() ^= 1;
    receive(damaged);
    EXPECT_TRUE(output.snapshots.empty());
    EXPECT_EQ(read().acknowledge_snapshot().sequence(), 2U);
    EXPECT_EQ(read_request().request_keyframe().subscription_id(), 1U);
    receive(snapshots.delta()); // sent before the request arrived
    EXPECT_EQ(read().acknowledge_snapshot().sequence(), 3U);
    EXPECT_FALSE(read().has_request());
    receive(snapshots.keyframe());
    receive(snapshots.delta());
    EXPECT_EQ(output.snapshots.at({1}).at(0)->about.tick(), 5U);
    EXPECT_EQ(output.status.damaged_snapshot_count, 1U);
    EXPECT_THAT(output.status.last_damage, HasSubstr("checksum"));
    EXPECT_EQ(output.status.keyframe_request_count, 1U);
}

TEST_F(SubscriptionsWithoutSockets, BaselinesEndWithTheSession) {
    start();
    welcome();
    subscribe(1, snapshots_request());
    answer_subscription(read_request(), 1);
    MovingSnapshots snapshots;
    receive(snapshots.keyframe());
    lose();
    const v1::SnapshotFrame delta = snapshots.delta();
    receive(delta);
    EXPECT_TRUE(output.snapshots.empty()) << "the session has ended";
    sent.clear();
    reconnect();
    answer_subscription(read_request(), 1);
    receive(delta);
    EXPECT_TRUE(output.snapshots.empty()) << "its baseline is of the session before";
    EXPECT_TRUE(read().has_acknowledge_snapshot());
    EXPECT_TRUE(read_request().has_request_keyframe());
}

TEST_F(SubscriptionsWithoutSockets, AViewIsSentOnceItIsKnown) {
    v1::View view;
    view.mutable_region()->set_left_px(5);
    start();
    welcome();
    subscribe(1, snapshots_request());
    const v1::Request asked = read_request();
    protocol->subscriptions().set_view({1}, view);
    perform();
    EXPECT_FALSE(read().has_request()) << "the server's id is not known yet";
    answer_subscription(asked, 9);
    const v1::Request changed = read_request();
    EXPECT_EQ(changed.set_view().subscription_id(), 9U);
    EXPECT_EQ(changed.set_view().view().region().left_px(), 5);
    view.mutable_region()->set_left_px(6);
    protocol->subscriptions().set_view({1}, view);
    perform();
    EXPECT_FALSE(read().has_request()) << "one change is in flight at a time";
    answer_subscription(changed, 9);
    const v1::Request last = read_request();
    EXPECT_EQ(last.set_view().view().region().left_px(), 6);
    answer_subscription(last, 9);
    lose();
    reconnect();
    const v1::Request renewed = read_request();
    EXPECT_EQ(renewed.subscribe_snapshots().view().region().left_px(), 6);
    answer_subscription(renewed, 2);
    EXPECT_FALSE(read().has_request()) << "the subscription contains the view";
}

TEST_F(ProtocolTest, KeepsTheNewestEventsAndCountsTheRest) {
    start();
    welcome();
    std::string bytes;
    for (std::uint64_t tick = 1; tick <= 5; ++tick) {
        v1::ServerMessage message;
        message.mutable_event()->set_tick(tick);
        bytes += codec::encode_frame(codec::Channel::Control, message);
    }
    receive(bytes);
    EXPECT_EQ(events.pop()->events_dropped().dropped_count(), 2U);
    for (const std::uint64_t tick : {3U, 4U, 5U}) {
        EXPECT_FALSE(events.empty());
        EXPECT_EQ(events.pop()->tick(), tick);
    }
    EXPECT_TRUE(events.empty());
    EXPECT_FALSE(events.pop());
}

} // namespace
} // namespace evod::core
