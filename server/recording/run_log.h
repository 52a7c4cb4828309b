// Run log: the records that wait to be written to one run's file, and the file while it is open.
//
// New files    a run is created as `NAME.evod-next` and gets its name once its first records are committed. So a file
//              `NAME.evod` without content is damaged, never incomplete. If the run replaces another one, the old file
//              first gets its end mark and its new name. At every instant one of the two files is the world's run;
//              replay::Archive decides which after a crash.
// Checkpoints  a checkpoint waits beside the other records. The storage thread has it compressed on the job queue and
//              then writes it part by part.
// Log copies   a write-ahead log that has grown to Options::log_pages_max is copied into its file by the job queue.
//              Background work of the file pauses meanwhile, so that SQLite can restart the log.
// Errors       a failed write closes the file; the next one opens it again. Records stay until they are committed.
//
// Owner        the storage thread, and used by it alone.
#pragma once

#include "server/recording/waiting_record.h"

#include <sys/types.h>

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace evod::recording {

/// A run while its file is open here.
using RunNumber = std::uint64_t;

/// Watches that a file keeps its name: what is written to a file that was moved or deleted would be lost.
class FileNameWatch {
  public:
    static constexpr std::chrono::seconds interval{1}; // between two checks

    /// The next check takes the file that has the name then for the right one.
    void forget() { known_.reset(); }
    bool is_lost() const { return known_ && known_->lost; }
    /// Checks at most once per interval. Returns the reason if another file has the name, or none.
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

struct RunLog {
    /// A new file, which has the name NAME.evod-next or does not exist yet.
    struct Creation {
        run_file::RunIdentity identity;
        std::optional<RunNumber> replaces = {}; // the run that it replaces
        bool committed = false;                 // its first records are
    };
    struct LogCopy {
        bool running = false;    // on the job queue
        std::uint32_t pages = 0; // of the log when it was last copied
    };

    RunNumber number = 0;
    std::string path = {};
    run_file::RunFile::Options options = {};

    std::optional<Creation> creation = {};        // until the file has its name
    std::unique_ptr<run_file::RunFile> file = {}; // nullptr: to be opened, or created
    std::vector<WaitingRecord> waiting = {};
    std::vector<WaitingRecord> written = {}; // committed, but not reported yet
    std::vector<WaitingRecord> checkpoints = {};
    std::optional<Closing> closing = {};
    bool compressing = false; // one of its checkpoints is on the job queue
    LogCopy log_copy = {};
    bool large_reported = false;
    FileNameWatch name = {};

    bool is_finished() const { return closing && closing->finished; }
    /// The first checkpoint that is not compressed; nullptr for none, and while one is being compressed.
    WaitingRecord* next_to_compress();
    void compressed(run_file::StoredCheckpoint checkpoint, std::chrono::nanoseconds took);

    /// Opens the file, or creates it. true: a new file, with an open transaction.
    base::Result<bool> open();
    /// Writes records in one transaction.
    ///
    /// returns  how long the commit took.
    base::Result<std::chrono::nanoseconds> commit(const std::vector<WaitingRecord>& records);
    /// After a commit: reduces the retention of a file that has become too large.
    base::Result<void> shrink();
    /// Gives a new file its name; the file that it replaces is out of the way.
    base::Result<void> take_name();
    /// Gives a closed file the name of an ended run, if it is to have one.
    base::Result<void> rename_ended();
    /// Deletes or writes a little that no client waits for. `written` then has a checkpoint that is complete.
    ///
    /// returns  whether there was anything to do.
    base::Result<bool> background_step();

    /// Whether the log should be copied now; then its copy is expected to begin.
    bool log_copy_due();
    /// A copy has ended. If the log has grown to four times its limit meanwhile, copies the rest.
    void log_copied();

  private:
    base::Refusal fail(base::Refusal why);
};

} // namespace evod::recording
