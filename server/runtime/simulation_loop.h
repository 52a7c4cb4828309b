// Simulation loop: pass() is one pass of the simulation thread. The loop owns the laboratory and decides when each
// world advances. The laboratory decides what happens in a tick.
//
//   state of the disk → commands → queries → paced worlds that are due → worlds at full speed and replays, a slice each
//   → seeks of replays, a slice → queries → events and snapshots into the outbox → sleep until the next world is due
//
// Pace         a world with the speed factor f simulates a tick every tick_s / f. A late world catches up by at most
//              `catch_up_max`; beyond that it runs slower. A slice ends when mail arrives or another world is due.
//              Therefore answers and paced worlds wait for at most one tick of another world. Worlds without a pace
//              share the remaining time in equal slices of at least one tick.
// Queries      are answered in idle time, and in a small share of the other time (query_budget.h).
// Disk         while the write queue is full, live worlds wait. Mail, replays and snapshots for new viewers continue.
// Builds       another thread constructs large new worlds. A world that is being forked or reset waits meanwhile.
// Threads      only the simulation thread calls it.
// Determinism  the clock decides how many ticks are simulated. It does not influence what happens in them.
#pragma once

#include "server/base/executor.h"
#include "server/metrics/worlds.h"
#include "server/recording/recorder.h"
#include "server/runtime/clock.h"
#include "server/runtime/demand.h"
#include "server/runtime/file_faults.h"
#include "server/runtime/mailbox.h"
#include "server/runtime/query_budget.h"
#include "server/runtime/replays.h"
#include "server/runtime/replies.h"
#include "server/runtime/snapshot.h"
#include "server/runtime/world_builds.h"
#include "server/simulation/laboratory.h"

#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <vector>

namespace evod::runtime {

/// The functions that receive the output of the loop. They run on the simulation thread unless stated otherwise.
struct LoopOutputs {
    std::function<void(const simulation::Laboratory&, std::vector<simulation::Event>)> events;
    std::function<void(SnapshotPtr)> snapshot;
    /// Receives the replies. If runs are stored, also receives the receipts, on the storage thread.
    std::function<void(Reply)> reply = [](Reply) {};
    /// Receives a new state of the disk.
    std::function<void(const simulation::Storage&)> storage = [](const simulation::Storage&) {};
    /// Receives a new state of the disk for one world, whose run file was moved or deleted, or is back.
    std::function<void(const std::string& world, const simulation::Storage&)> storage_of_world = [](auto&&...) {};
    /// Receives a world that has stopped, because its run file is damaged.
    std::function<void(const simulation::DamagedWorld&)> damaged = [](const simulation::DamagedWorld&) {};
    /// The metrics of each live world. Must outlive the loop; nullptr: no metrics.
    metrics::Worlds* counted = nullptr;
};

class SimulationLoop {
  public:
    static constexpr std::chrono::milliseconds slice{5};
    static constexpr std::chrono::milliseconds catch_up_max{50};
    /// A world at full speed simulates ticks for about this time between two readings of the clock, because in a small
    /// world one tick takes only as long as one reading.
    static constexpr std::chrono::microseconds between_clock_readings{20};
    /// A shared world at full speed simulates ticks for about this time before its processes exchange results. Mail waits
    /// for as long.
    static constexpr std::chrono::milliseconds between_exchanges{15};
    /// A paced world counts as slowed if it falls behind its speed by more than this fraction of the elapsed time.
    static constexpr double slowed_from = 0.02;
    /// A short wait for a working disk is normal. A longer wait is reported.
    static constexpr std::chrono::seconds slow_disk_patience{1};

    /// All arguments must outlive the loop.
    ///
    /// laboratory  contains the worlds that exist at the start.
    /// recorder    stores the runs. A command is answered after it was stored. nullptr: runs are not stored.
    /// replay      a replay that is shown from the start.
    SimulationLoop(Mailbox& mailbox, StreamDemand& demand, base::Executor& executor, Clock& clock, LoopOutputs outputs,
                   simulation::Laboratory laboratory = {}, recording::Recorder* recorder = nullptr,
                   std::optional<FileReplay> replay = {});

    /// Handles the mail and advances each world that is due by about one slice. Returns the time at which the next pass
    /// is due if no mail arrives; nullopt: no pass is due before mail arrives.
    std::optional<Clock::time_point> pass();

    /// Finishes the seeks that have reached their moments, applies the commands in the mailbox, and queues the queries
    /// for answer_queries(). Then updates the list of tracks, because only these steps create or delete worlds.
    void poll_mailbox();
    /// Handles the remaining mail and closes the recorder. Called when the server shuts down.
    void close();

    const simulation::Laboratory& laboratory() const { return laboratory_; }

