// Loopback: sessions with their clients on the loopback interface, without the rest of the server.
//
// Threads  one; the test turns the loop with settle().
#pragma once

#include "server/network/streams.h"
#include "tests/support/manual_clock.h"

#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/write.hpp>
#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <vector>

namespace evod::network {

class Loopback : public testing::Test {
  protected:
    struct Client {
        explicit Client(asio::io_context& context) : socket{context} {}

        tcp::socket socket;
        SessionPtr session; // the server's end
        codec::FrameReader reader{codec::client_limits};
        std::vector<v1::Response> responses;
        std::vector<v1::Event> events;
        std::vector<v1::SnapshotFrame> snapshots;
        bool ended = false; // the server has closed its sending side
    };

    Loopback() {
        host.clock = &clock;
        host.limits = limits_message({});
        host.admit = [this](const std::string&, const std::string&) {
            return access::AuthenticatedUser{.name = "", .role = role};
        };
        host.ended = [this](Session& ended) { sessions.erase(ended.number()); };
    }
    void TearDown() override {
        for (const auto& client : clients) {
            client->session->close();
        }
        context.restart();
        context.run();
        EXPECT_TRUE(sessions.empty());
    }

    /// A client that has sent its Hello and received the Welcome.
    Client& connect(access::Role as) {
        role = as;
        Client& client = *clients.emplace_back(std::make_unique<Client>(context));
        tcp::acceptor acceptor{context, tcp::endpoint{asio::ip::address_v4::loopback(), 0}};
        client.socket.connect(acceptor.local_endpoint());
        client.socket.set_option(tcp::no_delay{true}); // or a request waits until the one before is acknowledged
        client.session = std::make_shared<Session>(acceptor.accept(), host, clients.size());
        sessions.emplace(clients.size(), client.session);
        client.session->start();
        v1::ClientMessage message;
        message.mutable_hello()->set_protocol_version(codec::protocol_version);
        send(client, message);
        EXPECT_TRUE(client.session->greeted());
        return client;
    }
    void send(Client& client, const v1::ClientMessage& message) {
        client.socket.non_blocking(false);
        asio::write(client.socket, asio::buffer(codec::encode_frame(codec::Channel::Control, message)));
        settle();
    }
    /// Lets sessions and clients exchange everything that is on its way.
    void settle() {
        for (int turn = 0; turn < 100; ++turn) {
            context.restart();
            context.poll();
            for (const auto& client : clients) {
                read(*client);
            }
        }
    }

    support::ManualClock clock;
    LimitCounters counters;
    SendMemory memory{std::size_t{1} << 30, [] {}};
    SessionHost host{counters, memory};
    asio::io_context context;
    access::Role role = access::Role::Admin; // of the next client
    Sessions sessions;
    std::vector<std::unique_ptr<Client>> clients;

  private:
    static void read(Client& client) {
        std::array<std::byte, 4096> bytes;
        client.socket.non_blocking(true);
        boost::system::error_code error;
        while (const std::size_t count = client.socket.read_some(asio::buffer(bytes), error)) {
            client.reader.feed({bytes.data(), count});
        }
        client.ended = error == asio::error::eof;
        for (auto frame = client.reader.next(); frame && *frame; frame = client.reader.next()) {
            if ((*frame)->channel == codec::Channel::Stream) {
                client.snapshots.push_back(codec::parse_body<v1::SnapshotFrame>((*frame)->body).value());
                continue;
            }
            const v1::ServerMessage message = codec::parse_body<v1::ServerMessage>((*frame)->body).value();
            if (message.has_response()) {
                client.responses.push_back(message.response());
            } else if (message.has_event()) {
                client.events.push_back(message.event());
            }
        }
    }
};

} // namespace evod::network
