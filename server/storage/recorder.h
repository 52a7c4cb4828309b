// Recorder: what a laboratory's runs hand over to their files while they run.
//
// Owner        the simulation thread.
// Determinism  it only looks. How long ticks take decides when there is a checkpoint, and nothing else.
#pragma once

#include "server/storage/data_folder.h"
#include "server/storage/storage_thread.h"

#include <chrono>
#include <map>
#include <memory>
#include <string>

namespace evod::storage {

/// Of one run.
class RunRecorder {
  public:
    /// A checkpoint is worth it once the run has been simulated for longer than this since it could last be begun again
    /// from what the file holds.
    static constexpr std::chrono::seconds worth_a_checkpoint{2};
    /// Time between two checkpoints, in times of what the last one took on both threads.
    static constexpr int checkpoint_cost_factor = 50;

    /// A run that begins.
    RunRecorder(StorageThread& thread, StorageThread::RunNumber number) : thread_{thread}, number_{number} {}
    /// A run that goes on.
    RunRecorder(StorageThread& thread, StorageThread::RunNumber number, const EndMark& so_far,
                std::uint64_t generations_ended)
        : thread_{thread}, number_{number}, written_{so_far}, generations_ended_{generations_ended} {}

    /// Hands over what is new; to be called after every tick and before the first.
    void follow(const simulation::World& world) {
        const simulation::Moment& moment = world.moment();
        if (moment.generation != written_.generations || moment.tick % ticks_per_link == 0 || world.generation_over())
            hand_over(world);
    }
    /// Whether a checkpoint is due right after the tick that was followed last. spent: on simulating it.
    bool checkpoint_due(const simulation::World& world, std::chrono::nanoseconds spent);
    /// Makes one; then checkpoint_took() tells how long the simulation had to wait for it.
    void make_checkpoint(const simulation::World& world, base::Executor& executor);
    void checkpoint_took(std::chrono::nanoseconds time) { copying_took_ = time; }
    /// A command that was applied, with the answer it got. done: see StorageThread.
    void journal(std::uint64_t tick, const simulation::RunControl& control, Origin origin, std::string answer,
                 StorageThread::Done done);
    /// The run is over, or the server stops, after `tick`; nothing is handed over any more. renamed: see StorageThread.
    void close(std::uint64_t tick, bool ended, std::string renamed = {});

  private:
    void hand_over(const simulation::World& world);

    StorageThread& thread_;
    StorageThread::RunNumber number_;
    EndMark written_; // what has been handed over; its links are not counted
    std::uint64_t generations_ended_ = 0;

    // Simulated since the file holds something to begin from; since the last checkpoint.
    std::chrono::nanoseconds since_beginning_{0}, since_checkpoint_{0};
    std::chrono::nanoseconds copying_took_{0};
    std::shared_ptr<StorageThread::CheckpointWriting> writing_ = std::make_shared<StorageThread::CheckpointWriting>();
};

/// Of all runs of a laboratory.
class Recorder {
  public:
    Recorder(DataFolder& folder, StorageThread& thread) : folder_{folder}, thread_{thread} {}

    /// Why a command cannot be taken now; nothing if it can.
    std::optional<base::Refusal> refusal() const;
    /// Whether worlds may go on: what they have to say can be kept.
    bool has_room() const { return thread_.has_room(); }

    /// Of a world that has a file; nullptr for another.
    RunRecorder* of(const std::string& world);

    /// A world that has just begun its run.
    RunRecorder& begin(const simulation::Entry& entry);
    /// A world that goes on with the run of a file.
    RunRecorder& go_on(const std::string& world, std::unique_ptr<RunFile> file, const EndMark& so_far,
                       std::uint64_t generations_ended);
    /// Its run is over, after `tick`: its file gets its end mark and the name of one that has ended.
    void end(const std::string& world, const simulation::RunId& run_id, std::uint64_t tick);
    /// The server stops: every file gets its end mark.
    void close_all(const simulation::Laboratory& laboratory);

  private:
    DataFolder& folder_;
    StorageThread& thread_;
    std::map<std::string, RunRecorder, std::less<>> runs_; // by world
};

} // namespace evod::storage
