#include "server/network/transport.h"

#include "server/base/assert.h"
#include "server/network/no_throw.h"

#include <boost/asio/write.hpp>

#include <linux/sockios.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/uio.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <utility>

namespace evod::network {
namespace {

constexpr unsigned char tls_handshake = 22; // the type of the first record of TLS, RFC 8446 section 5.1

tcp::endpoint peer_of(const tcp::socket& socket) {
    boost::system::error_code ignored; // a disconnected client has no address
    return socket.remote_endpoint(ignored);
}

} // namespace

Transport::Transport(tcp::socket socket, asio::ssl::context* tls)
    : socket_{std::move(socket)}, peer_{peer_of(socket_)} {
    if (tls != nullptr) {
        tls_.emplace(socket_, *tls);
    }
}

boost::system::error_code Transport::not_tls() {
    return make_error_code(boost::system::errc::protocol_error);
}

boost::system::error_code Transport::websocket_fault() {
    return make_error_code(boost::system::errc::bad_message);
}

asio::awaitable<boost::system::error_code> Transport::begin() {
    if (std::exchange(begun_, true) || !tls_) {
        co_return boost::system::error_code{};
    }
    unsigned char first = tls_handshake;
    const auto [peek_error, count] =
        co_await socket_.async_receive(asio::buffer(&first, 1), tcp::socket::message_peek, no_throw);
    if (peek_error) {
        co_return peek_error;
    }
    if (first != tls_handshake) {
        tls_.reset();
        co_return not_tls();
    }
    const auto [error] = co_await tls_->async_handshake(asio::ssl::stream_base::server, no_throw);
    co_return error;
}

void Transport::begin_websocket(std::string received) {
    websocket_ = WebSocket{.received = std::move(received), .decoder = {}, .pong = {}, .header_rest = {}, .prefix = {}};
}

asio::awaitable<Transport::Transferred> Transport::read_some(asio::mutable_buffer buffer) {
    return websocket_ ? read_messages(buffer) : receive_some(buffer);
}

asio::awaitable<Transport::Transferred> Transport::receive_some(asio::mutable_buffer buffer) {
    if (websocket_ && !websocket_->received.empty()) {
        std::string& received = websocket_->received;
        const std::size_t count = asio::buffer_copy(buffer, asio::buffer(received));
        received.erase(0, count);
        co_return Transferred{boost::system::error_code{}, count};
    }
    if (tls_) {
        co_return co_await tls_->async_read_some(buffer, no_throw);
    }
    co_return co_await socket_.async_read_some(buffer, no_throw);
}

asio::awaitable<Transport::Transferred> Transport::read_messages(asio::mutable_buffer buffer) {
    WebSocketDecoder& decoder = websocket_->decoder;
    std::size_t decoded = 0;
    if (!decoder.fault() && !decoder.closed()) {
        const auto [error, count] = co_await receive_some(buffer);
        if (error) {
            co_return Transferred{error, 0};
        }
        decoded = decoder.decode({static_cast<std::byte*>(buffer.data()), count});
        if (auto payload = decoder.take_ping()) {
            websocket_->pong = *std::move(payload);
        }
    }
    if (decoded == 0 && decoder.fault()) {
        co_return Transferred{websocket_fault(), 0};
    }
    if (decoded == 0 && decoder.closed()) {
        co_return Transferred{asio::error::eof, 0};
    }
    co_return Transferred{boost::system::error_code{}, decoded};
}

Transport::Transferred Transport::write_now(std::span<const asio::const_buffer> buffers) {
    if (tls_ || control_waits()) {
        return {};
    }
    std::array<iovec, 1 + buffers_at_once> parts;
    EVOD_ASSERT(buffers.size() <= buffers_at_once);
    std::size_t part_count = 0, bytes = 0;
    for (const asio::const_buffer& buffer : buffers) {
        bytes += buffer.size();
    }
    WebSocketHeader header;
    if (websocket_) {
        EVOD_ASSERT(websocket_->message_rest == 0);
        header = binary_message_header(bytes);
        parts[part_count++] = iovec{header.bytes.data(), header.size};
    }
    for (const asio::const_buffer& buffer : buffers) {
        parts[part_count++] = iovec{const_cast<void*>(buffer.data()), buffer.size()}; // sendmsg() does not modify it
    }
    msghdr message{};
    message.msg_iov = parts.data();
    message.msg_iovlen = part_count;
    const ssize_t sent = ::sendmsg(socket_.native_handle(), &message, MSG_DONTWAIT | MSG_NOSIGNAL);
    if (sent < 0) {
        if (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR) {
            return {};
        }
        return {boost::system::error_code{errno, boost::system::system_category()}, 0};
    }
    auto count = static_cast<std::size_t>(sent);
    given_ += count;
    if (websocket_ && count > 0) {
        const std::size_t of_header = std::min(count, header.size);
        websocket_->header_rest = header.view().substr(of_header);
        count -= of_header;
        websocket_->message_rest = bytes - count;
    }
    return {boost::system::error_code{}, count};
}

asio::awaitable<Transport::Transferred> Transport::write(const std::vector<asio::const_buffer>& buffers) {
    return websocket_ ? write_message(buffers) : write_bytes(buffers);
}

asio::awaitable<Transport::Transferred> Transport::write_message(const std::vector<asio::const_buffer>& buffers) {
    WebSocket& websocket = *websocket_;
    const std::size_t bytes = asio::buffer_size(buffers);
    std::string& prefix = websocket.prefix;
    prefix.clear();
    if (websocket.message_rest > 0) {
        EVOD_ASSERT(bytes == websocket.message_rest);
        prefix = std::exchange(websocket.header_rest, {});
    } else {
        // Only the newest ping needs an answer, RFC 6455 section 5.5.3.
        if (const auto pong = std::exchange(websocket.pong, std::nullopt)) {
            prefix += encode_pong(*pong);
        }
        if (std::exchange(websocket.ping_due, false)) {
            prefix += encode_ping();
        }
        if (bytes > 0) {
            prefix += binary_message_header(bytes).view();
        }
    }
    std::vector<asio::const_buffer> all{asio::buffer(prefix)};
    all.insert(all.end(), buffers.begin(), buffers.end());
    const auto [error, count] = co_await write_bytes(all);
    if (!error) {
        websocket.message_rest = 0;
    }
    co_return Transferred{error, count - std::min(count, prefix.size())};
}

asio::awaitable<Transport::Transferred> Transport::write_bytes(const std::vector<asio::const_buffer>& buffers) {
    if (tls_) {
        co_return co_await asio::async_write(*tls_, buffers, no_throw);
    }
    const auto count = [this, before = given_](const boost::system::error_code& error, std::size_t so_far) {
        given_ = before + so_far;
        return asio::transfer_all()(error, so_far);
    };
    co_return co_await asio::async_write(socket_, buffers, count, no_throw);
}

std::optional<WebSocketDecoder::Fault> Transport::fault() const {
    return websocket_ ? websocket_->decoder.fault() : std::nullopt;
}

std::uint64_t Transport::take_empty_frame_count() {
    return websocket_ ? websocket_->decoder.take_empty_frame_count() : 0;
}

void Transport::ping() {
    EVOD_ASSERT(websocket_);
    websocket_->ping_due = true;
}

Transport::Progress Transport::progress() {
    int not_taken = 0;
    ::ioctl(socket_.native_handle(), SIOCOUTQ, &not_taken);
    return {.given = tls_ ? BIO_number_written(SSL_get_wbio(tls_->native_handle())) : given_,
            .not_taken = static_cast<std::uint64_t>(not_taken)};
}

asio::awaitable<void> Transport::finish(WebSocketClose code) {
    if (websocket_) {
        websocket_->prefix = encode_close(code);
        const std::vector<asio::const_buffer> close{asio::buffer(websocket_->prefix)};
        co_await write_bytes(close);
    }
    if (tls_) { // sends close_notify, which marks the complete end of the stream (RFC 8446 section 6.1)
        co_await tls_->async_shutdown(no_throw);
    }
    boost::system::error_code ignored; // the peer may have closed the connection
    socket_.shutdown(tcp::socket::shutdown_send, ignored);
}

void Transport::abort() {
    boost::system::error_code ignored; // if the option cannot be set, close() sends the remaining bytes first
    socket_.set_option(asio::socket_base::linger{true, 0}, ignored);
    close();
}

void Transport::close() {
    boost::system::error_code ignored; // the connection may be closed already
    socket_.close(ignored);
}

tcp::endpoint Transport::local() const {
    boost::system::error_code ignored; // a disconnected client has no address
    return socket_.local_endpoint(ignored);
}

std::string to_text(const tcp::endpoint& endpoint) {
    return endpoint.address().to_string() + ":" + std::to_string(endpoint.port());
}

std::string address_key(const asio::ip::address& address) {
    if (!address.is_v6()) {
        return address.to_string();
    }
    auto bytes = address.to_v6().to_bytes();
    if (address.to_v6().is_v4_mapped()) {
        return asio::ip::make_address_v4(asio::ip::v4_mapped, address.to_v6()).to_string();
    }
    std::fill(bytes.begin() + 6, bytes.end(), static_cast<unsigned char>(0));
    return asio::ip::address_v6{bytes}.to_string();
}

} // namespace evod::network
