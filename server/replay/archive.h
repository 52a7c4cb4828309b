// Archive: the runs of a server, in its data folder: brought back when it starts, written down while it runs.
//
// Owner        the server. The laboratory is taken and the recorder used by the simulation thread.
#pragma once

#include "server/recording/recorder.h"
#include "server/recording/storage_thread.h"
#include "server/replay/recovery.h"
#include "server/run_file/data_folder.h"

#include <memory>
#include <string>
#include <vector>

namespace evod::replay {

class Archive {
  public:
    /// Commands of runs that have ended whose answers are remembered: the newest of each run, and of all those that
    /// ended last as long as they take no more bytes; of every other run its last.
    static constexpr std::uint32_t answers_kept_of_ended = 1000;
    static constexpr std::size_t answers_of_ended_bytes_max = 64 << 20;

    /// Takes the folder and brings every world back. Refused, naming the file and the ways out, where one cannot be
    /// brought back: a server that went on without it would seem to have lost it.
    static base::Result<std::unique_ptr<Archive>>
    open(const std::string& path, const run_file::RunFile::Options& options, base::Executor& executor);

    const std::string& path() const { return folder_.path(); }
    run_file::Durability durability() const { return durability_; }
    /// What the run of a world that was brought back began with; nullptr if there is none of that name.
    const run_file::RunIdentity* identity_of(const std::string& world) const;
    bool holds_worlds() const { return !identities_.empty(); }
    /// Of those that were brought back, in order.
    std::vector<std::string> world_names() const;
    /// The worlds; once.
    simulation::Laboratory take_laboratory() { return std::move(laboratory_); }
    /// Commands that were applied, with their answers, oldest first within a run, those of ended runs first; once.
    std::vector<run_file::JournalEntry> take_answers() { return std::move(answers_); }

    /// nullptr once it is closed.
    recording::StorageThread* thread() { return thread_.get(); }
    recording::Recorder& recorder() { return *recorder_; }
    /// Writes what waits, as far as that can be done now; once the recorder is used no more. false: not all could be.
    bool close() {
        const bool all_written = thread_->finish();
        thread_.reset();
        return all_written;
    }

  private:
    Archive(run_file::DataFolder folder, const run_file::RunFile::Options& options);
    /// paths: of runs that have ended. Their answers go before those of the worlds that go on.
    void remember(const std::vector<std::string>& paths);
    /// Returns the path of a run that has ended, once its file is named so; empty: the world goes on.
    base::Result<std::string> bring_back(const std::string& path, const run_file::RunFile::Options& options,
                                         base::Executor& executor);

    run_file::DataFolder folder_;
    run_file::Durability durability_;
    std::unique_ptr<recording::StorageThread> thread_;
    std::unique_ptr<recording::Recorder> recorder_;
    simulation::Laboratory laboratory_;
    std::vector<run_file::RunIdentity> identities_;
    std::vector<run_file::JournalEntry> answers_;
};

} // namespace evod::replay
