// Recorder: passes the records of all runs of a laboratory to the storage thread while their worlds are simulated.
//
// Owner        the simulation thread.
// Determinism  it reads worlds and never changes them. The duration of ticks only decides when checkpoints are created.
#pragma once

#include "server/recording/storage_thread.h"
#include "server/run_file/data_folder.h"

#include <algorithm>
#include <chrono>
#include <map>
#include <memory>
#include <string>

namespace evod::recording {

/// A command that the simulation has applied.
struct CommandRecord {
    std::uint64_t tick = 0;              // the command was applied after this tick
    simulation::RunControl control = {}; // run control of the world after the command
    run_file::Origin origin = {};
    std::string answer = {};
    Ticket ticket = 0;
};

/// Finds new records in a world after a tick: the beginning and end of a generation, and the state hash.
class NewRecordFinder {
  public:
    NewRecordFinder() = default;
    /// Constructs the object for a run that continues. The file already contains the records up to this tick and these
    /// generations.
    NewRecordFinder(std::uint64_t tick, std::uint64_t generations_begun, std::uint64_t generations_ended)
        : tick_{tick}, begun_{generations_begun}, ended_{generations_ended} {}

    /// Calls write(record) for each new record. To be called before the first tick and after every tick.
    template <class Write>
    void report(const simulation::World& world, Write&& write) {
        const simulation::Moment& moment = world.moment();
        if (moment.generation != begun_) {
            write(run_file::beginning_of(world));
            begun_ = moment.generation;
        }
        if (moment.tick > tick_ && moment.tick % run_file::ticks_per_hash == 0) {
            write(run_file::HashRecord{moment.tick, world.hash()});
        }
        seen(moment.tick);
        if (world.generation_over() && ended_ != moment.generation) {
            write(run_file::end_of(world));
            ended_ = moment.generation;
        }
    }
    /// Must be called if other code has recorded everything about this tick.
    void seen(std::uint64_t tick) { tick_ = std::max(tick_, tick); }

    std::uint64_t tick() const { return tick_; } // the last recorded tick
    std::uint64_t generations_begun() const { return begun_; }

  private:
    std::uint64_t tick_ = 0, begun_ = 0, ended_ = 0;
};

/// Records one run.
class RunRecorder {
  public:
    /// A checkpoint is created if simulating the run again from the contents of its file would take longer than this.
    static constexpr std::chrono::seconds worth_a_checkpoint{2};
    /// The time between two checkpoints is at least this number times the time that both threads spent on the last one.
    static constexpr int checkpoint_cost_factor = 50;

    /// Constructs the recorder of a run that continues. `so_far` describes the records in its file.
    RunRecorder(StorageThread& thread, RunNumber number, const run_file::EndMark& so_far,
                std::uint64_t generations_ended)
        : thread_{thread}
        , number_{number}
        , new_records_{so_far.tick, so_far.generations, generations_ended}
        , journal_entries_{so_far.journal_entries} {}

    /// Passes new records to the storage thread. To be called before the first tick and after every tick.
    void follow(const simulation::World& world) {
        const simulation::Moment& moment = world.moment();
        if (moment.generation != new_records_.generations_begun() || moment.tick % run_file::ticks_per_hash == 0 ||
            world.generation_over()) {
            pass_new_records(world);
        }
    }
    void journal(CommandRecord command);
    /// Requests a receipt for all records passed so far. If they cannot be written now, it is a refusal.
    void once_written(Ticket ticket) { pass(WaitingRecord{ticket}); }
    /// Whether a checkpoint is due right after the last followed tick.
    ///
    /// spent  time that the simulation took since the previous call.
    bool checkpoint_due(const simulation::World& world, std::chrono::nanoseconds spent);
    /// Creates a checkpoint. The caller must then pass the time that the simulation waited for it to checkpoint_took().
    void make_checkpoint(const simulation::World& world, base::Executor& executor);
    void checkpoint_took(std::chrono::nanoseconds time) { copying_took_ = time; }

  private:
    friend class Recorder;
    /// Constructs the recorder of a new run, which has no number yet.
    RunRecorder(StorageThread& thread, const run_file::RunBeginning& beginning);
    void pass(WaitingRecord record);
    void pass_new_records(const simulation::World& world);
    WaitingRecord record_of(CommandRecord command);
    /// The end mark after `tick`, for a run that is over or whose server stops. If a command ended the run, its record
    /// precedes the end mark.
    Closing ending(std::uint64_t tick, bool ended, std::string renamed = {}, std::optional<CommandRecord> command = {});

