// Simulation loop: one pass of the simulation thread. Owns the laboratory and decides when each world advances; the
// laboratory decides what happens then.
//
//   commands → queries → state of the disk → paced worlds that are due → worlds at full speed and replays, a slice each
//   →
//   seeks of replays, a slice → queries → events and snapshots into the outbox → sleep until the next world is due
//
// Pace         a world at speed factor f takes a tick every tick_s / f. A late world catches up at most `catch_up_max`;
//              beyond that it runs slower. A slice ends when mail arrives or another world is due, so answers and paced
//              worlds wait for at most one tick of another world. Unpaced worlds get equal slices of the remaining
//              time, at least one tick each.
// Queries      are answered in idle time, and in a small share of the other time (query_budget.h).
// Disk         while the write queue is full, live worlds wait. Mail, replays and snapshots for new viewers continue.
// Threads      one thread calls it: the simulation thread.
// Determinism  time decides how many ticks are taken, never what happens in them.
#pragma once

#include "server/base/executor.h"
#include "server/metrics/worlds.h"
#include "server/recording/recorder.h"
#include "server/runtime/clock.h"
#include "server/runtime/demand.h"
#include "server/runtime/mailbox.h"
#include "server/runtime/query_budget.h"
#include "server/runtime/replays.h"
#include "server/runtime/snapshot.h"
#include "server/simulation/laboratory.h"

#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <vector>

namespace evod::runtime {

/// Receivers of the loop's output; called on the simulation thread unless stated otherwise.
struct LoopOutputs {
    std::function<void(const simulation::Laboratory&, std::vector<simulation::Event>)> events;
    std::function<void(SnapshotPtr)> snapshot;
    /// A command was applied or refused, and is on the disk if runs are stored. Also called on the storage thread.
    std::function<void(CommandDone)> done = [](CommandDone) {};
    /// The state of the disk has changed.
    std::function<void(const simulation::Storage&)> storage = [](const simulation::Storage&) {};
    /// Metrics of each live world; outlives the loop. nullptr: no metrics.
    metrics::Worlds* counted = nullptr;
};

class SimulationLoop {
  public:
    static constexpr std::chrono::milliseconds slice{5};
    static constexpr std::chrono::milliseconds catch_up_max{50};
    /// A world at full speed runs for about so long between two readings of the clock, because in a small world a tick
    /// is as short as a reading.
    static constexpr std::chrono::microseconds between_looks{20};
    /// A world counts as slowed if it loses more than this share of the time.
    static constexpr double slowed_from = 0.02;
    /// A short wait for a working disk is normal. It is reported only after this time.
    static constexpr std::chrono::seconds slow_disk_patience{1};

    /// Everything handed in outlives the loop.
    ///
    /// laboratory  contains the worlds that exist at the start.
    /// recorder    stores the runs; commands are answered once they are stored. nullptr: runs are not stored.
    /// replay      a replay to show from the start.
    SimulationLoop(Mailbox& mailbox, StreamDemand& demand, base::Executor& executor, Clock& clock, LoopOutputs outputs,
                   simulation::Laboratory laboratory = {}, recording::Recorder* recorder = nullptr,
                   std::optional<Replays::FileReplay> replay = {});

    /// Handles the mail and advances the worlds that are due, about a slice per world. Returns when the next pass is
    /// due if no mail arrives; nullopt: not before mail arrives.
    std::optional<Clock::time_point> pass();

    /// Applies the commands in the mailbox; queries wait for answer_queries().
    void poll_mailbox();
    /// At the end: handles the remaining mail and closes the recorder.
    void close();

    const simulation::Laboratory& laboratory() const { return laboratory_; }

  private:
    /// The loop's state of a world, by name; reset when the run id changes.
    struct Track {
        recording::RunRecorder* recorder = nullptr;
        std::shared_ptr<metrics::World> counted; // nullptr: no metrics
        simulation::RunId run_id;
        simulation::Speed speed;
        double tick_s = 0;
        bool running = false;
        Clock::time_point due; // time of the next tick, if paced
        // Measured since `measured_since`.
        Clock::time_point measured_since;
        std::uint64_t ticks = 0;
        Clock::duration lost{};         // by which the world ran slower
        std::uint32_t ticks_a_look = 1; // ticks between two readings of the clock, at full speed
        // For viewers.
        const WorldDemand* watch = nullptr;
        std::uint64_t newcomers_served = 0;
        bool changed = true; // a command or a goal changed the world since the last snapshot
        std::uint64_t shown_tick = 0;
        Clock::time_point next_snapshot;
    };

    /// Answers queries within the budget. Returns when the next pass is due for them; nullopt: no query waits.
    std::optional<Clock::time_point> answer_queries();
    void answer_query();
    /// Whether a world is due now and would be late after other work.
    bool time_is_wanted(Clock::time_point now) const;
    void apply(CommandMail& mail);
    void fork(CommandMail& mail);
    base::Result<simulation::Applied> apply(const simulation::Command& command);
    /// The run of a command's world before the command.
    struct RunBefore {
        simulation::RunId run_id;
        std::uint64_t tick;
    };
    std::optional<RunBefore> run_of(const simulation::Command& command) const;
    const simulation::Entry* entry_in(const simulation::Command& command) const;
    /// Why the journal cannot store the command now, whatever it contains; nullopt: it can.
    std::optional<base::Refusal> refusal_of(const simulation::Command& command) const;
    void answer(CommandMail& mail, const base::Result<simulation::Applied>& applied,
                const std::optional<RunBefore>& before);
    /// The answer to a command, with what the network thread needs to know about the outcome.
    CommandDone done_of(CommandMail mail, const base::Result<simulation::Applied>& applied) const;
    /// Writes a command that was applied to the journal.
    void record(CommandDone done, const std::optional<RunBefore>& before);
    void announce_finished_seeks();
    void poll_demand();
    void poll_storage();
    /// Whether the world must wait for the disk.
    bool waits_for_the_disk(const simulation::Entry& entry) const { return worlds_wait_ && !entry.replay; }
    void follow_worlds();
    Track& follow(simulation::Entry& entry);
    void advance_slice(simulation::Entry& entry, Track& track, Clock::time_point end);
    /// spent: time since the last reading of the clock, for ticks and the work after them.
    void make_due_checkpoint(const simulation::Entry& entry, Track& track, Clock::duration spent);
    void measure(simulation::Entry& entry, Track& track, Clock::time_point now);
    void show(const simulation::Entry& entry, Track& track, Clock::time_point now);
    void publish_events();
    Clock::duration period(const simulation::Entry& entry) const;

    Mailbox& mailbox_;
    StreamDemand& demand_;
    base::Executor& executor_;
    Clock& clock_;
    const LoopOutputs outputs_;
    simulation::Laboratory laboratory_;
    recording::Recorder* recorder_;
    bool worlds_wait_ = false;                       // live worlds wait for the disk
    std::optional<Clock::time_point> waiting_since_; // since when worlds wait for a working disk
    Replays replays_;
    std::map<std::string, Track, std::less<>> tracks_;
    WorldDemands watches_;
    SnapshotPool pool_;
    std::vector<Mail> mail_;
    std::deque<QueryMail> queries_; // at most one per session
    QueryBudget query_budget_;
    std::vector<std::uint32_t> island_indices_; // working memory
};

} // namespace evod::runtime
