// Recorder: what a laboratory's runs hand over to their files while they run.
//
// Owner        the simulation thread.
// Determinism  it only looks. How long ticks take decides when there is a checkpoint, and nothing else.
#pragma once

#include "server/recording/storage_thread.h"
#include "server/run_file/data_folder.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <map>
#include <memory>
#include <string>

namespace evod::recording {

/// A command that was applied, and who is told once that is on the disk.
struct CommandRecord {
    std::uint64_t tick = 0;              // after which it was applied
    simulation::RunControl control = {}; // as it was then
    run_file::Origin origin = {};
    std::string answer = {};
    StorageThread::Done done = {};
};

/// What a file says first of a run that begins with this world, now.
run_file::RunIdentity identity_of(std::string name, const simulation::RunId& run_id, const simulation::World& world);

/// What a run has to say as its world is advanced: beginnings and ends of generations, and the chain of hashes.
class RunNews {
  public:
    RunNews() = default;
    /// Of a run that goes on, of which this has been told.
    RunNews(std::uint64_t tick, std::uint64_t generations_begun, std::uint64_t generations_ended)
        : tick_{tick}, begun_{generations_begun}, ended_{generations_ended} {}

    /// Gives write(…) what is new; to be called after every tick and before the first.
    template <class Write>
    void tell(const simulation::World& world, Write&& write) {
        const simulation::Moment& moment = world.moment();
        if (moment.generation != begun_) {
            write(run_file::beginning_of(world));
            begun_ = moment.generation;
        }
        if (moment.tick > tick_ && moment.tick % run_file::ticks_per_link == 0) {
            write(run_file::HashLink{moment.tick, world.hash()});
        }
        seen(moment.tick);
        if (world.generation_over() && ended_ != moment.generation) {
            write(run_file::end_of(world));
            ended_ = moment.generation;
        }
    }
    /// Of this tick all has been told, by whatever else.
    void seen(std::uint64_t tick) { tick_ = std::max(tick_, tick); }

    std::uint64_t tick() const { return tick_; } // the last
    std::uint64_t generations_begun() const { return begun_; }

  private:
    std::uint64_t tick_ = 0, begun_ = 0, ended_ = 0;
};

/// Of one run.
class RunRecorder {
  public:
    /// A checkpoint is worth it once the run has been simulated for longer than this since it could last be begun again
    /// from what the file holds.
    static constexpr std::chrono::seconds worth_a_checkpoint{2};
    /// Time between two checkpoints, in times of what the last one took on both threads.
    static constexpr int checkpoint_cost_factor = 50;

    /// A run that goes on.
    RunRecorder(StorageThread& thread, StorageThread::RunNumber number, const run_file::EndMark& so_far,
                std::uint64_t generations_ended)
        : thread_{thread}
        , number_{number}
        , news_{so_far.tick, so_far.generations, generations_ended}
        , journal_entries_{so_far.journal_entries} {}

    /// Hands over what is new; to be called after every tick and before the first.
    void follow(const simulation::World& world) {
        const simulation::Moment& moment = world.moment();
        if (moment.generation != news_.generations_begun() || moment.tick % run_file::ticks_per_link == 0 ||
            world.generation_over()) {
            hand_over(world);
        }
    }
    void journal(CommandRecord command);
    /// done: called as StorageThread does, once everything that was handed over is on the disk.
    void once_written(StorageThread::Done done) { thread_.write(number_, {{}, std::move(done)}); }
    /// Whether a checkpoint is due right after the tick that was followed last. spent: on simulating it.
    bool checkpoint_due(const simulation::World& world, std::chrono::nanoseconds spent);
    /// Makes one; then checkpoint_took() tells how long the simulation had to wait for it.
    void make_checkpoint(const simulation::World& world, base::Executor& executor);
    void checkpoint_took(std::chrono::nanoseconds time) { copying_took_ = time; }

