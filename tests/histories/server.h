// Server: a server of evod without its network, on one thread. It has the archive, the storage thread, the recorder and
// the simulation loop of a server, and a clock that stands still while nothing happens.
//
// Owner        a history, for one life: from its opening to a stop or a kill.
// Threads      its own storage thread, and a thread that reads run files.
#pragma once

#include "evod/v1/commands.pb.h"
#include "server/replay/archive.h"
#include "tests/support/manual_clock.h"
#include "tests/support/two_loops.h"

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace evod::histories {

/// A request and the command that it contains, with its random numbers.
struct SentCommand {
    v1::Request request;
    simulation::Command command;
};

class Server {
  public:
    static inline const base::Actor client = base::client_actor("alice", "test", "127.0.0.1:5000"); // the sender

    /// tick_takes  how long a tick seems to take: long ticks cause checkpoints.
    /// leader      shares the worlds with other processes; nullptr: they are not shared.
    ///
    /// Refused if the data folder cannot be recovered.
    static base::Result<std::unique_ptr<Server>> open(const std::string& folder,
                                                      const run_file::RunFile::Options& options,
                                                      std::chrono::microseconds tick_takes, base::Executor& executor,
                                                      simulation::IslandsMaker* maker);

    const simulation::Laboratory& laboratory() const { return loops_->live.laboratory(); }
    const simulation::Entry* find(const std::string& name) const;

    /// Sends commands, which are then applied between the same two ticks.
    void send(const std::vector<SentCommand>& commands);
    /// Lets the loop make a number of passes.
    void pass(std::uint32_t count);
    /// Waits until all commands are answered and no world wants a tick. Returns why that does not happen; nullopt if it
    /// did.
    std::optional<std::string> rest();
    /// The result of a command; nullptr if it is not answered.
    const base::Result<simulation::Applied>* answer_to(std::uint64_t request_id);

    /// The state hash that a replay of the world shows after this tick.
    base::Result<base::StateHash> replayed(const std::string& world, std::uint64_t tick);

    /// Waits until everything is on the disk, as far as the server has passed it to the storage thread.
    void write_all();
    /// Stops as a server does. Returns false if data was lost.
    bool close();

  private:
    Server(std::unique_ptr<replay::Archive> archive, std::chrono::microseconds tick_takes, base::Executor& executor,
           simulation::IslandsMaker* maker);
    void on_answer(runtime::Answer answer);
    bool is_answered() const;
    /// Lets the loops pass once. Moves the clock to the next pass, or waits a moment for other threads.
    void pass_once();

    support::ManualClock clock_;
    std::map<std::uint64_t, std::optional<base::Result<simulation::Applied>>> answers_; // by request id
    std::optional<base::Result<std::string>> replay_;
    std::unique_ptr<replay::Archive> archive_; // its thread gives receipts to the loops
    std::optional<support::TwoLoops> loops_;
};

} // namespace evod::histories
