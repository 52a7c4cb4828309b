// Replay loop: the simulation loop of the replays, which are worlds that show stored runs, and of the seeks that move
// them. It has a laboratory of its own, and shares nothing with the loop of the live worlds.
//
// A server that shows a run file has only this loop. Worlds that clients then create live in it, next to the replays,
// so it handles commands, too.
//
// Threads      only the thread of the replays calls it.
// Determinism  a replay reproduces a run bit for bit.
#pragma once

#include "server/runtime/seeks.h"
#include "server/runtime/shown_replays.h"
#include "server/runtime/simulation_loop.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>

namespace evod::runtime {

class ReplayLoop final : public SimulationLoop {
  public:
    /// All references must outlive the loop.
    ///
    /// turns       of the jobs that read run files.
    /// file        the replay of a run file that the server shows from its start.
    /// laboratory  the worlds that it has besides replays.
    ReplayLoop(const LoopTools& tools, LoopOutputs outputs, JobTurns& turns, std::optional<FileReplay> file = {},
               simulation::Laboratory laboratory = {});

  private:
    void handle(Mail& mail) override;
    void update_worlds() override;
    void list_seeks(std::vector<Pace::Contender>& contenders) override;
    void advance_seek(std::uint64_t seek, const std::function<bool()>& stop) override { seeks_.advance(seek, stop); }
    void after_tick(simulation::Entry& entry) override;
    std::optional<Clock::time_point> refresh(Clock::time_point now) override { return shown_.refresh(now); }
    std::string user_of(const simulation::Entry& entry) const override { return user_of(entry.name); }
    std::string user_of(const std::string& world) const;

    void find_run(const FindRun& mail);
    // The following functions return false if the request names a world that is not a replay.
    bool answer(const ReplayMail& mail);
    bool seek(const ReplayMail& mail, const Seek& request);
    bool close(const ReplayMail& mail, const CloseReplay& request);
    void open(const ReplayMail& mail, const OpenReplay& request);
    void end(const EndReplay& mail);
    /// Begins the fork of a replay. Returns false if the command is something else.
    bool fork(CommandMail& mail);
    /// Begins a seek to the generation that a fork begins with.
    void begin_seek(const CommandMail& fork, const replay::StoredRun& run, replay::RecordedUntil until);
    /// Sends the world to the thread of the live worlds.
    void finish(Seeks::Ended ended);
    void finish(const ReplayMail& mail, const std::string& moved, const replay::StoredRun& run,
                base::Result<SeekResult> result);
    void send_fork_world(const CommandMail& fork, const simulation::RunId& run_id,
                         base::Result<simulation::World> world);
    /// Reports the memory of a session's replays and seeks, if it has changed. 0: no session.
    void report_memory(std::uint64_t session);
    /// Closes all replays of a session that has ended, and cancels its seeks.
    void forget(std::uint64_t session);

    const bool hosts_worlds_; // this is the only loop of the server
    std::uint64_t last_name_ = 0;
    FileJobs jobs_;
    Seeks seeks_;
    ShownReplays shown_;
    std::map<std::uint64_t, std::size_t> reported_bytes_; // key: number of the session
};

} // namespace evod::runtime
