// Watched server: everything of a server but its threads, its port and its disk, on a clock that only the owner moves,
// and with an eye on every command.
//
// What must hold of commands is checked here: none runs twice; a refused one changes nothing; and every world is what
// the parameters, its seed and the changes at their ticks make of it, as a twin of it shows that nobody watches, paces
// or pauses.
//
// Threads      none: poll() is the network thread's turn, pass() the simulation thread's.
#pragma once

#include "server/base/inline_executor.h"
#include "server/network/dispatcher.h"
#include "server/runtime/simulation_loop.h"
#include "tests/support/manual_clock.h"

#include <boost/asio/io_context.hpp>

#include <set>
#include <string>
#include <utility>

namespace evod::fuzz {

/// The time of the whole program, that of Asio's timers too.
support::ManualClock& clock();

class WatchedServer {
  public:
    WatchedServer();

    /// One end of a connection, whose other end it owns from now on.
    /// refusal  told instead of a welcome.
    void accept(int descriptor, const std::optional<base::Refusal>& refusal = {});

    void poll();
    void pass();

    bool going_away() const { return going_away_; }
    /// Connections whose sessions have not ended.
    std::size_t connection_count() const { return connection_count_; }

    /// Every world as its twin says.
    void compare_with_twins();

  private:
    /// Puts itself between the commands that wait and their answers.
    void watch_mail();
    void follow(const simulation::Command& command, const simulation::Applied& applied);
    /// Its twin, at its tick.
    simulation::Entry& catch_up(const simulation::Entry& entry);
    std::string state_of_all() const;
    void deliver();
    void go_away();

    network::LimitCounters limit_counters_;
    network::Buffers buffers_; // outlives the sessions
    boost::asio::io_context context_{1};
    base::InlineExecutor executor_;
    runtime::Mailbox mailbox_;
    runtime::StreamDemand demand_;
    runtime::Outbox outbox_;
    network::Sessions sessions_;
    std::uint64_t session_number_ = 0;
    runtime::Clock::time_point polled_ = clock().now();
    std::size_t connection_count_ = 0;
    network::SessionHost host_{limit_counters_, buffers_};
    network::Streams streams_;
    network::Dispatcher dispatcher_;
    runtime::SimulationLoop loop_;
    bool going_away_ = false;

    simulation::Laboratory twins_;
    std::set<std::pair<std::string, std::uint64_t>> carried_out_; // client_key and request_id of commands
};

/// Who comes with a token: "viewer", "controller" and "admin" are such.
base::Result<access::Visitor> admit(const std::string& token);

} // namespace evod::fuzz
