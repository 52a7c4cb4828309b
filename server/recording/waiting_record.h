// Waiting record: a record between the simulation thread, which produced it, and the run file.
#pragma once

#include "server/recording/receipt.h"
#include "server/run_file/run_file.h"

#include <atomic>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace evod::recording {

using Record = run_file::RunFile::Record;

/// The progress of a checkpoint. The storage thread and the recorder share it.
struct CheckpointWriting {
    std::atomic<bool> waits = false; // the checkpoint still has to be written
    // Time for compressing and writing the last checkpoint.
    std::atomic<std::chrono::nanoseconds> took = std::chrono::nanoseconds{0};
};

/// The approximate memory that a record takes. Returns 0 for checkpoints, which have a limit of their own.
std::size_t bytes_of(const Record& record);

struct WaitingRecord {
    using Clock = std::chrono::steady_clock;

    explicit WaitingRecord(Record of, Ticket of_receipt = 0)
        : record{std::move(of)}, ticket{of_receipt}, bytes{bytes_of(*record)} {}
    /// A barrier: its receipt reports that all earlier records are on the disk.
    explicit WaitingRecord(Ticket of_barrier) : ticket{of_barrier} {}

    bool is_barrier() const { return !record; }

    std::optional<Record> record; // nullopt: a barrier
    Ticket ticket;
    std::size_t bytes = 0;
    Clock::time_point since = Clock::now();          // time of the hand-over
    std::shared_ptr<CheckpointWriting> writing = {}; // only for a checkpoint
    std::chrono::nanoseconds took{0};                // time for compressing and writing a checkpoint
    bool being_compressed = false;                   // a job compresses the checkpoint; `record` is an empty Checkpoint
};

std::size_t bytes_of(const std::vector<WaitingRecord>& records);

/// The number of a world's ended runs whose files may not have been renamed yet. The storage thread and the recorder
/// share it.
using Leaving = std::atomic<std::size_t>;

/// How the file of a run is closed.
struct Closing {
    std::vector<WaitingRecord> last = {};  // the last of these records is the end mark; a damaged file gets none
    std::string renamed = {};              // the new path of the file; empty: the file keeps its name
    std::shared_ptr<Leaving> leaving = {}; // decremented when the file has its new name
    bool replaced = false;                 // true: wait until the run that replaces this one is committed
    bool marked = false;                   // the end mark is committed
    bool finished = false;                 // the file is closed and, if requested, renamed

    /// Whether the run has ended, so that no server continues it.
    bool ends_run() const;
};

} // namespace evod::recording
