#include "server/network/session_table.h"

#include "tests/unit/network/loopback.h"

#include <deque>

namespace evod::network {
namespace {

using access::Role;

class SessionTableTest : public Loopback {
  protected:
    static constexpr SessionBounds bounds{.sessions_max = 3, .sessions_per_address_max = 2};

    SessionTableTest() {
        host.ended = [this](Session& ended) { table.forget(ended); };
    }
    void TearDown() override {
        const Sessions all = table.sessions();
        for (const auto& [number, session] : all) {
            session->close();
        }
        context.restart();
        context.run();
        EXPECT_TRUE(table.sessions().empty());
    }
    /// Connects a client. It sends a Hello only if it is greeted.
    void accept(bool is_greeted) {
        tcp::acceptor acceptor{context, tcp::endpoint{asio::ip::address_v4::loopback(), 0}};
        tcp::socket& client = sockets.emplace_back(context);
        client.connect(acceptor.local_endpoint());
        table.accept(std::make_unique<Transport>(acceptor.accept(), nullptr));
        if (is_greeted) {
            v1::ClientMessage message;
            message.mutable_hello()->set_protocol_version(codec::protocol_version);
            asio::write(client, asio::buffer(codec::encode_frame(codec::Channel::Control, message)));
        }
        settle();
    }
    /// Why the server has ended a connection; REASON_UNSPECIFIED if it has not.
    v1::Reason reason_of_end(std::size_t index) {
        codec::FrameReader reader{codec::client_limits};
        std::array<std::byte, 4096> bytes;
        sockets.at(index).non_blocking(true);
        boost::system::error_code error;
        while (const std::size_t count = sockets[index].read_some(asio::buffer(bytes), error)) {
            reader.feed({bytes.data(), count});
        }
        for (auto frame = reader.next(); frame && *frame; frame = reader.next()) {
            const auto message = codec::parse_body<v1::ServerMessage>((*frame)->body).value();
            if (message.has_goodbye()) {
                return message.goodbye().status().reason();
            }
        }
        return v1::REASON_UNSPECIFIED;
    }

    SessionTable table{host, bounds};
    std::deque<tcp::socket> sockets;
};

TEST_F(SessionTableTest, NumbersItsSessions) {
    accept(true);
    accept(false);
    ASSERT_EQ(table.sessions().size(), 2u);
    EXPECT_TRUE(find_session(table.sessions(), 1)->greeted());
    EXPECT_FALSE(find_session(table.sessions(), 2)->greeted());
    EXPECT_EQ(find_session(table.sessions(), 3), nullptr);
    EXPECT_EQ(host.traffic.connections.value(), 2u);
}

TEST_F(SessionTableTest, RefusesMoreSessionsOfAnAddress) {
    accept(true);
    accept(true);
    accept(true);
    EXPECT_EQ(table.sessions().size(), 2u);
    EXPECT_EQ(reason_of_end(2), v1::REASON_SESSIONS_MAX);
    EXPECT_EQ(counters.count(Limit::SessionsPerAddress), 1u);
    EXPECT_EQ(counters.count(Limit::Sessions), 0u);
}

TEST_F(SessionTableTest, ASilentSessionMakesRoom) {
    accept(true);
    accept(false);
    accept(true);
    EXPECT_EQ(table.sessions().size(), 2u);
    EXPECT_EQ(reason_of_end(0), v1::REASON_UNSPECIFIED);
    EXPECT_EQ(reason_of_end(1), v1::REASON_SESSIONS_MAX);
    EXPECT_TRUE(find_session(table.sessions(), 3)->greeted());
}

TEST_F(SessionTableTest, RefusesAllOnRequest) {
    accept(true);
    table.refuse_all();
    accept(true);
    EXPECT_EQ(table.sessions().size(), 1u);
    EXPECT_EQ(reason_of_end(1), v1::REASON_SERVER_GOING_AWAY);
}

TEST_F(SessionTableTest, CountsEndedSessions) {
    accept(true);
    find_session(table.sessions(), 1)->close();
    settle();
    EXPECT_EQ(table.ended_count(), 1u);
    EXPECT_TRUE(table.sessions().empty());
}

TEST_F(SessionTableTest, EvictsTheSessionsWithTheMostMemory) {
    SendMemory little{1500, [] {}};
    SessionHost small_host{counters, little};
    small_host.clock = &clock;
    small_host.limits = host.limits;
    small_host.admit = host.admit;
    SessionTable small{small_host, bounds};
    small_host.ended = [&](Session& ended) { small.forget(ended); };
    for (int i = 0; i < 2; ++i) {
        tcp::acceptor acceptor{context, tcp::endpoint{asio::ip::address_v4::loopback(), 0}};
        sockets.emplace_back(context).connect(acceptor.local_endpoint());
        small.accept(std::make_unique<Transport>(acceptor.accept(), nullptr));
    }
    find_session(small.sessions(), 1)->requests.expect(1000);
    find_session(small.sessions(), 2)->requests.expect(2000);
    small.evict();
    settle();
    EXPECT_EQ(find_session(small.sessions(), 2), nullptr);
    EXPECT_EQ(counters.count(Limit::ClientBufferBytes), 1u);
    find_session(small.sessions(), 1)->close();
    settle();
    EXPECT_TRUE(small.sessions().empty());
}

} // namespace
} // namespace evod::network
