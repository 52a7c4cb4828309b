// Archive: the runs of a server in its data folder: recovers them at start, and records them afterwards.
//
// Owner        the server. The simulation thread takes the laboratory and uses the recorder.
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
    /// Of ended runs, newest first: as many answers of each as this, until they take `answers_of_ended_bytes_max` in all;
    /// of every further run the last answer. The reply cache begins with them.
    static constexpr std::uint32_t answers_kept_of_ended = 1000;
    static constexpr std::size_t answers_of_ended_bytes_max = 64 << 20;

    /// Locks the folder and recovers every world. Refused if one cannot be recovered, with its file and what to do: a
    /// server without that world would seem to have lost it.
    static base::Result<std::unique_ptr<Archive>>
    open(const std::string& path, const run_file::RunFile::Options& options, base::Executor& executor);

    const std::string& path() const { return folder_.path(); }
    run_file::Durability durability() const { return durability_; }
    /// The identity of the run of a recovered world; nullptr if there is none of that name.
    const run_file::RunIdentity* identity_of(const std::string& world) const;
    bool holds_worlds() const { return !identities_.empty(); }
    /// The recovered worlds, in order.
    std::vector<std::string> world_names() const;
    /// The recovered worlds; to be called once.
    simulation::Laboratory take_laboratory() { return std::move(laboratory_); }
    /// Applied commands with their answers: those of ended runs first, within a run oldest first. To be called once.
    std::vector<run_file::JournalEntry> take_answers() { return std::move(answers_); }

    /// nullptr after close().
    recording::StorageThread* thread() { return thread_.get(); }
    recording::Recorder& recorder() { return *recorder_; }
    /// Writes what waits, as far as that is possible now, after the last use of the recorder. false: something is lost.
    bool close() {
        const bool all_written = thread_->finish();
        thread_.reset();
        return all_written;
    }

  private:
    Archive(run_file::DataFolder folder, const run_file::RunFile::Options& options);
    /// Reads the answers of ended runs; they come before those of recovered worlds.
    void remember(const std::vector<std::string>& paths);
    /// Recovers one world. Returns the new path of a run that has ended; empty: the world continues.
    base::Result<std::string> recover_world(const std::string& path, const run_file::RunFile::Options& options,
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