  private:
    /// The state of the loop for one world. It is reset when the run id of the world changes.
    struct Track {
        recording::RunRecorder* recorder = nullptr;
        std::shared_ptr<metrics::World> counted; // nullptr: no metrics
        simulation::RunId run_id;
        simulation::Speed speed;
        double tick_s = 0;
        bool running = false;
        Clock::time_point due; // time at which the next tick is due, if the world is paced
        // Measurements since the time `measured_since`.
        Clock::time_point measured_since;
        std::uint64_t ticks = 0;
        Clock::duration lost{};            // time by which the world fell behind its speed
        Clock::duration tick_time = slice; // the time that one of the last ticks took
        // State for viewers.
        const WorldDemand* watch = nullptr;
        std::uint64_t newcomers_served = 0;
        bool changed = true; // a command or a reached goal changed the world since the last snapshot
        std::uint64_t shown_tick = 0;
        Clock::time_point next_snapshot;
    };

    /// Answers queries within the budget. Returns the time at which more of them may be answered; nullopt: no query
    /// waits.
    std::optional<Clock::time_point> answer_queries();
    void answer_query();
    /// Whether a seek, a world at full speed or a due paced world would have to wait for other work.
    bool is_work_due(Clock::time_point now) const;
    void apply(CommandMail& mail);
    base::Result<simulation::Applied> apply(const simulation::Command& command);
    /// Whether the command must wait because a build holds one of its worlds.
    bool waits_for_a_build(const simulation::Command& command) const;
    void take(const WorldBuilt& built);
    /// The run of the command's world before the command was applied.
    struct RunBefore {
        simulation::RunId run_id;
        std::uint64_t tick;
    };
    std::optional<RunBefore> run_of(const simulation::Command& command) const;
    /// Constructs the world of a command of type C (CreateWorld, ResetWorld or ForkWorld), adopts it and answers.
    template <class C>
    void construct(CommandMail& mail, const std::optional<RunBefore>& before,
                   base::Result<simulation::Construction> construction);
    void fork_at_generation(CommandMail& mail, const std::optional<RunBefore>& before);
    const simulation::Entry* entry_of_command(const simulation::Command& command) const;
    /// Returns why the journal cannot store this command now; nullopt if it can, or if the command need not be stored.
    std::optional<base::Refusal> refusal_of(const simulation::Command& command) const;
    /// beginning  of the run that the command began; nullopt if it began none, or if runs are not stored.
    void answer(CommandMail& mail, const base::Result<simulation::Applied>& applied,
                const std::optional<RunBefore>& before, std::optional<run_file::RunBeginning> beginning = {});
    /// Builds the answer to a command, and the data about its effect that the network thread needs.
    CommandDone done_of(CommandMail mail, const base::Result<simulation::Applied>& applied) const;
    /// Writes an applied command to the journal.
    void record(CommandDone done, const std::optional<RunBefore>& before,
                std::optional<run_file::RunBeginning> beginning);
    void announce_moved_replays();
    void poll_demand();
    void poll_storage();
    /// Stops the worlds whose run files are damaged, and lets those wait whose run files were moved or deleted.
    void poll_run_files();
    /// Whether the world must wait for the disk or for a build.
    bool has_to_wait(const simulation::Entry& entry) const {
        return (!entry.replay && (worlds_wait_ || file_faults_.is_displaced(entry.name))) || builds_.holds(entry.name);
    }
    void follow_worlds();
    /// Passes the names of the damaged worlds to the metrics. Must be called when they have changed.
    void count_damaged_worlds();
    Track& follow(simulation::Entry& entry);
    void advance_slice(simulation::Entry& entry, Track& track, Clock::time_point end);
    /// Advances a world by one tick or, if processes share it, by as many as it should before they exchange results.
    /// Returns the number of ticks.
    std::uint64_t advance(simulation::Entry& entry, Track& track);
    /// Creates a checkpoint if one is due.
    ///
    /// spent  time that the last ticks and the work after them took.
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
    bool worlds_wait_ = false;                       // true: live worlds wait for the disk
    std::optional<Clock::time_point> waiting_since_; // time at which worlds began to wait for a working disk
    Replays replays_;
    WorldBuilds builds_;
    FileFaults file_faults_;
    recording::Ticket last_ticket_ = 0;
    std::vector<CommandMail> kept_; // commands to worlds that builds hold, in order of arrival
    std::map<std::string, Track, std::less<>> tracks_;
    WorldDemands watches_;
    SnapshotPool pool_;
    std::vector<Mail> mail_;
    std::deque<QueryMail> queries_; // at most one per session
    QueryBudget query_budget_;
    std::vector<std::uint32_t> island_indices_; // reused buffer
};

} // namespace evod::runtime
