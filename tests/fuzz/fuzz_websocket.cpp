// Fuzzes the way of a browser's bytes: request, handshake, frames of the WebSocket, frames of the protocol. A real HTTP
// connection and the session that it becomes serve one end of a socket pair; the other end sends the input in pieces.
//
// The first byte of the input says how: whether a valid handshake and a valid Hello precede the rest, the size of the
// pieces, whether the client reads, and whether the server ends the session in the end.
//
// Invariants: the connection ends with its client and leaves no memory counted; decoding does not depend on the pieces;
// what the server sends are HTTP answers, then whole unmasked frames, with whole frames of the protocol in them.
#include "server/log/log.h"
#include "server/network/http_connection.h"
#include "server/network/session.h"
#include "server/protocol/refusals.h"
#include "tests/fuzz/valid_snapshot.h"
#include "tests/support/manual_clock.h"

#include <boost/asio/io_context.hpp>

#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace evod::fuzz {
namespace {

using network::Session;

constexpr std::string_view handshake =
    "GET /session HTTP/1.1\r\nHost: localhost\r\nOrigin: http://localhost\r\nUpgrade: websocket\r\nConnection: "
    "Upgrade\r\n"
    "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n";

/// A binary message of at most 125 bytes, masked with zeros.
std::string message_of(const std::string& content) {
    require(content.size() < 126);
    return std::string{"\x82"} + static_cast<char>(0x80 | content.size()) + std::string(4, '\0') + content;
}

std::string hello() {
    v1::ClientMessage message;
    message.mutable_hello()->set_protocol_version(codec::protocol_version);
    return codec::encode_frame(codec::Channel::Control, message);
}

/// Everything that a decoder found in bytes.
struct Decoded {
    std::string content, ping;
    std::uint64_t empty_frame_count = 0;
    std::optional<network::WebSocketClose> fault;
    bool closed = false;
    bool operator==(const Decoded&) const = default;
};

Decoded decode(std::string_view bytes, std::size_t piece_bytes) {
    network::WebSocketDecoder decoder;
    Decoded decoded;
    while (!bytes.empty()) {
        std::string piece{bytes.substr(0, piece_bytes)};
        bytes.remove_prefix(piece.size());
        const std::size_t count = decoder.decode(std::as_writable_bytes(std::span{piece}));
        require(count <= piece.size());
        decoded.content += piece.substr(0, count);
        if (const auto ping = decoder.take_ping()) {
            decoded.ping = *ping;
        }
        decoded.empty_frame_count += decoder.take_empty_frame_count();
    }
    if (decoder.fault()) {
        decoded.fault = decoder.fault()->code;
    }
    decoded.closed = decoder.closed();
    return decoded;
}

/// Checks what the server sends.
class Listener {
  public:
    void hear(std::string_view bytes) {
        received_ += bytes;
        while (!upgraded_) {
            const auto end = received_.find("\r\n\r\n");
            if (end == std::string::npos) {
                return;
            }
            require(received_.starts_with("HTTP/1."));
            const std::string head = received_.substr(0, end + 4);
            upgraded_ = head.starts_with("HTTP/1.1 101 ");
            if (!upgraded_) {
                received_.clear(); // the bodies of answers are not parsed
                return;
            }
            received_.erase(0, head.size());
        }
        while (take_frame()) {
        }
    }

  private:
    bool take_frame() {
        const auto byte = [&](std::size_t at) {
            return static_cast<std::size_t>(static_cast<unsigned char>(received_[at]));
        };
        if (received_.size() < 2) {
            return false;
        }
        require(!closed_ && (byte(0) & 0xf0) == 0x80 && byte(1) < 128);
        const std::size_t opcode = byte(0) & 15;
        const std::size_t length_bytes = byte(1) == 126 ? 2 : byte(1) == 127 ? 8 : 0;
        if (received_.size() < 2 + length_bytes) {
            return false;
        }
        std::size_t length = length_bytes == 0 ? byte(1) : 0;
        for (std::size_t i = 0; i < length_bytes; ++i) {
            length = length << 8 | byte(2 + i);
        }
        const std::size_t at = 2 + length_bytes;
        if (received_.size() < at + length) {
            return false;
        }
        require(opcode == 2 || ((opcode == 8 || opcode == 9 || opcode == 10) && length < 126));
        closed_ = opcode == 8;
        if (opcode == 2) {
            reader_.feed(std::as_bytes(std::span{received_}.subspan(at, length)));
            while (true) {
                const auto frame = reader_.next();
                require(frame.has_value());
                if (!*frame) {
                    break;
                }
                require(codec::parse_body<v1::ServerMessage>((*frame)->body).has_value());
            }
        }
        received_.erase(0, at + length);
        return true;
    }

