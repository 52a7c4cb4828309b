// Server: the network thread, with the simulation thread at its side. Runs until it is told to end.
//
// Threads      run() is the network thread; the sessions, streams and retries belong to it.
#pragma once

#include "server/access/tls.h"
#include "server/network/dispatcher.h"
#include "server/network/http.h"
#include "server/network/listener.h"
#include "server/network/pulse.h"
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
    std::uint16_t port = codec::default_port; // 0: any that is free
    std::size_t threads = 1;                  // of the worker pool
    std::string data_folder;                  // where runs are kept; empty: nowhere
    std::string token_folder;                 // where the token file is, or will be; empty: nowhere
    SessionBounds session_bounds;
    bool token_needed = false; // on the loopback interface too; on others it always is
    access::TlsFiles tls;
    run_file::RunFile::Options run_files;
    struct Replay {
        std::string path;
        std::optional<std::uint64_t> generation; // nullopt: the first
    };
    struct HttpOptions {
        std::string bind_address = "127.0.0.1";
        std::uint16_t port = 0; // 0: any that is free
    };
    std::optional<HttpOptions> http; // nullopt: no metrics over HTTP
    std::optional<Replay> replay;    // instead of worlds that live, and of the data folder, the run of a file

    simulation::CreateWorld first_world; // made if there is none of its name
    bool first_world_asked = false;      // otherwise it is made only if there is no world at all
    bool first_seed_asked = false;       // a world that goes on must have begun with the seed of first_world
    // Then applied to first_world, before any other command; if that was not asked for, to the only world there is, or
    // `default` of several. Refused where there are several, and none of that name.
    std::optional<simulation::Speed> first_speed;
    bool first_run = false; // without end
};

class Server {
  public:
    /// Brings back the worlds of the data folder, and takes the port. Refuses with a sentence for the person who
    /// started it.
    static base::Result<std::unique_ptr<Server>> open(ServerOptions options);
    ~Server();

    /// The seed of the first world; nothing if there is none of that name, as others go on.
    std::optional<base::Seed> first_seed() const;

    boost::asio::ip::tcp::endpoint endpoint() const { return listener_->endpoint(); }

    /// Of the metrics; nullopt: nowhere.
    std::optional<boost::asio::ip::tcp::endpoint> http_endpoint() const {
        return http_ ? std::optional{http_->endpoint()} : std::nullopt;
    }

    /// Serves until SIGINT, SIGTERM or stop(): then tells every session, answers what was asked, and returns. A second signal
    /// ends the process at once.
    ///
    /// returns  false: some of what worlds did could not be written to the disk; the log says what.
    bool run();

    /// From any thread.
    void stop();

  private:
    explicit Server(ServerOptions options);
    base::Result<void> open_archive();
    base::Result<void> open_http();
    /// The commands that options ask for.
    bool creates_first_world() const;
    /// Which world first_speed and first_run are for.
    base::Result<std::string> world_to_begin() const;
    void begin_first_world();
    /// Every now and then: for tokens that are revoked, and for clients that take nothing.
    void look_around();
    void look_again();
    void give_memory_back(runtime::Clock::time_point now);
    void mind_tokens();
    /// More waits for all clients than may: closes those for whom most waits.
    void relieve();
    void accepted(boost::asio::ip::tcp::socket socket);
    void deliver();
    /// Sends the next of the pictures that have come, in turns with everything else that the thread does.
    void send_pictures();
    void wait_for_signal();
    /// After a failure the server goes on with what it has.
    void reread_certificate();
    void go_away();
    /// What it counts and measures.
    v1::Metrics metrics();
    /// 200 while the simulation answers and runs can be written down, else 503 and why.
    asio::awaitable<Http::Page> health();

    ServerOptions options_;
    LimitCounters limit_counters_;
    Buffers buffers_; // outlives the sessions, which may be alive as long as the context
    boost::asio::io_context context_{1};
    boost::asio::signal_set signals_{context_};
    std::optional<Listener> listener_;
    std::unique_ptr<Http> http_; // nullptr: not wanted

    std::unique_ptr<asio::ssl::context> tls_; // nullptr: in the clear
    std::optional<access::Gate> gate_;
    asio::steady_timer look_timer_{context_};

    std::unique_ptr<base::Executor> executor_;
    std::unique_ptr<replay::Archive> archive_;           // nullptr: nothing is kept
    std::optional<runtime::Replays::FileReplay> replay_; // until the simulation has it
    runtime::SteadyClock clock_;
    runtime::Mailbox mailbox_;
    runtime::StreamDemand demand_;
    runtime::Outbox outbox_;
    metrics::Worlds worlds_counted_;
    Pulse pulse_{mailbox_, outbox_};

    Sessions sessions_;
    std::uint64_t session_number_ = 0;
    runtime::Clock::time_point looked_, trim_at_;
    std::size_t ended_since_trim_ = 0;   // sessions
    std::uint64_t answered_at_trim_ = 0; // bytes
    std::size_t connections_ = 0;        // sessions, and those that are being told they have no place
    SessionHost host_{limit_counters_, buffers_};
    Streams streams_;
    bool sends_pictures_ = false; // a call is posted
    Dispatcher dispatcher_;
    std::unique_ptr<runtime::SimulationThread> simulation_; // ends before what it uses
    bool going_away_ = false, all_written_ = true;
    std::thread stopping_; // of the simulation and the archive
};

} // namespace evod::network
