// Storage watch: whether the runs of the live worlds can be written, and what becomes of the worlds if not.
//
//   Full run file          the world, which belongs to a class, waits until it is reset or deleted.
//   Slow or failing disk   all worlds wait once the write queue is full. Commands are refused while writing fails.
//   Damaged run file       the world becomes a damaged world. The storage thread has refused its unrecorded commands.
//   Displaced run file     the world waits, and its commands are refused, until its file is back. A longer wait would
//                          cost the other worlds room in the write queue, so it does not run on as it does while the
//                          whole disk fails.
//
// Owner        a simulation loop, on its thread.
#pragma once

#include "server/recording/recorder.h"
#include "server/runtime/clock.h"
#include "server/runtime/loop_outputs.h"
#include "server/runtime/world_builds.h"
#include "server/simulation/laboratory.h"

#include <map>
#include <optional>
#include <string>

namespace evod::runtime {

class StorageWatch {
  public:
    /// A short wait for a working disk is normal. A longer wait is reported.
    static constexpr std::chrono::seconds slow_disk_patience{1};

    /// All arguments must outlive this object. recorder: nullptr if runs are not stored.
    StorageWatch(simulation::Laboratory& laboratory, recording::Recorder* recorder, const WorldBuilds& builds,
                 const LoopOutputs& outputs);

    /// Reads the state of the disk and of the files, applies it to the laboratory and reports what has changed. A world
    /// that a build holds does not become damaged yet.
    void poll(Clock::time_point now);
    /// The time at which the next poll is due even if nothing changes; nullopt: there is none.
    std::optional<Clock::time_point> due() const;

    /// Whether a world must wait.
    bool holds(const simulation::Entry& world) const { return worlds_wait_ || faults_.contains(world.name); }
    /// Returns why a command to the world cannot be recorded now, although the disk works; nullopt if it can.
    std::optional<base::Refusal> refusal_of(const std::string& world) const;

  private:
    void poll_disk(Clock::time_point at);
    void poll_files();
    void stop_damaged(const std::string& world, const base::Refusal& why);

    simulation::Laboratory& laboratory_;
    recording::Recorder* const recorder_;
    const WorldBuilds& builds_;
    const LoopOutputs& outputs_;
    bool worlds_wait_ = false;
    std::optional<Clock::time_point> waiting_since_; // time at which worlds began to wait for a working disk
    std::map<std::string, recording::RunFault> faults_; // by name of the world; none is of a damaged file
};

} // namespace evod::runtime
