// Simulation loop: pass() is one pass of a simulation thread. The loop owns a laboratory and decides when each of its
// worlds advances. The laboratory decides what happens in a tick.
//
//   state of the disk → commands → queries → paced worlds that are due → a slice for the user with the least time →
//   queries → events and snapshots into the outbox → sleep until the next world is due
//
// Pace         paced worlds come first (world_pace.h), unless their user has had more time than another one who waits.
//              Worlds at full speed, and seeks, get slices: the user with the least time is next (time_shares.h), and
//              of his worlds the one that has waited longest. A slice ends when mail arrives or a paced world is due.
//              Therefore answers and paced worlds wait for at most one tick of another world.
// Queries      are answered in idle time, and in a small share of the other time (queries.h).
// Disk         while the write queue is full, worlds wait. Mail and snapshots for new viewers continue.
// Builds       another thread constructs large new worlds. A world that is being forked or reset waits meanwhile.
// Threads      only its simulation thread calls it. A server has two loops: this one owns the live worlds, replay_loop.h
//              the replays. They share nothing.
// Determinism  the clock decides how many ticks are simulated. It does not influence what happens in them.
#pragma once

#include "server/base/executor.h"
#include "server/metrics/worlds.h"
#include "server/recording/recorder.h"
#include "server/runtime/clock.h"
#include "server/runtime/demand.h"
#include "server/runtime/file_faults.h"
#include "server/runtime/mailbox.h"
#include "server/runtime/queries.h"
#include "server/runtime/replies.h"
#include "server/runtime/snapshot.h"
#include "server/runtime/snapshot_times.h"
#include "server/runtime/time_shares.h"
#include "server/runtime/world_builds.h"
#include "server/runtime/world_pace.h"
#include "server/simulation/laboratory.h"

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace evod::runtime {

/// The functions that receive the output of the loop. They run on the simulation thread.
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
    /// A world at full speed simulates ticks for about this time between two readings of the clock, because in a small
    /// world one tick takes only as long as one reading.
    static constexpr std::chrono::microseconds between_clock_readings{20};
    /// A shared world at full speed simulates ticks for about this time before its processes exchange results. Mail waits
    /// for as long.
    static constexpr std::chrono::milliseconds between_exchanges{15};
    /// A short wait for a working disk is normal. A longer wait is reported.
    static constexpr std::chrono::seconds slow_disk_patience{1};

    /// All arguments must outlive the loop.
    ///
    /// laboratory  contains the worlds that exist at the start.
    /// recorder    stores the runs. A command is answered after it was stored. nullptr: runs are not stored.
    SimulationLoop(Mailbox& mailbox, StreamDemand& demand, base::Executor& executor, Clock& clock, LoopOutputs outputs,
                   simulation::Laboratory laboratory = {}, recording::Recorder* recorder = nullptr);
    virtual ~SimulationLoop() = default;
    SimulationLoop(const SimulationLoop&) = delete;
    SimulationLoop& operator=(const SimulationLoop&) = delete;

    /// Handles the mail and advances each world that is due by about one slice. Returns the time at which the next pass
    /// is due if no mail arrives; nullopt: no pass is due before mail arrives.
    std::optional<Clock::time_point> pass();

    /// Applies the commands in the mailbox, and queues the queries for answer_queries(). Then updates the list of
    /// tracks, because only these steps create or delete worlds.
    void poll_mailbox();
    /// Handles the remaining mail and closes the recorder. Called when the server shuts down.
    void close();

    const simulation::Laboratory& laboratory() const { return laboratory_; }

  protected:
    /// Work that takes as much time as it can get: a world, or a seek.
    struct Contender {
        std::string_view user;              // whose account pays
        std::uint64_t* turn = nullptr;      // the number of its last slice
        simulation::Entry* world = nullptr; // nullptr: a seek
        std::uint64_t seek = 0;             // number of the seek
    };

    virtual void handle(Mail& mail);
    /// Carries out what may create, move or delete worlds besides commands.
    virtual void update_worlds() {}
    /// Adds the work that is not a world.
    virtual void list_contenders(std::vector<Contender>&) {}
    virtual void advance_seek(std::uint64_t, const std::function<bool()>& /*stop*/) {}
    virtual bool is_seeking() const { return false; }
    virtual void after_tick(simulation::Entry&) {}
    /// Returns the time at which it must be called again; nullopt: no call is needed.
    virtual std::optional<Clock::time_point> refresh(Clock::time_point) { return std::nullopt; }
    /// The user whose account pays for the time of a world.
    virtual std::string user_of(const simulation::Entry&) const { return {}; }
    virtual void find_run(const FindRun& mail);
    virtual void answer(const ReplayMail& mail);
    virtual void fork(CommandMail& mail);

    /// Returns the stored run of a live world; refused if there is none.
    base::Result<FoundRun> run_of(const simulation::Entry& entry) const;
    /// Makes the next snapshot of a world due at once.
    void show_change(const std::string& world);

    base::Executor& executor_;
    const LoopOutputs outputs_;
    simulation::Laboratory laboratory_;

  private:
    /// The state of the loop for one world.
    struct Track {
        recording::RunRecorder* recorder = nullptr;
        std::shared_ptr<metrics::World> counted; // nullptr: no metrics
        std::string user;
        std::uint64_t turn = 0; // number of its last slice
        WorldPace pace;
        SnapshotTimes snapshots;
    };
    Track& track_of(const simulation::Entry& entry) { return tracks_.find(entry.name)->second; }
    const Track& track_of(const simulation::Entry& entry) const { return tracks_.find(entry.name)->second; }

    /// The times at which paced worlds are due.
    struct Due {
        std::optional<Clock::time_point> next;    // of all
        std::optional<Clock::time_point> in_time; // of those that keep their pace
    };
    /// Advances the paced worlds that are due. Adds the other worlds that want ticks to the contenders.
    Due advance_paced(std::vector<Contender>& contenders);
    /// Whether another user, who has had less time, waits for some.
    bool has_more_than_its_share(const std::string& user, std::span<const Contender> contenders) const;
    /// Gives a slice to one contender. Returns the time at which they must be served again.
    std::optional<Clock::time_point> serve(std::vector<Contender>& contenders, const Due& due);
    /// Answers queries within the budget. Returns the time at which more of them may be answered; nullopt: no query
    /// waits.
    std::optional<Clock::time_point> answer_queries();
    /// Whether a seek, a world at full speed or a due paced world would have to wait for other work.
    bool is_work_due(Clock::time_point now) const;
    void apply(CommandMail& mail);
    base::Result<simulation::Applied> apply(const simulation::Command& command);
    /// Whether the command must wait because a build holds one of its worlds.
    bool waits_for_a_build(const simulation::Command& command) const;
    void take(const WorldBuilt& built);
    void take(WorldBrought& brought);
    /// The run of the command's world before the command was applied.
    struct RunBefore {
        simulation::RunId run_id;
        std::uint64_t tick;
    };
    std::optional<RunBefore> run_before(const simulation::Command& command) const;
    /// Constructs the world of a command of type C (CreateWorld, ResetWorld or ForkWorld), adopts it and answers.
    template <class C>
    void construct(CommandMail& mail, const std::optional<RunBefore>& before,
                   base::Result<simulation::Construction> construction);
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
    void poll_demand();
    void poll_storage();
    /// Stops the worlds whose run files are damaged, and lets those wait whose run files were moved or deleted.
    void poll_run_files();
    bool wants_tick(const simulation::Entry& entry) const {
        return entry.wants_tick() && !worlds_wait_ && !file_faults_.is_displaced(entry.name) &&
               !builds_.holds(entry.name);
    }
    void follow_worlds();
    /// Passes the names of the damaged worlds to the metrics. Must be called when they have changed.
    void count_damaged_worlds();
    void follow(simulation::Entry& entry);
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

    Mailbox& mailbox_;
    StreamDemand& demand_;
    Clock& clock_;
    recording::Recorder* recorder_;
    bool worlds_wait_ = false;                       // true: worlds wait for the disk
    std::optional<Clock::time_point> waiting_since_; // time at which worlds began to wait for a working disk
    WorldBuilds builds_;
    FileFaults file_faults_;
    recording::Ticket last_ticket_ = 0;
    std::vector<CommandMail> kept_; // commands to worlds that builds hold, in order of arrival
    std::map<std::string, Track, std::less<>> tracks_;
    TimeShares shares_;
    std::uint64_t last_turn_ = 0;
    WorldDemands watches_;
    SnapshotPool pool_;
    std::vector<Mail> mail_;
    Queries queries_;
    std::vector<Contender> contenders_;         // reused buffer
    std::vector<std::uint32_t> island_indices_; // reused buffer
};

} // namespace evod::runtime
