// A session with a client on the loopback interface, without the rest of the server.
#include "server/network/session.h"

#include "tests/support/manual_clock.h"

#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

namespace evod::network {
namespace {

class SessionTest : public testing::Test {
  protected:
    SessionTest() : client{context} {
        tcp::acceptor acceptor{context, tcp::endpoint{asio::ip::address_v4::loopback(), 0}};
        client.open(tcp::v4());
        client.set_option(asio::socket_base::receive_buffer_size{4096}); // so that large snapshots do not fit
        client.connect(acceptor.local_endpoint());
        host.clock = &clock;
        host.ended = [this](Session&) { over = true; };
        session = std::make_shared<Session>(acceptor.accept(), host, 1);
        session->start();
        for (const std::uint32_t id : {1U, 2U}) {
            session->snapshots.subscriptions[id];
        }
        context.poll(); // now the line can be written to, and the writer has nothing to do
    }
    ~SessionTest() override {
        session->close();
        context.run();
        EXPECT_TRUE(over);
    }

    /// A snapshot whose frame is filled up by the name of its world.
    void offer(std::uint32_t subscription_id, std::uint32_t island, std::uint64_t sequence, std::size_t name_bytes) {
        v1::SnapshotFrame about;
        about.set_sequence(sequence);
        about.set_world(name_of(sequence, name_bytes));
        auto encoded = std::make_shared<streaming::EncodedIsland>(std::move(about), codec::QuantisedSnapshot{},
                                                                  compressor, &buffers);
        session->snapshots.offer(
            subscription_id, island,
            std::make_shared<streaming::StreamedSnapshot>(std::move(encoded), streaming::Form::Plain, nullptr,
                                                          clock.now(), runtime::Clock::duration{}));
    }
    static std::string name_of(std::uint64_t sequence, std::size_t bytes) {
        return std::string(bytes, static_cast<char>('a' + sequence % 26));
    }
    void send() { session->snapshots.sender().send_snapshots(); }

    /// Reads what has come, once the session has done what it can; whole frames go to `frames`.
    void read() {
        std::array<std::byte, 65536> bytes;
        client.non_blocking(true);
        boost::system::error_code error;
        while (const std::size_t count = client.read_some(asio::buffer(bytes), error)) {
            reader.feed({bytes.data(), count});
            for (auto frame = reader.next(); frame && *frame; frame = reader.next()) {
                channels.push_back((*frame)->channel);
                if (channels.back() == codec::Channel::Stream) {
                    EXPECT_TRUE(frames.emplace_back().ParseFromArray((*frame)->body.data(),
                                                                     static_cast<int>((*frame)->body.size())));
                }
            }
        }
    }
    void read_until(std::size_t count) {
        for (int turn = 0; frames.size() < count && turn < 1'000'000; ++turn) {
            context.poll();
            read();
        }
        ASSERT_EQ(frames.size(), count);
    }

    support::ManualClock clock;
    codec::Compressor compressor;
    LimitCounters counters;
    SendMemory buffers{std::size_t{1} << 30, [] {}};
    SessionHost host{counters, buffers};
    asio::io_context context;
    tcp::socket client;
    bool over = false;
    SessionPtr session;
    codec::FrameReader reader{codec::client_limits};
    std::vector<codec::Channel> channels;
    std::vector<v1::SnapshotFrame> frames;
};

TEST_F(SessionTest, ASnapshotIsSentAtOnceIfTheSocketHasRoom) {
    offer(2, 5, 7, 100);
    send();
    read(); // no turn of the loop was needed
    ASSERT_EQ(frames.size(), 1U);
    EXPECT_EQ(frames[0].subscription_id(), 2U);
    EXPECT_EQ(frames[0].dropped_count(), 0U);
    EXPECT_EQ(frames[0].sequence(), 7U);
    EXPECT_EQ(frames[0].world(), name_of(7, 100));
    EXPECT_EQ(host.traffic.snapshots_sent.value(), 1U);
    EXPECT_EQ(buffers.bytes(), session->snapshots.held_bytes()) << "the snapshots are released";
}

TEST_F(SessionTest, ALargeSnapshotArrivesWholeBeforeTheNext) {
    constexpr std::size_t large = 20'000'000;
    offer(1, 0, 1, large);
    send();
    EXPECT_EQ(host.traffic.snapshots_sent.value(), 0U);
    EXPECT_GT(buffers.bytes(), large) << "what waits is counted";
    // Meanwhile others come for it: of each island the newest goes on waiting.
    for (std::uint64_t sequence = 2; sequence < 6; ++sequence) {
        offer(1, 0, sequence, 50);
        offer(2, 3, sequence, 60'000);
        send();
    }
    context.poll();
    EXPECT_EQ(host.traffic.snapshots_sent.value(), 0U);
    read_until(3);
    EXPECT_EQ(frames[0].sequence(), 1U);
    EXPECT_EQ(frames[0].world(), name_of(1, large));
    EXPECT_EQ(frames[1].sequence(), 5U);
    EXPECT_EQ(frames[1].dropped_count(), 3U);
    EXPECT_EQ(frames[2].sequence(), 5U);
    EXPECT_EQ(frames[2].subscription_id(), 2U);
    EXPECT_EQ(frames[2].world(), name_of(5, 60'000));
    context.poll();
    EXPECT_EQ(host.traffic.snapshots_sent.value(), 3U);
    EXPECT_EQ(buffers.bytes(), session->snapshots.held_bytes()) << "the snapshots are released";
    EXPECT_EQ(host.traffic.sent_stream_bytes.value(),
              3 * codec::header_bytes + frames[0].ByteSizeLong() + frames[1].ByteSizeLong() + frames[2].ByteSizeLong());
}

TEST_F(SessionTest, AStalledClientIsClosedInTime) {
    using namespace std::chrono_literals;
    offer(1, 0, 1, 20'000'000);
    send();
    context.poll();
    session->check_progress(0s);
    for (int i = 0; i < 9; ++i) {
        session->check_progress(1s);
    }
    read(); // now it takes something
    context.poll();
    for (int i = 0; i < 10; ++i) {
        EXPECT_EQ(counters.count(Limit::StalledTimeout), 0U) << i;
        session->check_progress(1s);
    }
    session->check_progress(1s);
    EXPECT_EQ(counters.count(Limit::StalledTimeout), 1U);
}

TEST_F(SessionTest, ASlowReaderGetsSmallSnapshotsInOrder) {
    std::uint64_t sequence = 0;
    for (int round = 0; round < 1000; ++round) {
        offer(1, static_cast<std::uint32_t>(round), ++sequence, 20'000);
        send();
        if (round % 7 == 0) {
            context.poll();
        }
    }
    EXPECT_LT(host.traffic.snapshots_sent.value(), 1000U) << "otherwise none had to wait";
    read_until(1000);
    for (std::size_t i = 0; i < frames.size(); ++i) {
        EXPECT_EQ(frames[i].sequence(), i + 1);
    }
}

TEST_F(SessionTest, AnswersGoBeforeSnapshots) {
    offer(1, 0, 1, 10);
    v1::Response response;
    response.set_request_id(4);
    session->send_unasked(response);
    send();
    read_until(1);
    EXPECT_EQ(channels, (std::vector{codec::Channel::Control, codec::Channel::Stream}));
}

TEST_F(SessionTest, ADisconnectedClientEndsTheSession) {
    client.set_option(asio::socket_base::linger{true, 0});
    client.close();
    for (int i = 0; i < 3; ++i) {
        offer(1, 0, 1, 100'000);
        send();
    }
    context.run();
    EXPECT_TRUE(over);
}

} // namespace
} // namespace evod::network