    StorageThread& thread_;
    RunNumber number_ = 0;
    NewRecordFinder new_records_; // up to the records that have been passed to the storage thread
    std::uint64_t journal_entries_ = 0;

    // Time spent on simulation since the last stored beginning of a generation or checkpoint.
    std::chrono::nanoseconds since_beginning_{0};
    std::chrono::nanoseconds since_checkpoint_{0}; // time spent on simulation since the last checkpoint
    std::chrono::nanoseconds copying_took_{0};     // time that the simulation waited for the last checkpoint
    std::shared_ptr<CheckpointWriting> writing_ = std::make_shared<CheckpointWriting>();
};

/// Records all runs of a laboratory.
class Recorder {
  public:
    Recorder(run_file::DataFolder& folder, StorageThread& thread) : folder_{folder}, thread_{thread} {}

    /// The reason why no command can be accepted now; nullopt if commands can be accepted.
    std::optional<base::Refusal> refusal() const;
    /// The worlds whose run files cannot be written, although the disk can.
    std::map<std::string, RunFault> faults() const;
    /// Ends the recording of a world whose file is damaged, without writing anything.
    void give_up(const std::string& world);
    /// The reason why no world with this name can be created: its run file would have the path of a file that belongs
    /// to no world of this server. Returns nullopt if the world can be created or already exists.
    std::optional<base::Refusal> refusal_of_place(const std::string& world) const;
    /// Whether worlds may be simulated, because the storage thread has room for their records.
    bool has_room() const { return thread_.disk().has_room(); }
    /// The reason why nothing can be written now; nullopt if writing works.
    std::optional<std::string> trouble() const { return thread_.disk().trouble(); }
    /// The storage thread calls `changed` when has_room(), trouble() or faults() has changed.
    void when_changed(std::function<void()> changed) { thread_.disk().when_changed(std::move(changed)); }
    /// Returns a new ticket for a record.
    Ticket next_ticket() { return ++last_ticket_; }
    /// Must be called before the first record with a ticket.
    void set_receipt_sink(ReceiptSink sink) { thread_.set_receipt_sink(std::move(sink)); }

    /// The recorder of a world; nullptr if the world has no file.
    RunRecorder* of(const std::string& world);

    /// The path of the file with a world's run, and the path of that file after the run has ended.
    std::vector<std::string> paths_of(const std::string& world, const simulation::RunId& run_id) const {
        return {folder_.file_of(world), folder_.ended_file_of(world, run_id)};
    }

    /// Begins to record a run that has just begun. If a command began the run, it is recorded too.
    void begin(run_file::RunBeginning beginning, std::optional<CommandRecord> command = {}) {
        begin(std::move(beginning), std::move(command), std::nullopt);
    }
    /// Like begin(), for a world that was reset. Its previous run ended after `tick`, and the file of that run gets the
    /// name of an ended run.
    void begin_after_reset(run_file::RunBeginning beginning, const simulation::RunId& ended_run, std::uint64_t tick,
                           std::optional<CommandRecord> command = {});
    /// Continues to record the run in an existing file.
    RunRecorder& resume(const std::string& world, std::unique_ptr<run_file::RunFile> file,
                        const run_file::EndMark& so_far, std::uint64_t generations_ended);
    /// Ends the recording of a world that this command deleted. Its file gets an end mark and the name of an ended run.
    void end(const std::string& world, const simulation::RunId& run_id, CommandRecord command);
    /// Renames the files of a damaged world, before it is deleted. The storage thread does not have them open.
    base::Result<void> move_aside(const std::string& world) const { return folder_.move_aside(world); }
    /// Writes an end mark to every file. Must be called when the server stops.
    void close_all(const simulation::Laboratory& laboratory);

  private:
    void begin(run_file::RunBeginning beginning, std::optional<CommandRecord> command, std::optional<ReplacedRun> old);
    void add(const std::string& world, RunRecorder run);

    run_file::DataFolder& folder_;
    StorageThread& thread_;
    Ticket last_ticket_ = 0;
    std::map<std::string, RunRecorder, std::less<>> runs_;                 // by name of the world
    std::map<std::string, std::shared_ptr<Leaving>, std::less<>> leaving_; // by name of the world
};

} // namespace evod::recording