  private:
    friend class Recorder;
    explicit RunRecorder(StorageThread& thread) : thread_{thread} {}
    void hand_over(const simulation::World& world);
    std::vector<StorageThread::Record> news(const simulation::World& world);
    run_file::JournalEntry entry(CommandRecord& command);
    /// What a run that begins has in its file from the beginning.
    StorageThread::Batch first(const simulation::World& world, std::optional<CommandRecord> command);
    /// The end mark of a run that is over, or whose server stops, after `tick`; and before it the command that ended
    /// it.
    StorageThread::Ending ending(std::uint64_t tick, bool ended, std::string renamed = {},
                                 std::optional<CommandRecord> command = {});

    StorageThread& thread_;
    StorageThread::RunNumber number_ = 0;
    RunNews news_; // that has been handed over
    std::uint64_t journal_entries_ = 0;

    // Simulated since the file holds something to begin from; since the last checkpoint.
    std::chrono::nanoseconds since_beginning_{0}, since_checkpoint_{0};
    std::chrono::nanoseconds copying_took_{0};
    std::shared_ptr<StorageThread::CheckpointWriting> writing_ = std::make_shared<StorageThread::CheckpointWriting>();
};

/// Of all runs of a laboratory.
class Recorder {
  public:
    Recorder(run_file::DataFolder& folder, StorageThread& thread) : folder_{folder}, thread_{thread} {}

    /// Why a command cannot be taken now; nothing if it can.
    std::optional<base::Refusal> refusal() const;
    /// Why no world of that name can begin: the place of its file is taken by one that is no world's here. Nothing if
    /// it can, or there is such a world.
    std::optional<base::Refusal> refusal_of_place(const std::string& world) const;
    /// Whether worlds may go on: what they have to say can be kept.
    bool has_room() const { return thread_.has_room(); }
    /// Why nothing gets onto the disk at present; nothing if it does.
    std::optional<std::string> trouble() const { return thread_.trouble(); }
    /// As StorageThread does, when has_room() or trouble() have news.
    void when_changed(std::function<void()> changed) { thread_.when_changed(std::move(changed)); }

    /// Of a world that has a file; nullptr for another.
    RunRecorder* of(const std::string& world);

    /// Where the file of a world's run is, or will be once the run is over.
    std::vector<std::string> paths_of(const std::string& world, const simulation::RunId& run_id) const {
        return {folder_.file_of(world), folder_.ended_file_of(world, run_id)};
    }

    /// A world that has just begun its run, by this command.
    void begin(const simulation::Entry& entry, std::optional<CommandRecord> command = {});
    /// The same for one that was taken from another's run, where that was.
    void begin_fork(const simulation::Entry& entry, const simulation::RunId& origin, CommandRecord command,
                    base::Executor& executor);
    /// The same for a world that begins again: the run it had is over, after `tick`, and its file gets the name of one
    /// that has ended.
    void begin_again(const simulation::Entry& entry, const simulation::RunId& ended_run, std::uint64_t tick,
                     std::optional<CommandRecord> command = {});
    /// A world that goes on with the run of a file.
    RunRecorder& go_on(const std::string& world, std::unique_ptr<run_file::RunFile> file,
                       const run_file::EndMark& so_far, std::uint64_t generations_ended);
    /// Its run is over, by this command: its file gets its end mark and the name of one that has ended.
    void end(const std::string& world, const simulation::RunId& run_id, CommandRecord command);
    /// The server stops: every file gets its end mark.
    void close_all(const simulation::Laboratory& laboratory);

  private:
    void add(const std::string& world, RunRecorder run);

    run_file::DataFolder& folder_;
    StorageThread& thread_;
    std::map<std::string, RunRecorder, std::less<>> runs_; // by world
    /// How many runs of a world are over whose file still has its name, for all that is known here.
    using Leaving = std::atomic<std::size_t>;
    std::map<std::string, std::shared_ptr<Leaving>, std::less<>> leaving_; // by world
};

} // namespace evod::recording