    std::string received_;
    bool upgraded_ = false, closed_ = false;
    codec::FrameReader reader_{codec::client_limits};
};

class Play {
  public:
    explicit Play(std::uint8_t how) : how_{how} {
        host_.clock = &clock_;
        host_.limits = network::limits_message({});
        host_.admit = [](const std::string&, const std::string&) { return access::AuthenticatedUser{}; };
        host_.handle = [](Session& session, const v1::Request& request) {
            session.send_unasked(protocol::refusing(
                request.request_id(), base::refusal(base::RefusalCode::Unimplemented, "there is no simulation")));
        };
        host_.ended = [this](Session&) {
            session_.reset();
            ended_ = true;
        };
        service_.session = [this](std::unique_ptr<network::Transport> transport) {
            session_ = std::make_shared<Session>(std::move(transport), host_, 1);
            session_->start();
        };
        service_.ended = [this](const network::HttpConnection&) { ended_ = session_ == nullptr; };
        service_.pages["/metrics"] = {.make = []() -> network::asio::awaitable<network::HttpAnswer> {
            co_return network::HttpAnswer{.text = "metrics\n"};
        }};
        std::array<int, 2> ends{};
        require(::socketpair(AF_UNIX, SOCK_STREAM, 0, ends.data()) == 0);
        client_ = ends[0];
        if ((how_ & 32) != 0) { // a small socket buffer, so that data has to wait
            const int bytes = 1;
            require(::setsockopt(ends[1], SOL_SOCKET, SO_SNDBUF, &bytes, sizeof bytes) == 0);
        }
        network::tcp::socket socket{context_};
        socket.assign(network::tcp::v4(), ends[1]); // another family, but no code reads it
        std::make_shared<network::HttpConnection>(std::move(socket), service_, false)->start();
    }
    ~Play() {
        ::close(client_);
        for (int round = 0; !ended_; ++round) {
            require(round < 1000);
            poll();
        }
        require(send_memory_.bytes() == 0);
    }
    Play(const Play&) = delete;
    Play& operator=(const Play&) = delete;

    void send(std::string_view bytes) {
        poll();
        while (!bytes.empty()) {
            const ssize_t sent =
                ::send(client_, bytes.data(), std::min(bytes.size(), piece_bytes()), MSG_DONTWAIT | MSG_NOSIGNAL);
            if (sent < 0) {
                return; // closed, or the server does not read
            }
            bytes.remove_prefix(static_cast<std::size_t>(sent));
            poll();
            if ((how_ & 64) != 0) {
                hear();
            }
            if (session_ != nullptr && (how_ & 128) != 0) {
                session_->check_progress(std::chrono::seconds{1});
            }
        }
    }

    /// Lets the server end the session, and reads everything.
    void end() {
        if (session_ != nullptr && (how_ & 64) != 0) {
            session_->fail(base::refusal(base::RefusalCode::Unavailable, "the end", base::Reason::ServerGoingAway));
        }
        for (int round = 0; round < 20; ++round) {
            poll();
            hear();
        }
    }

    std::size_t piece_bytes() const {
        constexpr std::array<std::size_t, 8> sizes{1, 2, 3, 7, 16, 100, 1000, 100'000};
        return sizes[how_ >> 2 & 7];
    }

  private:
    void poll() {
        context_.restart();
        context_.poll();
    }
    void hear() {
        std::array<char, 65536> bytes;
        for (ssize_t count = 1; count > 0;) {
            count = ::recv(client_, bytes.data(), bytes.size(), MSG_DONTWAIT);
            if (count > 0) {
                listener_.hear({bytes.data(), static_cast<std::size_t>(count)});
            }
        }
    }

    const std::uint8_t how_;
    support::ManualClock clock_;
    network::LimitCounters limit_counters_;
    network::SendMemory send_memory_{2 * network::client_buffer_bytes_max, [] { require(false); }};
    boost::asio::io_context context_{1};
    network::SessionHost host_{limit_counters_, send_memory_};
    network::HttpService service_{.limit_counters = limit_counters_,
                                  .traffic = host_.traffic,
                                  .host_names = *network::HostNames::make({}, "fuzz", {})};
    network::SessionPtr session_;
    bool ended_ = false;
    int client_ = -1;
    Listener listener_;
};

} // namespace
} // namespace evod::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace evod;
    [[maybe_unused]] static const bool quiet = (log::begin(log::Level::Error, log::Format::Text), true);
    if (size == 0) {
        return 0;
    }
    const std::string_view bytes{reinterpret_cast<const char*>(data) + 1, size - 1};
    fuzz::Play play{data[0]};
    fuzz::require(fuzz::decode(bytes, play.piece_bytes()) == fuzz::decode(bytes, SIZE_MAX));
    if ((data[0] & 1) != 0) {
        play.send(fuzz::handshake);
    }
    if ((data[0] & 2) != 0) {
        play.send(fuzz::message_of(fuzz::hello()));
    }
    play.send(bytes);
    play.end();
    return 0;
}
