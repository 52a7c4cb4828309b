#include "server/network/http.h"

#include "server/network/detached.h"

#include <boost/asio/co_spawn.hpp>

#include <algorithm>
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

base::Quota Http::places() const {
    base::Quota held{http_connections_max};
    for (const HttpConnectionPtr& connection : connections_) {
        held.take(connection->address_prefix());
    }
    return held;
}

void Http::accepted(tcp::socket socket) {
    boost::system::error_code disconnected; // its address is then unspecified
    const bool has_place = make_room(address_key(socket.remote_endpoint(disconnected).address()));
    if (closed_ || connections_.size() >= 2 * http_connections_max) {
        return;
    }
    connections_.push_back(std::make_shared<HttpConnection>(std::move(socket), service_, !has_place));
    connections_.back()->start();
}

bool Http::make_room(const std::string& address_prefix) {
    const base::Quota held = places();
    const auto verdict = held.ask(address_prefix);
    if (verdict == base::Quota::Verdict::Free) {
        return true;
    }
    service_.limit_counters.met(Limit::HttpConnections);
    const std::string& from = verdict == base::Quota::Verdict::UserFull ? address_prefix : held.largest();
    const auto is_of_it = [&](const HttpConnectionPtr& connection) { return connection->address_prefix() == from; };
    auto chosen = std::ranges::find_if(connections_, [&](const HttpConnectionPtr& connection) {
        return is_of_it(connection) && connection->waits_for_request();
    });
    if (chosen == connections_.end() && verdict == base::Quota::Verdict::FromLargest) {
        chosen = std::ranges::find_if(connections_, is_of_it);
    }
    if (chosen == connections_.end()) {
        return false;
    }
    if (from != address_prefix) {
        service_.limit_counters.took_back(Limit::HttpConnections);
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
