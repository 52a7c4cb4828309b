// Leases: worlds that are lent to whoever steps them with RunUntilTick, and how long yet. A client that has gone, or
// forgets its world, cannot keep it standing for others.
//
// Owner        the dispatcher; on the network thread. Whether a world is lent at all is known to the simulation alone.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>

#include <functional>
#include <map>
#include <string>

namespace evod::network {

class Leases {
  public:
    /// over  a world's lease is over: called each lease_time until end() says that the world was given back, or begin()
    ///       that it has another one.
    Leases(boost::asio::io_context& context, std::function<void(const std::string& world, std::uint64_t lease)> over)
        : context_{context}, over_{std::move(over)} {}

    /// From now on, whosever it was before.
    /// lease  its number among those of the world (simulation::RunControl).
    void begin(const std::string& world, std::uint64_t lease, const std::string& client_key);
    /// false: that client_key has no lease of the world.
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
    const std::function<void(const std::string& world, std::uint64_t lease)> over_;
    std::map<std::string, Lease> leases_; // by world
};

} // namespace evod::network
