// Recorder: what a laboratory's runs hand over to their files while they run.
//
// Owner        the simulation thread.
// Determinism  it only looks.
#pragma once

#include "server/storage/data_folder.h"
#include "server/storage/storage_thread.h"

#include <map>
#include <memory>
#include <string>

namespace evod::storage {

/// Of one run.
class RunRecorder {
  public:
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
