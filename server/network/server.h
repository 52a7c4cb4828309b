// Server: runs the network thread and starts the simulation thread. Serves until stop() or a signal.
//
// Threads      run() is the network thread. Sessions, streams and the reply cache belong to it.
#pragma once

#include "server/access/tls.h"
#include "server/network/dispatcher.h"
#include "server/network/heartbeat.h"
#include "server/network/http.h"
#include "server/network/listener.h"
#include "server/replay/archive.h"
#include "server/runtime/simulation_thread.h"

#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>

#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace evod::network {

struct ServerOptions {
    std::string bind_address = "127.0.0.1";
    std::uint16_t port = codec::default_port; // 0: any free port
    std::size_t threads = 1;                  // of the worker pool
    std::string data_folder;                  // the folder of run files; empty: runs are not stored
    std::string token_folder;                 // the folder of the token file; empty: no tokens
    SessionBounds session_bounds;
    bool token_needed = false; // also on the loopback interface; elsewhere a token is always required
    access::TlsFiles tls;
    run_file::RunFile::Options run_files;
    struct Replay {
        std::string path;
        std::optional<std::uint64_t> generation; // nullopt: the first
    };
    struct HttpOptions {
        std::string bind_address = "127.0.0.1";
        std::uint16_t port = 0; // 0: any free port
    };
    std::optional<HttpOptions> http; // nullopt: no metrics over HTTP
    std::optional<Replay> replay;    // serve this run file as a replay, without live worlds and data folder

    simulation::CreateWorld first_world; // created if no world has its name
    bool first_world_asked = false;      // false: created only if there is no world at all
    bool first_seed_asked = false;       // a stored world must have the seed of first_world
    // Applied to first_world before any other command. If first_world was not asked for: applied to the only world, or
    // to `default` if there are several. Refused if there are several and none is named `default`.
    std::optional<simulation::Speed> first_speed;
    bool first_run = false; // run without an end
};

class Server {
  public:
    /// Restores the worlds of the data folder and opens the port. A refusal is a sentence for the person who starts the
    /// server.
    static base::Result<std::unique_ptr<Server>> open(ServerOptions options);
    ~Server();

    /// The seed of the first world; nullopt: no world has that name.
    std::optional<base::Seed> first_seed() const;

    boost::asio::ip::tcp::endpoint endpoint() const { return listener_->endpoint(); }

    /// The address of the metrics pages; nullopt: without HTTP.
    std::optional<boost::asio::ip::tcp::endpoint> http_endpoint() const {
        return http_ ? std::optional{http_->endpoint()} : std::nullopt;
    }

    /// Serves until SIGINT, SIGTERM or stop(). Then informs every session, answers pending requests and returns. A
    /// second signal ends the process at once.
    ///
    /// returns  false: some data could not be written to the disk; the log has the details.
    bool run();

    /// Callable from any thread.
    void stop();

  private:
    explicit Server(ServerOptions options);
    base::Result<void> open_archive();
    base::Result<void> open_http();
    /// Sends the commands that the options ask for.
    bool creates_first_world() const;
    /// The world for first_speed and first_run.
    base::Result<std::string> world_to_begin() const;
    void begin_first_world();
    /// Starts the periodic checks: revoked tokens, stalled clients, free memory.
    void start_housekeeping();
    void schedule_housekeeping();
    void trim_heap(runtime::Clock::time_point now);
    void check_tokens();
    /// Closes the sessions with the most memory until the bound of SendMemory holds.
    void evict_sessions();
    void accepted(boost::asio::ip::tcp::socket socket);
    void deliver();
    /// Sends the next islands of the newest snapshots, then yields to other work of the thread.
    void send_snapshots();
    void wait_for_signal();
    /// On failure the server keeps the old certificate.
    void reread_certificate();
    void go_away();
    /// All metrics.
    v1::Metrics metrics();
    /// Status 200 if the simulation responds and runs can be written, else 503 with the reason.
    asio::awaitable<Http::Page> health();

    ServerOptions options_;
    LimitCounters limit_counters_;
    SendMemory send_memory_; // outlives the sessions, which may live as long as the context
    boost::asio::io_context context_{1};
    boost::asio::signal_set signals_{context_};
    std::optional<Listener> listener_;
    std::unique_ptr<Http> http_; // nullptr: without HTTP

    std::unique_ptr<asio::ssl::context> tls_; // nullptr: without TLS
    std::optional<access::Gate> gate_;
    asio::steady_timer housekeeping_timer_{context_};

    std::unique_ptr<base::Executor> executor_;
    std::unique_ptr<replay::Archive> archive_;           // nullptr: runs are not stored
    std::optional<runtime::Replays::FileReplay> replay_; // until it moves to the simulation thread
    runtime::SteadyClock clock_;
    runtime::Mailbox mailbox_;
    runtime::StreamDemand demand_;
    runtime::Outbox outbox_;
    metrics::Worlds worlds_counted_;
    Heartbeat heartbeat_{mailbox_, outbox_};

    Sessions sessions_;
    std::uint64_t session_number_ = 0;
    runtime::Clock::time_point looked_, trim_at_;
    std::size_t ended_since_trim_ = 0;   // sessions
    std::uint64_t answered_at_trim_ = 0; // bytes
    std::size_t connections_ = 0;        // sessions, and refused connections that receive a Goodbye
    SessionHost host_{limit_counters_, send_memory_};
    Streams streams_;
    bool sends_snapshots_ = false; // a call of send_snapshots() is posted
    Dispatcher dispatcher_;
    std::unique_ptr<runtime::SimulationThread> simulation_; // ends before everything that it uses
    bool going_away_ = false, all_written_ = true;
    std::thread stopping_; // stops the simulation and closes the archive
};

} // namespace evod::network
