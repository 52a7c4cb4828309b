#include "server/network/listener.h"

#include "server/log/log.h"
#include "server/network/limits.h"

#include <boost/asio/as_tuple.hpp>
#include <boost/asio/ip/address.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/use_awaitable.hpp>

#include <utility>

namespace evod::network {

namespace asio = boost::asio;
using asio::ip::tcp;

base::Result<Listener> Listener::open(asio::io_context& context, const std::string& address, std::uint16_t port,
                                      const Names& names) {
    const std::string where = address + ":" + std::to_string(port);
    const auto refused = [&](const std::string& why) {
        return base::Refusal{.code = base::RefusalCode::FailedPrecondition,
                             .message = "cannot listen on " + where + ": " + why,
                             .violations = {}};
    };
    boost::system::error_code error;
    const auto ip = asio::ip::make_address(address, error);
    if (error)
        return refused("'" + address + "' is not an IP address; give " + names.address +
                       " the address of an interface, such as 127.0.0.1, or 0.0.0.0 for all of them");
    tcp::acceptor acceptor{context};
    const tcp::endpoint endpoint{ip, port};
    acceptor.open(endpoint.protocol(), error);
    if (!error)
        acceptor.set_option(tcp::acceptor::reuse_address{true},
                            error); // do not wait for old connections to be forgotten
    if (!error)
        acceptor.bind(endpoint, error);
    if (!error)
        acceptor.listen(asio::socket_base::max_listen_connections, error);
    if (error == asio::error::address_in_use)
        return refused(std::string{"the port is taken, perhaps by another evod; stop that, or choose another with "} +
                       names.port);
    if (error == asio::error::access_denied)
        return refused(std::string{"ports below 1024 need privileges; choose another with "} + names.port);
    if (error)
        return refused(error.message());
    return Listener{std::move(acceptor)};
}

asio::awaitable<void> Listener::accept(std::function<void(tcp::socket)> accepted) {
    asio::steady_timer pause{acceptor_.get_executor()};
    while (acceptor_.is_open()) {
        auto [error, socket] = co_await acceptor_.async_accept(asio::as_tuple(asio::use_awaitable));
        if (!error) {
            accepted(std::move(socket));
        } else if (error != asio::error::operation_aborted && error != asio::error::connection_aborted) {
            // Out of descriptors or memory: it would fail again at once, so give sessions time to end.
            log::warn("cannot accept a connection: {}", error.message());
            pause.expires_after(accept_pause);
            co_await pause.async_wait(asio::as_tuple(asio::use_awaitable));
        }
    }
}

void Listener::close() {
    boost::system::error_code ignored; // closed is closed
    acceptor_.close(ignored);
}

} // namespace evod::network
