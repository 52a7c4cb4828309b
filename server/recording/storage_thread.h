// Storage thread: writes the records of all runs to their files, with a group commit per file.
//
// records wait (record_queue.h) → one transaction per run → commit → gives the receipts: the records are on the disk
//
// Priorities     records with a ticket come first. Background writes are split into transactions of
//                `Options::part_bytes`; the thread serves pending commands between them. Three kinds of writes cannot
//                be split: the beginning of a generation, the outcome of a generation, and the creation or end of a
//                run.
// Checkpoints    come after the other records of all runs. A job compresses them; this thread writes them in parts. At
//                most one checkpoint per run waits. Its bytes are not counted. If the run ends, its waiting checkpoint
//                is dropped; if the server stops, the checkpoint is written first.
// Receipts       one sink receives the receipts of all records with tickets (receipt.h). A barrier is a ticket without
//                a record.
// Errors         a record that could not be written gets no receipt yet. The thread keeps the record. At intervals of
//                `retry_time` it opens the file again and writes all records that may be missing. Barriers do not wait
//                for that: they are refused. DiskState::trouble() returns the reason.
// File names     a moved or deleted file counts as an error of its run, because data written to it would be lost when
//                the server stops. The file stays open, so the error ends when the file is moved back. The thread
//                continues to write the other runs.
// Damage         if a file is damaged, the thread closes it, drops the records of its run, gives refused receipts for
//                them, and writes nothing to the file any more. DiskState::faults() returns the reason. The run remains
//                in the list until it is closed.
//
// Threads        only the simulation thread calls create(), write(), close() and so on. It never waits for the disk.
//                Run files belong to the storage thread.
#pragma once

#include "server/metrics/counters.h"
#include "server/recording/disk_state.h"
#include "server/recording/log_jobs.h"
#include "server/recording/record_queue.h"

#include <pthread.h>

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace evod::recording {

/// Durations. Any thread may read them.
struct StorageTimes {
    metrics::TimeHistogram journal_wait; // how long commands waited until they were on the disk
    metrics::TimeHistogram commit;       // duration of transactions, including the sync
};

class StorageThread {
  public:
    static constexpr std::chrono::milliseconds retry_time{250};

    explicit StorageThread(run_file::RunFile::Options options, std::chrono::milliseconds retry_after = retry_time);
    /// Calls finish().
    ~StorageThread();
    /// Writes everything that waits, if that is possible now, and ends the thread. An error in one run does not prevent
    /// writing the others.
    ///
    /// returns  false if something could not be written; the log contains the details.
    bool finish();

    /// Sets the function that receives all receipts. Must be called before the first record with a ticket is passed.
    void set_receipt_sink(ReceiptSink sink) { receipt_sink_ = std::move(sink); }

    /// Creates a run with a new file.
    ///
    /// command  the command that has begun the run.
    /// old      the run that the new one replaces.
    RunNumber create(const std::string& path, run_file::RunBeginning beginning,
                     std::optional<WaitingRecord> command = {}, std::optional<ReplacedRun> old = {});
    /// Continues a run whose file is already open.
    RunNumber adopt(std::unique_ptr<run_file::RunFile> file);
    /// Writes records in one transaction. A run must have at most one waiting checkpoint.
    void write(RunNumber run, std::vector<WaitingRecord> records) { queue_.add(run, std::move(records)); }
    /// Writes the last records of a run. Then its file is closed and renamed.
    void close(RunNumber run, Closing closing) { queue_.close(run, std::move(closing)); }

    /// Whether everything passed so far is written and no background work is left.
    bool idle() const { return disk_.waiting_bytes() == 0 && queue_.unfinished == 0; }
    /// The time at which the oldest waiting record was added; nullopt if none waits.
    std::optional<std::chrono::steady_clock::time_point> waiting_since() const { return queue_.waiting_since(); }
    DiskState& disk() { return disk_; }
    const StorageTimes& times() const { return times_; }
    /// Handles of the two threads, for reading their processor time.
    pthread_t handle() { return thread_.native_handle(); }
    pthread_t packing_handle() { return jobs_.handle(); }

  private:
    const run_file::RunFile::Options options_;
    DiskState disk_;
    RecordQueue queue_{disk_};
    LogJobs jobs_{queue_};
    StorageTimes times_; // the storage thread writes them
    ReceiptSink receipt_sink_ = [](const Receipt&) {};
    bool lost_ = false;  // something could not be written before the thread ended
    std::thread thread_; // last, because it uses all other members
};

} // namespace evod::recording
