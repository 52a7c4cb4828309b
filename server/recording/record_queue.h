// Record queue: the records on their way from the simulation thread to the storage thread.
//
// Group commit   a record with a ticket is taken at once, together with all records that wait. Without one, the storage
//                thread takes everything that arrived within `gathering_time`.
// Full           the records have no bound here: DiskState counts their bytes.
// Threads        the simulation thread adds records. The storage thread takes them, and the results of jobs.
#pragma once

#include "server/recording/disk_state.h"
#include "server/recording/run_log.h"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <map>
#include <mutex>
#include <optional>
#include <variant>
#include <vector>

namespace evod::recording {

/// What was added and what the storage thread has not taken yet.
struct HandedOver {
    struct OfRun {
        std::optional<RunLog> added = {}; // only for a new run; with its first records
        std::vector<WaitingRecord> records = {};
        std::optional<Closing> closing = {};
    };
    std::map<RunNumber, OfRun> runs;
    bool stopping = false; // the thread must end when everything is written
};

/// A run that is replaced by another one, and its end.
struct ReplacedRun {
    RunNumber number;
    Closing closing;
};

/// The result of a job for a run.
struct JobResult {
    RunNumber run;
    std::variant<CompressedCheckpoint, LogCopied> result;
};

class RecordQueue {
  public:
    static constexpr std::chrono::milliseconds gathering_time{200};
    /// A larger amount is committed at once, so that a command that arrives then waits for a smaller transaction.
    static constexpr std::size_t gathered_bytes_max = 256 << 10;

    /// The state must outlive this object.
    explicit RecordQueue(DiskState& disk) : disk_{disk} {}

    /// Adds a run with its first records, and the end of the run that it replaces. The storage thread takes either all
    /// of this or nothing.
    RunNumber add_run(RunLog run, std::optional<ReplacedRun> old = std::nullopt);
    void add(RunNumber run, std::vector<WaitingRecord> records);
    void close(RunNumber run, Closing closing);
    void stop();
    /// The time since which the oldest waiting record has waited; nullopt if none waits.
    std::optional<std::chrono::steady_clock::time_point> waiting_since() const;

    /// Waits for records, results or stop(), then removes and returns the records that are due.
    ///
    /// more         true: does not wait, because the caller has other work.
    /// retry_at     if set, waits until this time, because a write has failed. A barrier ends the wait.
    /// wake_at      if set, waits for records until this time at most, because a single run must then be tried again.
    /// jobs_run     true: jobs are running; the thread must not end before their results have arrived.
    HandedOver take(bool more, std::optional<std::chrono::steady_clock::time_point> retry_at,
                    std::optional<std::chrono::steady_clock::time_point> wake_at, bool jobs_run);
    /// Called when all records that were taken are written.
    void all_written();
    /// Whether a record with a ticket waits.
    bool is_urgent() const;
    bool is_empty() const;

    void add_result(JobResult result);
    /// wait  true: waits until there is a result.
    std::vector<JobResult> take_results(bool wait);

    /// The number of waiting checkpoints and running jobs, plus 1 while the storage thread works.
    std::atomic<std::size_t> unfinished = 1;

  private:
    // The caller of these functions must hold mutex_.
    /// Counts records that are added. Returns whether the storage thread must be woken.
    bool count(const std::vector<WaitingRecord>& records);
    void set_closing(RunNumber run, Closing closing);

    DiskState& disk_;
    mutable std::mutex mutex_; // guards the members below
    std::condition_variable changed_;
    HandedOver handed_over_;
    std::vector<JobResult> results_;
    // The times at which two records were added: the oldest one in handed_over_, and the oldest one that was taken but
    // is not written yet. They do not count the records with which a file is closed.
    std::optional<std::chrono::steady_clock::time_point> handed_over_since_, taken_since_;
    RunNumber last_number_ = 0;
    bool urgent_ = false;
    bool has_barrier_ = false; // in handed_over_
};

} // namespace evod::recording
