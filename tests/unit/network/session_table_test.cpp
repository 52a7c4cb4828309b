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
        host.admit = [](const std::string& token, const std::string&) {
            return access::AuthenticatedUser{.name = token};
        };
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

/// Sessions of two users, which a table with little memory evicts.
class EvictionTest : public SessionTableTest {
  protected:
    EvictionTest() {
        little_host.clock = &clock;
        little_host.limits = host.limits;
        little_host.admit = [this](const std::string&, const std::string&) {
            return access::AuthenticatedUser{.name = user, .role = Role::Viewer};
        };
        little_host.ended = [this](Session& ended) { little_table.forget(ended); };
    }
    void TearDown() override {
        const Sessions all = little_table.sessions();
        for (const auto& [number, session] : all) {
            session->close();
        }
        settle();
        EXPECT_EQ(little.bytes(), 0u);
        SessionTableTest::TearDown();
    }
    /// A session of a user that holds so much memory.
    Session& holding(const std::string& name, std::size_t bytes) {
        user = name;
        tcp::acceptor acceptor{context, tcp::endpoint{asio::ip::address_v4::loopback(), 0}};
        tcp::socket& client = sockets.emplace_back(context);
        client.connect(acceptor.local_endpoint());
        little_table.accept(std::make_unique<Transport>(acceptor.accept(), nullptr));
        v1::ClientMessage message;
        message.mutable_hello()->set_protocol_version(codec::protocol_version);
        asio::write(client, asio::buffer(codec::encode_frame(codec::Channel::Control, message)));
        settle();
        Session& session = *little_table.sessions().rbegin()->second;
        EXPECT_TRUE(session.greeted());
        session.requests.expect(static_cast<std::ptrdiff_t>(bytes - session.held_bytes()));
        return session;
    }
    /// Numbers of the sessions that remain.
    std::vector<std::uint64_t> evict() {
        little_table.evict();
        settle();
        std::vector<std::uint64_t> numbers;
        for (const auto& [number, session] : little_table.sessions()) {
            numbers.push_back(number);
        }
        return numbers;
    }

    static constexpr std::size_t kib = 1 << 10;
    SendMemory little{1000 * kib, [] {}};
    SessionHost little_host{counters, little};
    SessionTable little_table{little_host, 100};
    std::string user;
};

TEST_F(EvictionTest, ClosesTheLargestSessionOfTheUserAboveHalf) {
    holding("eve", 100 * kib);
    holding("eve", 300 * kib);
    holding("eve", 200 * kib);
    holding("ada", 350 * kib);
    EXPECT_EQ(evict(), (std::vector<std::uint64_t>{1, 3, 4}));
    EXPECT_EQ(counters.count(Limit::ClientBufferBytes), 1u);
}

TEST_F(EvictionTest, LeavesUsersWithinTheirHalf) {
    holding("eve", 500 * kib);
    holding("ada", 450 * kib);
    EXPECT_EQ(evict(), (std::vector<std::uint64_t>{1, 2}));
}

TEST_F(EvictionTest, ASingleLargeSessionMayHoldMoreThanHalf) {
    holding("eve", 600 * kib);
    holding("eve", 20 * kib);
    holding("ada", 300 * kib);
    EXPECT_EQ(evict(), (std::vector<std::uint64_t>{1, 2, 3}));
    holding("ada", 150 * kib);
    EXPECT_EQ(evict(), (std::vector<std::uint64_t>{2, 3, 4})) << "all is full";
}

TEST_F(EvictionTest, TakesFromTheUserWithTheMostIfAllIsFull) {
    holding("eve", 100 * kib);
    holding("eve", 350 * kib);
    holding("ada", 400 * kib);
    holding("bob", 200 * kib);
    EXPECT_EQ(evict(), (std::vector<std::uint64_t>{1, 3, 4}));
}

TEST_F(EvictionTest, ClosesSessionsWithACommandUnderWayLast) {
    Session& commands = holding("eve", 300 * kib);
    commands.requests.begin_command(0);
    holding("eve", 250 * kib);
    EXPECT_EQ(evict(), std::vector<std::uint64_t>{1});
    commands.requests.end_command(0);
}

TEST_F(EvictionTest, CountsTheSnapshotsThatSessionsShare) {
    little_host.shared_snapshot_bytes = [] { return std::map<std::uint64_t, std::size_t>{{2, 400 * kib}}; };
    holding("eve", 200 * kib);
    holding("eve", 100 * kib);
    EXPECT_EQ(evict(), std::vector<std::uint64_t>{1});
}

} // namespace
} // namespace evod::network
