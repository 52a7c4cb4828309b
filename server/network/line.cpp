#include "server/network/line.h"

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

constexpr unsigned char tls_handshake = 22; // the type of TLS's first record, RFC 8446 §5.1

} // namespace

Line::Line(tcp::socket socket, asio::ssl::context* tls) : socket_{std::move(socket)} {
    if (tls != nullptr) {
        tls_.emplace(socket_, *tls);
    }
}

boost::system::error_code Line::not_tls() {
    return make_error_code(boost::system::errc::protocol_error);
}

asio::awaitable<boost::system::error_code> Line::begin() {
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

asio::awaitable<Line::Transferred> Line::read_some(asio::mutable_buffer buffer) {
    if (tls_) {
        co_return co_await tls_->async_read_some(buffer, no_throw);
    }
    co_return co_await socket_.async_read_some(buffer, no_throw);
}

Line::Transferred Line::write_now(std::span<const asio::const_buffer> buffers) {
    if (tls_) {
        return {};
    }
    std::array<iovec, buffers_at_once> parts;
    EVOD_ASSERT(buffers.size() <= parts.size());
    std::transform(buffers.begin(), buffers.end(), parts.begin(), [](const asio::const_buffer& buffer) {
        return iovec{const_cast<void*>(buffer.data()), buffer.size()}; // is not written to
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

asio::awaitable<Line::Transferred> Line::write(const std::vector<asio::const_buffer>& buffers) {
    if (tls_) {
        co_return co_await asio::async_write(*tls_, buffers, no_throw);
    }
    const auto count = [this, before = given_](const boost::system::error_code& error, std::size_t so_far) {
        given_ = before + so_far;
        return asio::transfer_all()(error, so_far);
    };
    co_return co_await asio::async_write(socket_, buffers, count, no_throw);
}

Line::Progress Line::progress() {
    int not_taken = 0;
    ::ioctl(socket_.native_handle(), SIOCOUTQ, &not_taken);
    return {.given = tls_ ? BIO_number_written(SSL_get_wbio(tls_->native_handle())) : given_,
            .not_taken = static_cast<std::uint64_t>(not_taken)};
}

asio::awaitable<void> Line::finish() {
    if (tls_) { // close_notify, RFC 8446 §6.1: who reads knows that this was all
        co_await tls_->async_shutdown(no_throw);
    }
    boost::system::error_code ignored; // it may be gone already
    socket_.shutdown(tcp::socket::shutdown_send, ignored);
}

void Line::abort() {
    boost::system::error_code ignored; // then it is closed as others are
    socket_.set_option(asio::socket_base::linger{true, 0}, ignored);
    close();
}

void Line::close() {
    boost::system::error_code ignored; // closed is closed
    socket_.close(ignored);
}

} // namespace evod::network
