#include "server/network/session_table.h"

#include "tests/unit/network/loopback.h"

#include <deque>

namespace evod::network {
namespace {

using access::Role;

class SessionTableTest : public Loopback {
  protected:
    SessionTableTest() {
        host.ended = [this](Session& ended) { table.forget(ended); };
        host.make_room = [this](const std::string& account) { return table.make_room(account); };
        host.admit = [](const std::string& token, const std::string&) { return access::Visitor{.name = token}; };
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
    /// Connects a client of this user. nullopt: it sends no Hello.
    void accept(const std::optional<std::string>& user) {
        tcp::acceptor acceptor{context, tcp::endpoint{asio::ip::address_v4::loopback(), 0}};
        tcp::socket& client = sockets.emplace_back(context);
        client.connect(acceptor.local_endpoint());
        table.accept(std::make_unique<Transport>(acceptor.accept(), nullptr));
        if (user) {
            v1::ClientMessage message;
            message.mutable_hello()->set_token(*user);
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

    SessionTable table{host, 4};
    std::deque<tcp::socket> sockets;
};

TEST_F(SessionTableTest, NumbersItsSessions) {
    accept("ada");
    accept(std::nullopt);
    ASSERT_EQ(table.sessions().size(), 2u);
    EXPECT_TRUE(find_session(table.sessions(), 1)->greeted());
    EXPECT_FALSE(find_session(table.sessions(), 2)->greeted());
    EXPECT_EQ(find_session(table.sessions(), 3), nullptr);
    EXPECT_EQ(host.traffic.connections.value(), 2u);
}

TEST_F(SessionTableTest, AUserHasAtMostHalfOfTheSessions) {
    for (int i = 0; i < 3; ++i) {
        accept("eve");
    }
    EXPECT_EQ(reason_of_end(2), v1::REASON_SESSIONS_MAX);
    EXPECT_EQ(counters.count(Limit::Sessions), 1u);
    accept("ada");
    EXPECT_EQ(table.places().held("eve"), 2u);
    EXPECT_EQ(table.places().held("ada"), 1u);
}

TEST_F(SessionTableTest, TheUserWithTheMostLosesTheOldestIdleSession) {
    for (const char* user : {"eve", "eve", "bob", "bob"}) {
        accept(user);
    }
    find_session(table.sessions(), 3)->requests.commands_under_way = 1;
    accept("ada");
    EXPECT_EQ(reason_of_end(3), v1::REASON_SESSIONS_MAX) << "the older session of bob has a command under way";
    EXPECT_EQ(counters.taken_back_count(Limit::Sessions), 1u);
    EXPECT_EQ(counters.count(Limit::Sessions), 0u);
    EXPECT_EQ(table.places().held("ada"), 1u);
    EXPECT_EQ(table.places().held("bob"), 1u);
    accept("cat");
    EXPECT_EQ(reason_of_end(0), v1::REASON_SESSIONS_MAX);
    accept("dan");
    EXPECT_EQ(reason_of_end(6), v1::REASON_SESSIONS_MAX) << "all have one each, so nothing is taken from a user";
}

TEST_F(SessionTableTest, ConnectionsWithoutHelloTakeNoSession) {
    for (std::uint32_t i = 0; i < newcomers_max; ++i) {
        accept(std::nullopt);
    }
    EXPECT_EQ(table.newcomers().held(), newcomers_max / 2) << "an address may have half of the places";
    EXPECT_EQ(reason_of_end(0), v1::REASON_SESSIONS_MAX);
    EXPECT_EQ(reason_of_end(newcomers_max / 2), v1::REASON_UNSPECIFIED);
    accept("ada");
    EXPECT_EQ(table.places().held("ada"), 1u);
}

TEST_F(SessionTableTest, RefusesAllOnRequest) {
    accept("ada");
    table.refuse_all();
    accept("ada");
    EXPECT_EQ(table.places().held(), 1u);
    EXPECT_EQ(reason_of_end(1), v1::REASON_SERVER_GOING_AWAY);
}

TEST_F(SessionTableTest, CountsEndedSessions) {
    accept("ada");
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
    SessionTable small{small_host, 4};
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
