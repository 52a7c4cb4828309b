// Archive: all runs in a server's data folder. It recovers their worlds when the server starts, and then records them.
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
    /// When the server starts, the reply cache gets the last answers of ended runs: up to this number of each run,
    /// beginning with the newest run. After `answers_of_ended_bytes_max` in total, each older run contributes only its
    /// last answer.
    static constexpr std::uint32_t answers_kept_of_ended = 1000;
    static constexpr std::size_t answers_of_ended_bytes_max = 64 << 20;
    /// For older commands, the reply cache gets the highest request_id of up to this number of client keys of each run.
    static constexpr std::size_t keys_kept_of_ended = 100'000;

    /// Locks the folder and recovers every world. A world that cannot be recovered becomes a damaged world, with the
    /// reason and what can be done; its file is not changed. Refused if the folder cannot be used.
    static base::Result<std::unique_ptr<Archive>>
    open(const std::string& path, const run_file::RunFile::Options& options, base::Executor& executor);

    const std::string& path() const { return folder_.path(); }
    run_file::Durability durability() const { return durability_; }
    /// The identity of the run of a recovered world; nullptr if there is no recovered world with this name.
    const run_file::RunIdentity* identity_of(const std::string& world) const;
    /// Whether there is a damaged world with this name.
    bool is_damaged(const std::string& world) const;
    /// The names of all worlds, damaged ones too, in alphabetical order.
    std::vector<std::string> world_names() const;
    /// Removes the worlds from the archive and returns them. Must be called only once.
    simulation::Laboratory take_laboratory() { return std::move(laboratory_); }
    /// Removes the applied commands and their answers from the archive and returns them: ended runs first; within a
    /// run, in the order of application. Must be called only once.
    std::vector<run_file::JournalEntry> take_answers() { return std::move(answers_); }

    /// Removes from the archive, and returns, the client keys of commands whose answers are not among take_answers():
    /// commands of ended runs and of damaged worlds. The key that was used last is the last one. Must be called only
    /// once.
    std::vector<run_file::UsedKey> take_used_keys() { return std::move(used_keys_); }

    /// The storage thread; nullptr after close().
    recording::StorageThread* thread() { return thread_.get(); }
    recording::Recorder& recorder() { return *recorder_; }
    /// Writes all waiting records, if that is possible now. Must be called after the last use of the recorder. Returns
    /// false if data was lost.
    bool close() {
        const bool all_written = thread_->finish();
        thread_.reset();
        return all_written;
    }

  private:
    Archive(run_file::DataFolder folder, const run_file::RunFile::Options& options);
    /// Reads the answers of ended runs and inserts them before the answers of recovered worlds. Reads the client keys
    /// of older commands, and those of damaged worlds.
    void read_ended_answers(const std::vector<std::string>& ended, const std::vector<std::string>& damaged);
    /// Recovers one world. Returns an empty text if the world continues. If its run has ended, returns the new path of
    /// the file. Before the world is recovered, its file is only read.
    base::Result<std::string> recover_world(const std::string& path, const run_file::RunFile::Options& options,
                                            base::Executor& executor);

    void add_damaged(const std::string& path, const base::Refusal& why);

    run_file::DataFolder folder_;
    run_file::Durability durability_;
    std::unique_ptr<recording::StorageThread> thread_;
    std::unique_ptr<recording::Recorder> recorder_;
    simulation::Laboratory laboratory_;
    std::vector<run_file::RunIdentity> identities_;
    std::vector<std::string> damaged_; // names of the damaged worlds
    std::vector<run_file::JournalEntry> answers_;
    std::vector<run_file::UsedKey> used_keys_;
};

} // namespace evod::replay
