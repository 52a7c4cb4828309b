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

} // namespace

Transport::Transport(tcp::socket socket, asio::ssl::context* tls) : socket_{std::move(socket)} {
    if (tls != nullptr) {
        tls_.emplace(socket_, *tls);
    }
}

boost::system::error_code Transport::not_tls() {
    return make_error_code(boost::system::errc::protocol_error);
}

asio::awaitable<boost::system::error_code> Transport::begin() {
    if (!tls_) {
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

asio::awaitable<Transport::Transferred> Transport::read_some(asio::mutable_buffer buffer) {
    if (tls_) {
        co_return co_await tls_->async_read_some(buffer, no_throw);
    }
    co_return co_await socket_.async_read_some(buffer, no_throw);
}

Transport::Transferred Transport::write_now(std::span<const asio::const_buffer> buffers) {
    if (tls_) {
        return {};
    }
    std::array<iovec, buffers_at_once> parts;
    EVOD_ASSERT(buffers.size() <= parts.size());
    std::transform(buffers.begin(), buffers.end(), parts.begin(), [](const asio::const_buffer& buffer) {
        return iovec{const_cast<void*>(buffer.data()), buffer.size()}; // sendmsg() does not modify it
    });
    msghdr message{};
    message.msg_iov = parts.data();
    message.msg_iovlen = buffers.size();
    const ssize_t sent = ::sendmsg(socket_.native_handle(), &message, MSG_DONTWAIT | MSG_NOSIGNAL);
    if (sent >= 0) {
        given_ += static_cast<std::uint64_t>(sent);
        return {boost::system::error_code{}, static_cast<std::size_t>(sent)};
    }
    if (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR) {
        return {};
    }
    return {boost::system::error_code{errno, boost::system::system_category()}, 0};
}

asio::awaitable<Transport::Transferred> Transport::write(const std::vector<asio::const_buffer>& buffers) {
    if (tls_) {
        co_return co_await asio::async_write(*tls_, buffers, no_throw);
    }
    const auto count = [this, before = given_](const boost::system::error_code& error, std::size_t so_far) {
        given_ = before + so_far;
        return asio::transfer_all()(error, so_far);
    };
    co_return co_await asio::async_write(socket_, buffers, count, no_throw);
}

Transport::Progress Transport::progress() {
    int not_taken = 0;
    ::ioctl(socket_.native_handle(), SIOCOUTQ, &not_taken);
    return {.given = tls_ ? BIO_number_written(SSL_get_wbio(tls_->native_handle())) : given_,
            .not_taken = static_cast<std::uint64_t>(not_taken)};
}

asio::awaitable<void> Transport::finish() {
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

tcp::endpoint Transport::peer() const {
    boost::system::error_code ignored; // a disconnected client has no address
    return socket_.remote_endpoint(ignored);
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
    std::fill(bytes.begin() + 8, bytes.end(), static_cast<unsigned char>(0));
    return asio::ip::address_v6{bytes}.to_string();
}

} // namespace evod::network
