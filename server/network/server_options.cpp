#include "server/network/server_options.h"

#include <boost/asio/ip/address.hpp>

namespace evod::network {

bool needs_token(const ListenerOptions& listeners) {
    const auto is_reachable = [](const std::string& text) {
        boost::system::error_code no_address; // Listener::check() has already reported it
        const auto address = boost::asio::ip::make_address(text, no_address);
        return !no_address && !address.is_loopback();
    };
    // A proxy on this machine has a loopback address, whatever the address of its clients. --http-host announces one.
    return listeners.token_needed || is_reachable(listeners.bind_address) ||
           (listeners.http && (is_reachable(listeners.http->bind_address) || !listeners.http->host_names.empty()));
}

} // namespace evod::network
