// Server: the network thread, with the simulation thread at its side. Runs until it is told to end.
//
// Threads      run() is the network thread; the sessions, streams and retries belong to it.
#pragma once

#include "server/network/dispatcher.h"
#include "server/network/listener.h"
#include "server/runtime/simulation_thread.h"

#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace evod::network {

struct ServerOptions {
    std::string bind_address = "127.0.0.1";
    std::uint16_t port = wire::default_port;         // 0: any that is free
    std::size_t threads = 1;                         // of the worker pool
    std::vector<simulation::Command> first_commands; // applied before any other
};

class Server {
  public:
    /// Takes the port. Refuses with a sentence for the person who started it.
    static base::Result<std::unique_ptr<Server>> open(ServerOptions options);
    ~Server();

    boost::asio::ip::tcp::endpoint endpoint() const { return listener_->endpoint(); }

    /// Serves until SIGINT, SIGTERM or stop(): then says goodbye to every session, and returns.
    void run();

    /// From any thread.
    void stop();

  private:
    explicit Server(ServerOptions options);
    void accepted(boost::asio::ip::tcp::socket socket);
    void deliver();
    void go_away();

    ServerOptions options_;
    boost::asio::io_context context_{1};
    boost::asio::signal_set signals_{context_};
    std::optional<Listener> listener_;

    std::unique_ptr<base::Executor> executor_;
    runtime::SteadyClock clock_;
    runtime::Mailbox mailbox_;
    runtime::Demand demand_;
    runtime::Outbox outbox_;

    Sessions sessions_;
    std::uint64_t session_number_ = 0;
    std::size_t connections_ = 0; // sessions, and those that are being told there are too many
    SessionHost host_;
    Streams streams_;
    Dispatcher dispatcher_;
    std::unique_ptr<runtime::SimulationThread> simulation_; // ends before what it uses
    bool going_away_ = false;
};

} // namespace evod::network
