// File faults: what becomes of the worlds whose run files cannot be written although the disk can. The faults and their
// kinds are described in recording/run_fault.h.
//
//   Damaged     the world becomes a damaged world. The storage thread has refused its unrecorded commands.
//   Displaced   the world waits, and its commands are refused, until its file is back. A longer wait would cost the other
//               worlds room in the write queue, so it does not run on as it does while the whole disk fails.
//
// Owner        the simulation loop, on the simulation thread.
#pragma once

#include "server/recording/recorder.h"
#include "server/runtime/world_builds.h"
#include "server/simulation/laboratory.h"

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace evod::runtime {

class FileFaults {
  public:
    /// All arguments must outlive this object. recorder: nullptr if the server stores no runs.
    FileFaults(simulation::Laboratory& laboratory, recording::Recorder* recorder, const WorldBuilds& builds)
        : laboratory_{laboratory}, recorder_{recorder}, builds_{builds} {}

    struct Changes {
        std::vector<simulation::DamagedWorld> damaged; // the laboratory contains them now as damaged worlds
        std::vector<std::pair<std::string, simulation::Storage>> storage; // by name of the world
    };
    /// Reads the faults and applies them to the laboratory. A world that a build holds does not become damaged yet. Must
    /// be called after Laboratory::set_storage().
    Changes poll();

    bool is_displaced(const std::string& world) const { return displaced_.contains(world); }
    /// Returns why a command to the world cannot be recorded now; nullopt if it can.
    std::optional<base::Refusal> refusal_of(const std::string& world) const;

  private:
    simulation::Laboratory& laboratory_;
    recording::Recorder* recorder_;
    const WorldBuilds& builds_;
    std::map<std::string, base::Refusal> displaced_; // by name of the world
};

} // namespace evod::runtime
