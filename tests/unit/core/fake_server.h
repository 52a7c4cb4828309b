// FakeServer: the other end of a connection, in the hands of a test, one step at a time.
#pragma once

#include "client/core/connection.h"
#include "tests/support/waiting.h"

#include <boost/asio.hpp>
#include <gtest/gtest.h>

#include <string>

namespace evod::core {

class FakeSession {
  public:
    explicit FakeSession(boost::asio::ip::tcp::socket socket) : socket_{std::move(socket)} {
        socket_.set_option(boost::asio::ip::tcp::no_delay{true});
    }

    std::size_t unread_bytes() const { return socket_.available(); }

    /// The next message of the client; an empty one when it has closed the connection.
    v1::ClientMessage read() {
        std::array<std::byte, codec::header_bytes> header_bytes;
        boost::system::error_code error;
        boost::asio::read(socket_, boost::asio::buffer(header_bytes), error);
        if (error) {
            return {};
        }
        const auto header = codec::decode_header(header_bytes, codec::server_limits).value();
        std::string body(header.body_bytes, '\0');
        boost::asio::read(socket_, boost::asio::buffer(body));
        return codec::parse_body<v1::ClientMessage>(std::as_bytes(std::span{body})).value();
    }
    v1::Request read_request() { return read().request(); }

    void write(const std::string& bytes) { boost::asio::write(socket_, boost::asio::buffer(bytes)); }
    void send(const v1::ServerMessage& message) { write(codec::encode_frame(codec::Channel::Control, message)); }
    void send(const v1::SnapshotFrame& frame) { write(codec::encode_frame(codec::Channel::Stream, frame)); }

    void welcome(std::uint32_t requests_in_flight_max = 0, v1::Role role = v1::ROLE_UNSPECIFIED,
                 const std::vector<std::string>& features = {}) {
        EXPECT_TRUE(read().has_hello());
        v1::ServerMessage message;
        message.mutable_welcome()->set_protocol_version(1);
        message.mutable_welcome()->set_server_version("fake");
        message.mutable_welcome()->set_role(role);
        message.mutable_welcome()->set_page_port(7745);
        message.mutable_welcome()->set_page_host("lab");
        message.mutable_welcome()->mutable_features()->Assign(features.begin(), features.end());
        message.mutable_welcome()->mutable_limits()->set_requests_in_flight_max(requests_in_flight_max);
        send(message);
    }
    void answer(const v1::Request& request, std::uint64_t tick = 0) {
        v1::ServerMessage message;
        message.mutable_response()->set_request_id(request.request_id());
        message.mutable_response()->mutable_status();
        message.mutable_response()->set_applied_tick(tick);
        send(message);
    }
    void answer_subscription(const v1::Request& request, std::uint32_t id) {
        v1::ServerMessage message;
        message.mutable_response()->set_request_id(request.request_id());
        message.mutable_response()->mutable_subscription()->set_subscription_id(id);
        send(message);
    }
    void refuse(std::uint64_t request_id, v1::Code code, const std::string& why) {
        v1::ServerMessage message;
        message.mutable_response()->set_request_id(request_id);
        message.mutable_response()->mutable_status()->set_code(code);
        message.mutable_response()->mutable_status()->set_message(why);
        send(message);
    }
    void say_goodbye(v1::Code code, const std::string& why) {
        v1::ServerMessage message;
        message.mutable_goodbye()->mutable_status()->set_code(code);
        message.mutable_goodbye()->mutable_status()->set_message(why);
        send(message);
    }
    void send_event(std::uint64_t tick) {
        v1::ServerMessage message;
        message.mutable_event()->set_tick(tick);
        send(message);
    }
    void send_snapshot(std::uint32_t subscription_id, std::uint32_t island, std::uint64_t tick) {
        v1::SnapshotFrame frame;
        frame.set_width_px(100);
        frame.set_height_px(100);
        codec::encode_plain({}, frame);
        frame.set_subscription_id(subscription_id);
        frame.set_island(island);
        frame.set_island_count(4);
        frame.set_tick(tick);
        send(frame);
    }

  private:
    boost::asio::ip::tcp::socket socket_;
};

class FakeServer {
  public:
    Endpoint endpoint() const { return {.host = "127.0.0.1", .port = acceptor_.local_endpoint().port()}; }
    Options options() const {
        return {.server = endpoint(),
                .client_name = "a test",
                .connect_timeout = hang,
                .backoff_min = std::chrono::milliseconds{1},
                .backoff_max = std::chrono::milliseconds{20}};
    }
    FakeSession accept() { return FakeSession{acceptor_.accept()}; }
    FakeSession accept_and_welcome(std::uint32_t requests_in_flight_max = 0, v1::Role role = v1::ROLE_UNSPECIFIED) {
        FakeSession session = accept();
        session.welcome(requests_in_flight_max, role);
        return session;
    }
    void stop_listening() { acceptor_.close(); }

  private:
    boost::asio::io_context io_;
    boost::asio::ip::tcp::acceptor acceptor_{io_, {boost::asio::ip::address_v4::loopback(), 0}};
};

} // namespace evod::core
