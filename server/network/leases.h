// Leases: how long a client may hold a world that it steps with RunUntilTick. If a client disconnects or forgets its
// world, the lease expires and the world continues for the other clients.
//
// Owner        the dispatcher, on the network thread. The simulation decides whether a world is leased at all.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>

#include <functional>
#include <map>
#include <string>

namespace evod::network {

class Leases {
  public:
    /// expired  called every lease_time after a lease has expired, until end() or begin() for that world.
    Leases(boost::asio::io_context& context, std::function<void(const std::string& world, std::uint64_t lease)> expired)
        : context_{context}, expired_{std::move(expired)} {}

    /// Starts a lease and replaces an earlier one of the world.
    ///
    /// lease  the number of the lease in its world (simulation::RunControl).
    void begin(const std::string& world, std::uint64_t lease, const std::string& client_key);
    /// Extends the lease. false: the client_key has no lease of the world.
    bool renew(const std::string& world, const std::string& client_key);
    void end(const std::string& world) { leases_.erase(world); }
    void end_all() { leases_.clear(); }

  private:
    struct Lease {
        std::uint64_t number;
        std::string client_key;
        boost::asio::steady_timer timer;
    };
    void await_end(const std::string& world, Lease& lease);

    boost::asio::io_context& context_;
    const std::function<void(const std::string& world, std::uint64_t lease)> expired_;
    std::map<std::string, Lease> leases_; // by world
};

} // namespace evod::network
