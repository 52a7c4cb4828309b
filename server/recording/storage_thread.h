// Storage thread: writes the records of all runs to their files, with a group commit per file.
//
// records wait → one transaction per run → commit → calls `done`: the record is on the disk
//
// Group commit   a record with a `done` is committed at once, together with all records that wait. Without one, the
//                thread commits everything that arrived within `gathering_time`.
// Priorities     records with a `done` come first. Background writes are split into transactions of
//                `Options::part_bytes`; the thread serves pending commands between them. Three kinds of writes cannot
//                be split: the beginning of a generation, the outcome of a generation, and the creation or end of a
//                run.
// Checkpoints    come after the other records of all runs. A job compresses them; this thread writes them in parts. At
//                most one checkpoint per run waits. It does not count towards `waiting_bytes_max`. If the run ends, its
//                waiting checkpoint is dropped; if the server stops, the checkpoint is written first.
// Errors         `done` is not called for a record that could not be written. The thread keeps the record. At intervals
//                of `retry_time` it opens the file again and writes all records that may be missing. trouble() returns
//                the reason.
// File names     a moved or deleted file counts as an error, because data written to it would be lost when the server
//                stops. The file stays open, so the error ends when the file is moved back.
// Backpressure   if at least `waiting_bytes_max` bytes wait, has_room() is false and the caller produces no records.
//
// Threads        only the simulation thread calls create(), write(), close() and so on. It never waits for the disk.
//                Run files belong to the storage thread. Jobs on a job queue compress checkpoints and copy write-ahead
//                logs, and return their results to the storage thread.
#pragma once

#include "server/jobs/job_queue.h"
#include "server/metrics/counters.h"
#include "server/recording/run_log.h"

#include <pthread.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace evod::recording {

/// The records that were passed to the storage thread and that it has not taken yet.
struct HandedOver {
    std::map<RunNumber, RunLog> new_runs;
    std::map<RunNumber, std::vector<WaitingRecord>> records;
    std::map<RunNumber, Closing> closing;
};

class StorageThread {
  public:
    static constexpr std::chrono::milliseconds gathering_time{200};
    static constexpr std::chrono::milliseconds retry_time{250};
    static constexpr std::size_t waiting_bytes_max = 64 << 20;
    /// A larger amount is committed at once, so that a command that arrives meanwhile waits for a smaller transaction.
    static constexpr std::size_t gathered_bytes_max = 256 << 10;

    using RunNumber = recording::RunNumber;
    using Done = recording::Done;
    using Record = recording::Record;
    using CheckpointWriting = recording::CheckpointWriting;

    explicit StorageThread(run_file::RunFile::Options options, std::chrono::milliseconds retry_after = retry_time);
    /// Calls finish().
    ~StorageThread();
    /// Writes everything that waits, if that is possible now, and ends the thread. An error in one run does not prevent
    /// writing the others.
    ///
    /// returns  false if something could not be written; the log contains the details.
    bool finish();

    /// The records of one transaction. `done` is empty if no client waits. For a batch without records, `done` is
    /// called once everything passed before it is on the disk.
    struct Batch {
        std::vector<Record> records;
        Done done;
    };
    /// The last records of a run. Then its file is closed and, if `renamed` is not empty, renamed to that path.
    struct Ending {
        Batch last; // the last of these records is the end mark
        std::string renamed;
    };

    /// Creates a run with a new file and its first records.
    RunNumber create(const std::string& path, run_file::RunIdentity identity, Batch first);
    /// Like create(), but the new run replaces another one, which ends.
    RunNumber replace(RunNumber old_run, Ending ending, const std::string& path, run_file::RunIdentity identity,
                      Batch first);
    /// Continues a run whose file is already open.
    RunNumber adopt(std::unique_ptr<run_file::RunFile> file);
    void write(RunNumber run, Batch batch);
    /// Writes a checkpoint. The run must have no other waiting checkpoint. writing->waits is true until the checkpoint
    /// is on the disk.
    void write(RunNumber run, run_file::Checkpoint checkpoint, std::shared_ptr<CheckpointWriting> writing);
    void close(RunNumber run, Ending ending);

    /// Whether everything passed so far is written and no background work is left.
    bool idle() const {
        return waiting_bytes_.load(std::memory_order_acquire) == 0 && waiting_checkpoints_.load() == 0 && !working_ &&
               jobs_running_ == 0;
    }
    /// Size of the data that waits to be written, without checkpoints.
    std::size_t waiting_bytes() const { return waiting_bytes_.load(std::memory_order_relaxed); }
    bool has_room() const { return waiting_bytes() < waiting_bytes_max; }
    /// The time at which the oldest waiting record was added; nullopt if none waits.
    std::optional<std::chrono::steady_clock::time_point> waiting_since() const;
    /// The reason why nothing can be written now; nullopt if writing works.
    std::optional<std::string> trouble() const;
    /// The storage thread calls `changed` when trouble() or has_room() has changed. `changed` must neither block nor
    /// call this object. When this function returns, the previous callback is not called any more.
    void when_changed(std::function<void()> changed);

    /// Durations. Any thread may read them.
    struct Times {
        metrics::TimeHistogram journal_wait; // how long commands waited until they were on the disk
        metrics::TimeHistogram commit;       // duration of transactions, including the sync
    };
    const Times& times() const { return times_; }
    /// Handles of the two threads, for reading their processor time.
    pthread_t handle() { return thread_.native_handle(); }
    pthread_t packing_handle() { return jobs_.handle(); }

  private:
    class Worker;

    std::vector<WaitingRecord> records_of(Batch batch);
    RunNumber add(RunLog run, std::vector<WaitingRecord> records,
                  std::optional<std::pair<RunNumber, Closing>> old = std::nullopt);
    /// Passes all records in one step, so that the storage thread takes either all of them or none.
    void hand_over(RunNumber run, std::vector<WaitingRecord> records);
    /// Returns whether the storage thread must be woken. The caller must hold mutex_.
    bool enqueue(RunNumber run, std::vector<WaitingRecord> records);
    void set_trouble(const std::string& why);

    const run_file::RunFile::Options options_;
    const std::chrono::milliseconds retry_after_;
    std::atomic<std::size_t> waiting_bytes_ = 0, waiting_checkpoints_ = 0;
    std::atomic<std::size_t> jobs_running_ = 0;
    std::atomic<bool> working_ = false; // the storage thread is working, or has more to do
    Times times_;                       // the storage thread writes them

    mutable std::mutex mutex_; // guards the members below
    std::condition_variable changed_;
    HandedOver handed_over_;
    std::vector<std::function<void(Worker&)>> results_; // results of finished jobs
    // handed_over_since_: when the oldest record in handed_over_ was added. taken_since_: when the oldest record was
    // added that the thread has taken but not yet written.
    std::optional<std::chrono::steady_clock::time_point> handed_over_since_, taken_since_;
    RunNumber last_number_ = 0;
    bool urgent_ = false, stopping_ = false;
    bool lost_ = false; // something could not be written before the thread ended
    std::string trouble_;
    std::function<void()> when_changed_;

    jobs::JobQueue jobs_{{.name = "packing", .niceness = 10, .start_now = true}}; // its jobs use the members above
    // Last, because it uses all other members.
    std::thread thread_;
};

} // namespace evod::recording
