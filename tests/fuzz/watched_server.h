// Watched server: a server without threads, port and disk, with a manual clock, that checks every command.
//
// Invariants: no command runs twice; a refused command changes nothing; every world equals a twin that is built from
// the same parameters, seed and changes, and that is never viewed, paced or paused.
//
// Threads      none: poll() is the network thread's turn, pass() the simulation thread's.
#pragma once

#include "server/base/inline_executor.h"
#include "server/network/dispatcher.h"
#include "server/runtime/simulations.h"
#include "tests/support/manual_clock.h"

#include <boost/asio/io_context.hpp>

#include <set>
#include <string>
#include <tuple>
#include <utility>

namespace evod::fuzz {

/// The clock of the whole program, including Asio's timers.
support::ManualClock& clock();

class WatchedServer {
  public:
    WatchedServer();

    /// Takes over one end of a connection.
    ///
    /// refusal  sent instead of a Welcome.
    void accept(int descriptor, const std::optional<base::Refusal>& refusal = {});

    void poll();
    void pass();

    bool going_away() const { return going_away_; }
    /// Connections whose sessions have not ended.
    std::size_t connection_count() const { return connection_count_; }

    /// Asserts that every world equals its twin.
    void compare_with_twins();

  private:
    /// Records the state of the worlds before each command that waits.
    void watch_mail();
    /// Checks the effect of a command and passes the reply on.
    void check_reply(runtime::Reply reply);
    void follow(const simulation::Command& command, const simulation::Applied& applied);
    /// Advances the twin to the world's tick.
    simulation::Entry& catch_up(const simulation::Entry& entry);
    std::string state_of_all() const;
    void deliver();
    void go_away();

    network::LimitCounters limit_counters_;
    network::SendMemory send_memory_; // outlives the sessions
    boost::asio::io_context context_{1};
    base::InlineExecutor executor_;
    runtime::Simulations simulations_{false};
    runtime::Mailbox& mailbox_ = simulations_.mailbox_of("");
    runtime::Outbox outbox_;
    network::Sessions sessions_;
    std::uint64_t session_number_ = 0;
    runtime::Clock::time_point polled_ = clock().now();
    std::size_t connection_count_ = 0;
    network::SessionHost host_{limit_counters_, send_memory_};
    network::Streams streams_;
    classes::Registry classes_;
    network::Dispatcher dispatcher_;
    runtime::SimulationLoop loop_;
    runtime::ReplayLoop replays_; // without runs it has no replays
    bool going_away_ = false;

    simulation::Laboratory twins_;
    // The user, the client_key and the request_id of commands.
    std::set<std::tuple<std::string, std::string, std::uint64_t>> carried_out_;
    std::string state_before_; // of all worlds, before the next command
};

/// Authenticates the tokens "viewer", "controller" and "admin".
base::Result<access::AuthenticatedUser> admit(const std::string& token);

} // namespace evod::fuzz
