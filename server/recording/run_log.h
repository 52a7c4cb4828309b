// Run log: the records that wait to be written to the file of one run, and the file itself while it is open.
//
// New files    a run is created as `NAME.evod-next` and gets its final name when its first records are committed. So
//              an empty file `NAME.evod` is damaged, not incomplete. If the run replaces an older one, the old file
//              first gets its end mark and its new name. At every moment exactly one of the two files is the
//              world's run. After a crash, replay::Archive decides which one.
// Checkpoints  a checkpoint waits in a queue of its own. A job compresses it; then the storage thread writes it part by
//              part.
// Log copies   when a write-ahead log reaches Options::log_pages_max, a job copies it into its file. Meanwhile this
//              file gets no background writes, so that SQLite can restart the log.
// Errors       after a failed write the file is closed. The next write opens it again. Records are kept until they are
//              committed, or until the file is found to be damaged (run_fault.h).
//
// Owner        the storage thread. No other thread uses it.
#pragma once

#include "server/recording/run_fault.h"
#include "server/recording/waiting_record.h"

#include <sys/types.h>

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace evod::recording {

/// Detects that a file was moved or deleted while it is open. Data written to it afterwards would be lost.
class FileNameWatch {
  public:
    static constexpr std::chrono::seconds interval{1}; // time between two checks

    /// Makes the next check accept the file that has the name at that time.
    void forget() { known_.reset(); }
    bool is_lost() const { return known_ && known_->lost; }
    /// Checks at most once per interval. Returns a reason if the name belongs to another file, or to no file.
    std::optional<base::Refusal> check(const std::string& path, std::chrono::steady_clock::time_point now);

  private:
    struct Known {
        dev_t device;
        ino_t number;
        std::chrono::steady_clock::time_point checked = {};
        bool lost = false;
    };
    std::optional<Known> known_;
};

/// The result of a job that has compressed the checkpoint of a run.
struct CompressedCheckpoint {
    run_file::StoredCheckpoint checkpoint;
    std::chrono::nanoseconds took;
};
/// The result of a job that has copied the log of a run into its file.
struct LogCopied {};

struct RunLog {
    /// The creation of a new file. The file has the name NAME.evod-next or does not exist yet.
    struct Creation {
        run_file::RunIdentity identity;
        std::optional<RunNumber> replaces = {}; // the older run that this one replaces
        bool committed = false;                 // its first records are committed
    };
    struct LogCopy {
        bool running = false;    // a copy is on the job queue
        std::uint32_t pages = 0; // pages in the log when it was last copied
    };

    RunNumber number = 0;
    std::string path = {};
    simulation::RunId run_id = {};
    run_file::RunFile::Options options = {};

    std::optional<Creation> creation = {};        // set until the new file has its final name
    std::unique_ptr<run_file::RunFile> file = {}; // nullptr: still to be opened or created
    std::vector<WaitingRecord> waiting = {};
    std::vector<WaitingRecord> written = {}; // records that are committed, but not reported yet
    std::vector<WaitingRecord> checkpoints = {};
    std::optional<Closing> closing = {};
    bool compressing = false; // one checkpoint of this run is on the job queue
    LogCopy log_copy = {};
    bool large_reported = false;
    bool of_class = false; // the world belongs to a class; known when the file is open
    bool full = false;     // RunFile::is_full()
    FileNameWatch name = {};
    std::optional<RunFault> fault = {};
    std::chrono::steady_clock::time_point retry_at = {}; // when a displaced file is tried again
    bool retry_is_due = false;                           // a displaced file is tried in this round

    bool is_damaged() const { return fault && fault->kind == RunFault::Kind::Damaged; }
    bool is_finished() const { return closing && closing->finished; }
    /// The first uncompressed checkpoint; nullptr if there is none, or while another one is being compressed.
    WaitingRecord* next_to_compress();
    /// Adds records that wait.
    void add(std::vector<WaitingRecord> records);
    void apply(CompressedCheckpoint compressed);
    /// If the log has meanwhile grown to four times its limit, copies the rest.
    void apply(LogCopied copied);

    /// Opens or creates the file. Returns true for a new file, which then has an open transaction.
    base::Result<bool> open();
    /// Writes records in one transaction.
    ///
    /// returns  the duration of the commit.
    base::Result<std::chrono::nanoseconds> commit(const std::vector<WaitingRecord>& records);
    /// Reduces the retention of a file that has become too large. Must be called after a commit.
    base::Result<void> shrink();
    /// Gives a new file its final name. The file that it replaces must already have another name.
    base::Result<void> rename_to_final_name();
    /// Renames a closed file to closing->renamed, unless that is empty.
    base::Result<void> rename_ended_file();
    /// Does one small step of background work: deletes rows, or writes a part of a checkpoint. A completed checkpoint
    /// is added to `written`.
    ///
    /// returns  whether there was any work.
    base::Result<bool> background_step();

    /// Whether the log should be copied now. If so, the caller must start the copy.
    bool log_copy_due();

  private:
    base::Refusal fail(base::Refusal why);
};

} // namespace evod::recording
