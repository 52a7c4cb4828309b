// Waiting record: a record between the simulation thread, which produced it, and the run file.
#pragma once

#include "server/recording/receipt.h"
#include "server/run_file/run_file.h"

#include <atomic>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace evod::recording {

using Record = run_file::RunFile::Record;

/// The progress of a checkpoint. The storage thread and the recorder share it.
struct CheckpointWriting {
    std::atomic<bool> waits = false; // the checkpoint still has to be written
    // Time for compressing and writing the last checkpoint.
    std::atomic<std::chrono::nanoseconds> took = std::chrono::nanoseconds{0};
};

struct WaitingRecord {
    std::optional<Record> record; // nullopt: a barrier, whose receipt reports that all earlier records are on the disk
    Ticket ticket = 0;
    std::shared_ptr<CheckpointWriting> writing = {}; // only for a checkpoint
    std::size_t bytes = 0;
    std::chrono::steady_clock::time_point handed_over = {}; // time of the hand-over, only for a record with a ticket
    std::chrono::nanoseconds took{0};                       // time for compressing and writing a checkpoint
    bool being_compressed = false; // a job compresses the checkpoint; `record` is an empty Checkpoint

    bool is_barrier() const { return !record && ticket != 0; }
};

/// The approximate memory that a record takes. Returns 0 for checkpoints, which have a limit of their own.
std::size_t bytes_of(const Record& record);

/// The number of a world's ended runs whose files may not have been renamed yet. The storage thread and the recorder share
/// it.
using Leaving = std::atomic<std::size_t>;

/// How the file of a run is closed.
struct Closing {
    std::vector<WaitingRecord> last;       // the last of these records is the end mark
    std::string renamed;                   // the new path of the file; empty: the file keeps its name
    std::shared_ptr<Leaving> leaving = {}; // decremented when the file has its new name
    bool replaced = false;                 // true: wait until the run that replaces this one is committed
    bool marked = false;                   // the end mark is committed
    bool finished = false;                 // the file is closed and, if requested, renamed
};

} // namespace evod::recording
