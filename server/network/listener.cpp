#include "server/network/listener.h"

#include "server/log/log.h"
#include "server/network/limits.h"
#include "server/network/no_throw.h"

#include <boost/asio/ip/address.hpp>
#include <boost/asio/steady_timer.hpp>

#include <sys/resource.h>

#include <algorithm>
#include <utility>

namespace evod::network {

namespace asio = boost::asio;
using asio::ip::tcp;

base::Result<void> Listener::check(const std::string& address, const char* option) {
    boost::system::error_code error;
    (void)asio::ip::make_address(address, error);
    if (!error) {
        return {};
    }
    return base::refusal(
        base::RefusalCode::InvalidArgument,
        std::string{option} + ": got '" + address +
            "', allowed the IP address of an interface, such as 127.0.0.1, or 0.0.0.0 for all interfaces");
}

base::Result<Listener> Listener::open(asio::io_context& context, const std::string& address, std::uint16_t port,
                                      const Names& names) {
    if (auto sound = check(address, names.address); !sound) {
        return sound.error();
    }
    const std::string where = address + ":" + std::to_string(port);
    const auto refused = [&](const std::string& why) {
        return base::Refusal{.code = base::RefusalCode::FailedPrecondition,
                             .message = "cannot listen on " + where + ": " + why,
                             .violations = {}};
    };
    boost::system::error_code error;
    const auto ip = asio::ip::make_address(address, error);
    tcp::acceptor acceptor{context};
    const tcp::endpoint endpoint{ip, port};
    acceptor.open(endpoint.protocol(), error);
    if (!error) {
        acceptor.set_option(tcp::acceptor::reuse_address{true},
                            error); // allows binding while connections of an earlier server are still closing
    }
    if (!error) {
        acceptor.bind(endpoint, error);
    }
    if (!error) {
        acceptor.listen(asio::socket_base::max_listen_connections, error);
    }
    if (error == asio::error::address_in_use) {
        return refused(
            std::string{"the port is in use, perhaps by another evod: stop it, or choose another port with "} +
            names.port);
    }
    if (error == asio::error::access_denied) {
        return refused(std::string{"ports below 1024 require privileges: choose another port with "} + names.port);
    }
    if (error) {
        return refused(error.message());
    }
    return Listener{std::move(acceptor)};
}

namespace {

/// The number of file descriptors that the system allows this process to open.
rlim_t descriptors_max() {
    rlimit limit{};
    return ::getrlimit(RLIMIT_NOFILE, &limit) == 0 ? limit.rlim_cur : RLIM_INFINITY;
}

/// Whether so few descriptors are free that the rest is reserved for run files. The system always assigns the lowest
/// free number, so a high number means that few descriptors are free.
bool is_reserved_descriptor(int descriptor) {
    const rlim_t most = descriptors_max();
    return static_cast<rlim_t>(descriptor) + std::min(descriptors_kept, most / 8) >= most;
}

} // namespace

asio::awaitable<void> Listener::accept(std::function<void(tcp::socket)> accepted) {
    asio::steady_timer pause{acceptor_.get_executor()};
    bool reported = false;
    while (acceptor_.is_open()) {
        auto [error, socket] = co_await acceptor_.async_accept(no_throw);
        if (!error && is_reserved_descriptor(socket.native_handle())) {
            boost::system::error_code ignored; // the connection may be closed already
            socket.close(ignored);
            error = asio::error::no_descriptors;
        }
        if (!error) {
            reported = false;
            // The system still returns the bytes of a client that has reset its connection, but no longer its address.
            boost::system::error_code disconnected;
            (void)socket.remote_endpoint(disconnected);
            if (!disconnected) {
                accepted(std::move(socket));
            }
        } else if (error != asio::error::operation_aborted && error != asio::error::connection_aborted) {
            // accept() would fail again immediately. During the pause sessions may end and free descriptors.
            if (!std::exchange(reported, true)) {
                log::warn("cannot accept a connection: {}; new connections wait{}", error.message(),
                          error == asio::error::no_descriptors
                              ? " until one of the " + std::to_string(descriptors_max()) +
                                    " file descriptors is free: allow more with ulimit -n or systemd's LimitNOFILE"
                              : "");
            }
            pause.expires_after(accept_pause);
            co_await pause.async_wait(no_throw);
        }
    }
}

void Listener::close() {
    boost::system::error_code ignored; // the port may be closed already
    acceptor_.close(ignored);
}

} // namespace evod::network
