// Run writer: writes the run file of a world that runs without a server.
//
// The file contains what the recorder of a server would write, except checkpoints, because the file is read only after
// the run has ended. It gets its name when it is complete and on the disk.
//
// Owner        the thread that advances the world.
// Threads      that one.
// Determinism  it reads the world and changes nothing in it.
#pragma once

#include "server/recording/recorder.h"

#include <memory>
#include <string>

namespace evod::experiments {

class RunWriter {
  public:
    /// name  of the world in the file.
    RunWriter(std::string path, std::string name, const simulation::RunId& run_id, const simulation::World& world);
    RunWriter(const RunWriter&) = delete;
    RunWriter& operator=(const RunWriter&) = delete;
    /// Removes the file, unless finish() has named it.
    ~RunWriter();

    /// Writes what is new in the world. To be called before the first tick and after every tick.
    base::Result<void> follow(const simulation::World& world);
    /// Completes the file and gives it its name. Replaces a file of that name.
    base::Result<void> finish();

  private:
    const std::string path_, temporary_path_;
    base::Result<std::unique_ptr<run_file::RunFile>> file_;
    recording::RunNews news_; // the part of the run that is in the file
};

} // namespace evod::experiments
