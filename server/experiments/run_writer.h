// Run writer: writes the run file of a world that is simulated without a server.
//
// The file contains everything that a server would record, except checkpoints. It needs none, because it is read only
// after the run has ended. The file gets its final name when it is complete and on the disk.
//
// Owner        the thread that advances the world.
// Threads      only the owner.
// Determinism  it reads the world and never changes it.
#pragma once

#include "server/recording/recorder.h"

#include <memory>
#include <string>

namespace evod::experiments {

class RunWriter {
  public:
    /// name  name of the world in the file.
    RunWriter(std::string path, std::string name, const simulation::RunId& run_id, const simulation::World& world);
    RunWriter(const RunWriter&) = delete;
    RunWriter& operator=(const RunWriter&) = delete;
    /// Deletes the file, unless finish() has renamed it.
    ~RunWriter();

    /// Writes the new records of the world. Must be called before the first tick and after every tick.
    base::Result<void> follow(const simulation::World& world);
    /// Completes the file and renames it to its final name. Replaces an existing file with that name.
    base::Result<void> finish();

  private:
    const std::string path_, temporary_path_;
    base::Result<std::unique_ptr<run_file::RunFile>> file_;
    recording::NewRecordFinder new_records_; // the records that have been written
};

} // namespace evod::experiments
