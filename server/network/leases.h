// Leases: limit how long a client that steps a world with RunUntilTick can keep the world paused. If the client
// disconnects or stops renewing its lease, the lease expires and the world continues for the other clients.
//
// Owner        the dispatcher, on the network thread. The simulation decides whether a world has a lease.
#pragma once

#include "server/network/user_key.h"

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>

#include <functional>
#include <map>
#include <optional>
#include <string>

namespace evod::network {

class Leases {
  public:
    /// expired  called when the lease of a world expires, and again every lease_time until end() or begin() is called
    ///          for the world.
    Leases(boost::asio::io_context& context, std::function<void(const std::string& world, std::uint64_t lease)> expired)
        : context_{context}, expired_{std::move(expired)} {}

    /// Starts a lease. If the world already has a lease, the new one replaces it.
    ///
    /// lease   number of the lease within its world (simulation::RunControl).
    /// holder  nullopt: a client of the server before this one, so the lease cannot be renewed.
    void begin(const std::string& world, std::uint64_t lease, const std::optional<UserKey>& holder);
    /// Extends the lease. Returns false if this key does not hold the lease of the world.
    bool renew(const std::string& world, const UserKey& key);
    void end(const std::string& world) { leases_.erase(world); }
    void end_all() { leases_.clear(); }

  private:
    struct Lease {
        std::uint64_t number;
        std::optional<UserKey> holder;
        boost::asio::steady_timer timer;
    };
    void await_end(const std::string& world, Lease& lease);

    boost::asio::io_context& context_;
    const std::function<void(const std::string& world, std::uint64_t lease)> expired_;
    std::map<std::string, Lease> leases_; // key: name of the world
};

} // namespace evod::network
