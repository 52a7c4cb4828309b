// Server: runs the network thread and starts the simulation thread. It serves clients until stop() or a signal.
//
// Threads      run() is the network thread. Sessions, streams and the reply cache are used only on that thread.
#pragma once

#include "server/access/tls.h"
#include "server/network/dispatcher.h"
#include "server/network/housekeeping.h"
#include "server/network/http.h"
#include "server/network/listener.h"
#include "server/network/session_table.h"
#include "server/replay/archive.h"
#include "server/runtime/processes.h"
#include "server/runtime/simulation_thread.h"

#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>

#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace evod::network {

struct ServerOptions {
    std::string bind_address = "127.0.0.1";
    std::uint16_t port = codec::default_port; // 0: any free port
    std::size_t threads = 1;                  // number of threads in the worker pool
    std::string data_folder;                  // folder of the run files; empty: runs are not stored
    std::string token_folder;                 // folder of the token file; empty: there are no tokens
    SessionBounds session_bounds;
    bool token_needed = false; // require a token on the loopback interface, too; other interfaces always require one
    access::TlsFiles tls;
    run_file::RunFile::Options run_files;
    struct Replay {
        std::string path;
        std::optional<std::uint64_t> generation; // generation to show first; nullopt: the first
    };
    struct HttpOptions {
        std::string bind_address = "127.0.0.1";
        std::uint16_t port = 0; // 0: any free port
        // Names by which browsers may address the server, besides its own: of a proxy, of a DNS entry. If there is one,
        // every client needs a token: behind a proxy on the same machine all clients have a loopback address.
        std::vector<std::string> host_names = {};
    };
    std::optional<HttpOptions> http; // nullopt: neither the browser viewer nor the metrics are served over HTTP
    std::optional<Replay> replay;    // a run file to serve as a replay, without live worlds and data folder

    // The processes that share the worlds, and their leader; nullptr: there are none.
    const runtime::Processes* processes = nullptr;
    simulation::Leader* leader = nullptr;

    simulation::CreateWorld first_world; // created if no world has this name
    bool first_world_asked = false;      // false: first_world is created only if there is no world at all
    bool first_seed_asked = false;       // true: if the world is already stored, it must have the seed of first_world
    // The speed that the server sets before any other command. It applies to first_world if the user requested that
    // world; otherwise to the only world, or to `default` if there are several worlds. If there are several worlds and
    // none is named `default`, the server does not start.
    std::optional<simulation::Speed> first_speed;
    bool first_run = false; // run the same world without a goal
};

class Server {
  public:
    /// Restores the worlds of the data folder and opens the port. The message of a refusal is written for the user who
    /// starts the server.
    static base::Result<std::unique_ptr<Server>> open(ServerOptions options);
    ~Server();

    /// The seed of the first world; nullopt if that world does not exist.
    std::optional<base::Seed> first_seed() const;

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
    base::Result<void> open_archive();
    base::Result<void> open_http();
    /// Whether a client without a token is refused, on all interfaces.
    bool needs_token() const;
    /// Whether run() must create first_world.
    bool creates_first_world() const;
    /// Returns the name of the world to which first_speed and first_run apply.
    base::Result<std::string> world_to_begin() const;
    void begin_first_world();
    void deliver();
    /// Sends the next islands of the newest snapshots, then lets the thread do other work.
    void send_snapshots();
    void wait_for_signal();
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
    std::optional<access::Gate> gate_;

    std::unique_ptr<base::Executor> executor_;
    std::unique_ptr<replay::Archive> archive_;  // nullptr: runs are not stored
    std::optional<runtime::FileReplay> replay_; // empty after it was moved to the simulation thread
    runtime::SteadyClock clock_;
    runtime::Mailbox mailbox_;
    runtime::StreamDemand demand_;
    runtime::Outbox outbox_;
    metrics::Worlds worlds_counted_;

    SessionHost host_{limit_counters_, send_memory_};
    SessionTable table_;
    Housekeeping housekeeping_{context_, table_, host_};
    Streams streams_;
    bool sends_snapshots_ = false; // a call of send_snapshots() is posted
    Dispatcher dispatcher_;
    std::unique_ptr<runtime::SimulationThread> simulation_; // is destroyed before the members that it uses
    bool going_away_ = false, all_written_ = true;
    std::thread stopping_; // stops the simulation and closes the archive
};

} // namespace evod::network
