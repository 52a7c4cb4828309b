#include "server/network/http.h"

#include "server/network/detached.h"

#include <boost/asio/co_spawn.hpp>

#include <cstddef>
#include <map>
#include <utility>

namespace evod::network {

base::Result<std::unique_ptr<Http>> Http::open(asio::io_context& context, const std::string& address,
                                               std::uint16_t port, HttpService service) {
    auto listener = Listener::open(context, address, port, {.address = "--http-bind", .port = "--http-port"});
    if (!listener) {
        return listener.error();
    }
    std::unique_ptr<Http> http{new Http{context, *std::move(listener), std::move(service)}};
    http->service_.ended = [to = http.get()](const HttpConnection& connection) {
        to->connections_.remove_if([&](const HttpConnectionPtr& other) { return other.get() == &connection; });
    };
    return http;
}

void Http::start() {
    asio::co_spawn(context_, listener_.accept([this](tcp::socket socket) { accepted(std::move(socket)); }), detached);
}

void Http::accepted(tcp::socket socket) {
    bool full = connections_.size() >= http_connections_max;
    if (full) {
        service_.limit_counters.met(Limit::HttpConnections);
        boost::system::error_code disconnected; // its address is then unspecified
        full = !make_room(address_key(socket.remote_endpoint(disconnected).address()));
    }
    if (closed_ || connections_.size() >= 2 * http_connections_max) {
        return;
    }
    connections_.push_back(std::make_shared<HttpConnection>(std::move(socket), service_, full));
    connections_.back()->start();
}

bool Http::make_room(const std::string& address_prefix) {
    std::map<std::string, std::size_t> counts;
    for (const HttpConnectionPtr& connection : connections_) {
        ++counts[connection->address_prefix()];
    }
    const std::size_t count_with_new = counts[address_prefix] + 1;
    auto chosen = connections_.end();
    std::pair<std::size_t, bool> most; // number of connections of the address; whether this one waits for a request
    for (auto at = connections_.begin(); at != connections_.end(); ++at) {
        const std::pair present{counts[(*at)->address_prefix()], (*at)->waits_for_request()};
        if ((present.second || present.first > count_with_new) && present > most) {
            chosen = at;
            most = present;
        }
    }
    if (chosen == connections_.end()) {
        return false;
    }
    const HttpConnectionPtr connection = *chosen;
    connections_.erase(chosen);
    connection->close();
    return true;
}

void Http::close() {
    closed_ = true;
    listener_.close();
    for (const HttpConnectionPtr& connection : connections_) {
        connection->close();
    }
}

} // namespace evod::network
