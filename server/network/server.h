// Server: runs the network thread and starts the simulation thread. It serves clients until stop() or a signal.
//
// Threads      run() is the network thread. Sessions, streams and the reply cache are used only on that thread.
#pragma once

#include "server/network/dispatcher.h"
#include "server/network/first_world.h"
#include "server/network/housekeeping.h"
#include "server/network/http.h"
#include "server/network/listener.h"
#include "server/network/server_options.h"
#include "server/network/session_table.h"
#include "server/replay/archive.h"
#include "server/runtime/processes.h"
#include "server/runtime/simulations.h"

#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>

#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace evod::network {

class Server {
  public:
    /// Checks the addresses and reads the certificates, without opening a port. A refusal names the option.
    static base::Result<void> check(const ListenerOptions& listeners);
    /// Restores the worlds of the data folder and opens the port. The message of a refusal is written for the user who
    /// starts the server.
    static base::Result<std::unique_ptr<Server>> open(ServerOptions options);
    ~Server();

    const ServerOptions& options() const { return options_; }

    /// The seed of the first world; nullopt if that world does not exist.
    std::optional<base::Seed> first_seed() const { return first_world_ ? first_world_->seed() : std::nullopt; }

    boost::asio::ip::tcp::endpoint endpoint() const { return listener_->endpoint(); }

    /// Where browsers find the page. The port is 0 if it is not served.
    const PageAddress& page() const { return host_.page; }

    /// The address of the HTTP port; nullopt if there is none.
    std::optional<boost::asio::ip::tcp::endpoint> http_endpoint() const {
        return http_ ? std::optional{http_->endpoint()} : std::nullopt;
    }

    /// Serves clients until SIGINT, SIGTERM or stop(). Then it informs all sessions, answers the pending requests and
    /// returns. A second signal ends the process at once.
    ///
    /// returns  false: some data could not be written to the disk; the log contains the details.
    bool run();

    /// May be called on any thread.
    void stop();

  private:
    explicit Server(ServerOptions options);
    base::Result<void> open_worlds(const LiveWorlds& worlds);
    base::Result<void> open_replay(const ReplayedRun& run);
    base::Result<void> open_http();
    void deliver();
    /// Sends the next islands of the newest snapshots, then lets the thread do other work.
    void send_snapshots();
    void wait_for_signal();
    /// Reads the configuration again, and then the certificate. An invalid configuration changes nothing.
    void reread();
    /// Reads the files of the certificate again. If that fails, the server keeps the old certificate.
    void reread_certificate();
    void begin_shutdown();
    v1::Metrics metrics();
    /// Returns status 200 if the simulation responds and runs can be written, otherwise 503 with the reason.
    asio::awaitable<HttpAnswer> health();

    ServerOptions options_;
    LimitCounters limit_counters_;
    SendMemory send_memory_; // must outlive the sessions, which may exist as long as the context
    boost::asio::io_context context_{1};
    boost::asio::signal_set signals_{context_};
    std::optional<Listener> listener_;
    std::unique_ptr<Http> http_; // nullptr: no HTTP

    std::unique_ptr<asio::ssl::context> tls_; // nullptr: no TLS
    std::optional<access::Authenticator> authenticator_;

    classes::Registry classes_;
    std::unique_ptr<base::Executor> executor_;
    std::unique_ptr<replay::Archive> archive_;  // nullptr: runs are not stored
    std::optional<FirstWorld> first_world_;     // empty: the server shows a replay
    std::optional<runtime::FileReplay> replay_; // empty after it was moved to the simulation thread
    runtime::SteadyClock clock_;
    runtime::Simulations simulations_;
    runtime::Outbox outbox_;
    metrics::Worlds worlds_counted_;

    SessionHost host_{limit_counters_, send_memory_};
    SessionTable table_;
    Housekeeping housekeeping_{context_, table_, host_};
    Streams streams_;
    bool sends_snapshots_ = false; // a call of send_snapshots() is posted
    Dispatcher dispatcher_;
    bool going_away_ = false, all_written_ = true;
    std::thread stopping_; // stops the simulation and closes the archive
};

} // namespace evod::network
