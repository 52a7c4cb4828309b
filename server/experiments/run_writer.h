// Run writer: the run file of a world that runs without a server, by whoever advances it.
//
// It holds what a server's recorder would have handed over, but checkpoints: such runs are read once they are over. The
// file gets its name when it is whole and on the disk.
//
// Owner        the thread that advances the world.
// Determinism  it only looks.
#pragma once

#include "server/recording/recorder.h"

#include <memory>
#include <string>

namespace evod::experiments {

class RunWriter {
  public:
    /// name  of the world, as the file has it.
    RunWriter(std::string path, std::string name, const simulation::RunId& run_id, const simulation::World& world);
    RunWriter(const RunWriter&) = delete;
    RunWriter& operator=(const RunWriter&) = delete;
    /// What has not been finished is taken away.
    ~RunWriter();

    /// To be called before the first tick and after every tick.
    base::Result<void> follow(const simulation::World& world);
    /// The run is over for now; takes the place of a file that is there.
    base::Result<void> finish();

  private:
    const std::string path_, unfinished_;
    base::Result<std::unique_ptr<run_file::RunFile>> file_;
    recording::RunNews news_; // that is in it
};

} // namespace evod::experiments
