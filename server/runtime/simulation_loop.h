// Simulation loop: pass() is one pass of a simulation thread. The loop owns a laboratory. Its parts decide when each
// world advances (pace.h), answer queries (queries.h) and carry out commands (command_handler.h). The laboratory
// decides what happens in a tick.
//
//   state of the disk → commands → queries → worlds that are due → queries → events and snapshots into the outbox →
//   sleep until the next world is due
//
// Queries      are answered in idle time, and in a small share of the other time.
// Threads      only its simulation thread calls it. A server has two loops: this one owns the live worlds,
//              replay_loop.h the replays. They share nothing.
// Determinism  the clock decides how many ticks are simulated. It does not influence what happens in them.
#pragma once

#include "server/runtime/command_handler.h"
#include "server/runtime/pace.h"
#include "server/runtime/queries.h"
#include "server/runtime/run_finder.h"
#include "server/runtime/storage_watch.h"
#include "server/runtime/world_builds.h"

#include <optional>
#include <string>
#include <vector>

namespace evod::runtime {

class SimulationLoop : protected Pace::Rules {
  public:
    /// recorder  stores the runs. A command is answered after it was stored. nullptr: runs are not stored. It must
    ///           outlive the loop.
    SimulationLoop(const LoopTools& tools, LoopOutputs outputs, simulation::Laboratory laboratory = {},
                   recording::Recorder* recorder = nullptr);
    SimulationLoop(const SimulationLoop&) = delete;
    SimulationLoop& operator=(const SimulationLoop&) = delete;
    ~SimulationLoop() override = default;

    /// Handles the mail and advances each world that is due by about one slice. Returns the time at which the next pass
    /// is due if no mail arrives; nullopt: no pass is due before mail arrives.
    std::optional<Clock::time_point> pass();
    /// Applies the commands in the mailbox, and queues the queries.
    void poll_mailbox();
    /// Handles the remaining mail and closes the recorder. Called when the server shuts down.
    void close();

    const simulation::Laboratory& laboratory() const { return laboratory_; }

  protected:
    virtual void handle(Mail& mail);
    /// Carries out what may create, move or delete worlds besides commands.
    virtual void update_worlds() {}
    /// Adds the seeks that want to advance.
    virtual void list_seeks(std::vector<Pace::Contender>&) {}
    /// Returns the time at which it must be called again; nullopt: no call is needed.
    virtual std::optional<Clock::time_point> refresh(Clock::time_point) { return std::nullopt; }

    const LoopTools tools_;
    const LoopOutputs outputs_;
    simulation::Laboratory laboratory_;

  private:
    bool is_held(const simulation::Entry& world) const override { return builds_.holds(world.name); }
    bool waits_for_disk(const simulation::Entry& world) const override { return storage_.holds(world); }
    std::string user_of(const simulation::Entry& world) const override { return world.ownership.user; }
    /// Answers queries within the budget. Returns the time at which more of them may be answered; nullopt: no query
    /// waits.
    std::optional<Clock::time_point> answer_queries();
    /// Refuses a request for a replay that names a live world.
    void refuse(const ReplayMail& mail);
    void follow_worlds();

    recording::Recorder* const recorder_;

  protected:
    RunFinder runs_;
    Pace pace_;

  private:
    WorldBuilds builds_;
    StorageWatch storage_;
    CommandHandler commands_;
    Queries queries_;
    std::vector<Mail> mail_;                   // reused buffer
    std::vector<Pace::Contender> contenders_;  // reused buffer
    std::vector<std::string> damaged_counted_; // the names that the metrics have
};

} // namespace evod::runtime
