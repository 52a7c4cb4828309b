// Storage thread: writes the records of all runs to their files, with a group commit per file.
//
//   records wait → one transaction per run → commit → `done` is called: the record is on the disk
//
// Group commit   the thread commits at once for a record with a `done`, otherwise what has come within `gathering_time`.
// Priorities     records with a `done` come first. Background writes are split into transactions of
//                `Options::part_bytes`; between two of them the thread serves pending commands. Three writes cannot be
//                split: the beginning of a generation, the outcome of a generation, and the creation or end of a run.
// Checkpoints    come after the records of all runs. The job queue compresses them; this thread writes them in parts. A
//                run has at most one waiting checkpoint, which the bound on waiting bytes does not count. If its run
//                ends, a waiting checkpoint is dropped; if the server stops, it is written first.
// Errors         `done` is not called for a record that could not be written. The record is kept; every `retry_time` the
//                thread opens the file again and writes all records that may be missing. trouble() has the reason.
// File names     a file that was moved or deleted counts as an error: what is written to it would be lost when the
//                server stops. It stays open, so that moving it back ends the error.
// Backpressure   has_room() is false from `waiting_bytes_max` on; then the caller stops producing records.
//
// Threads        one thread calls create(), write(), close() …: the simulation thread, which never waits for the disk.
//                Run files belong to this thread. Compressing a checkpoint and copying a write-ahead log go to a job
//                queue, which hands the results back.
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

/// What runs have handed over and the storage thread has not taken yet.
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
    /// More bytes are committed at once, so that a command that comes meanwhile waits for less.
    static constexpr std::size_t gathered_bytes_max = 256 << 10;

    using RunNumber = recording::RunNumber;
    using Done = recording::Done;
    using Record = recording::Record;
    using CheckpointWriting = recording::CheckpointWriting;

    explicit StorageThread(run_file::RunFile::Options options, std::chrono::milliseconds retry_after = retry_time);
    /// Calls finish().
    ~StorageThread();
    /// Writes what waits, as far as that is possible now, and ends the thread. A run that fails does not prevent others
    /// from being written.
    ///
    /// returns  false if something could not be written; the log says what.
    bool finish();

    /// Records of one transaction. done: empty if no client waits. A batch without records is done when everything
    /// handed over before is.
    struct Batch {
        std::vector<Record> records;
        Done done;
    };
    /// The last records of a run; then its file is closed, and renamed if `renamed` is not empty.
    struct Ending {
        Batch last; // its last record is the end mark
        std::string renamed;
    };

    /// Creates a file for a run, with its first records.
    RunNumber create(const std::string& path, run_file::RunIdentity identity, Batch first);
    /// The same in the place of another run, which ends.
    RunNumber replace(RunNumber old_run, Ending ending, const std::string& path, run_file::RunIdentity identity,
                      Batch first);
    /// Continues the run of an open file.
    RunNumber adopt(std::unique_ptr<run_file::RunFile> file);
    void write(RunNumber run, Batch batch);
    /// No checkpoint of the run waits. Sets writing->waits until it is on the disk.
    void write(RunNumber run, run_file::Checkpoint checkpoint, std::shared_ptr<CheckpointWriting> writing);
    void close(RunNumber run, Ending ending);

    /// Whether everything handed over is written, and no background work is left.
    bool idle() const {
        return waiting_bytes_.load(std::memory_order_acquire) == 0 && waiting_checkpoints_.load() == 0 && !working_ &&
               jobs_running_ == 0;
    }
    /// What waits to be written, except checkpoints.
    std::size_t waiting_bytes() const { return waiting_bytes_.load(std::memory_order_relaxed); }
    bool has_room() const { return waiting_bytes() < waiting_bytes_max; }
    /// Since when the oldest waiting record has waited; nullopt: none waits.
    std::optional<std::chrono::steady_clock::time_point> waiting_since() const;
    /// Why nothing can be written at present; nothing if it can.
    std::optional<std::string> trouble() const;
    /// changed: called on the storage thread when trouble() or has_room() has changed; must neither block nor call back.
    /// The previous function is not called any more once this returns.
    void when_changed(std::function<void()> changed);

    /// Any thread may read them.
    struct Times {
        metrics::TimeHistogram journal_wait; // of commands, from handing over until they are on the disk
        metrics::TimeHistogram commit;       // of transactions, the sync included
    };
    const Times& times() const { return times_; }
    /// The threads, for reading their processor time.
    pthread_t handle() { return thread_.native_handle(); }
    pthread_t packing_handle() { return jobs_.handle(); }

  private:
    class Worker;

    std::vector<WaitingRecord> records_of(Batch batch);
    RunNumber add(RunLog run, std::vector<WaitingRecord> records,
                  std::optional<std::pair<RunNumber, Closing>> old = std::nullopt);
    /// All in one step, so that the storage thread takes all of them or none.
    void hand_over(RunNumber run, std::vector<WaitingRecord> records);
    /// Whether the storage thread has to be woken. mutex_ is held.
    bool enqueue(RunNumber run, std::vector<WaitingRecord> records);
    void set_trouble(const std::string& why);

    const run_file::RunFile::Options options_;
    const std::chrono::milliseconds retry_after_;
    std::atomic<std::size_t> waiting_bytes_ = 0, waiting_checkpoints_ = 0;
    std::atomic<std::size_t> jobs_running_ = 0;
    std::atomic<bool> working_ = false; // the storage thread, or there is more for it to do
    Times times_;                       // written by the storage thread

    mutable std::mutex mutex_; // guards what follows
    std::condition_variable changed_;
    HandedOver handed_over_;
    std::vector<std::function<void(Worker&)>> results_; // of jobs
    // The oldest record in handed_over_; the oldest that the storage thread has taken and not written yet.
    std::optional<std::chrono::steady_clock::time_point> handed_over_since_, taken_since_;
    RunNumber last_number_ = 0;
    bool urgent_ = false, stopping_ = false;
    bool lost_ = false; // at the end, something could not be written
    std::string trouble_;
    std::function<void()> when_changed_;

    jobs::JobQueue jobs_{{.name = "packing", .niceness = 10, .start_now = true}}; // its jobs use what comes before
    std::thread thread_;                                                          // last: it uses the rest
};

} // namespace evod::recording
