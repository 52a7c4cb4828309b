// Waiting record: a record on its way from the simulation thread to a run file.
#pragma once

#include "server/run_file/run_file.h"

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace evod::recording {

using Record = run_file::RunFile::Record;

/// Called on the storage thread once the record is on the disk.
using Done = std::function<void()>;

/// The state of a run's checkpoint, shared with the recorder.
struct CheckpointWriting {
    std::atomic<bool> waits = false;                                          // to be written
    std::atomic<std::chrono::nanoseconds> took = std::chrono::nanoseconds{0}; // compressing and writing the last one
};

struct WaitingRecord {
    std::optional<Record> record; // nothing: only `done` waits
    Done done = {};
    std::shared_ptr<CheckpointWriting> writing = {}; // of a checkpoint
    std::size_t bytes = 0;
    std::chrono::steady_clock::time_point handed_over = {}; // with `done` only
    std::chrono::nanoseconds took{0};                       // of a checkpoint: compressing and writing it
    bool being_compressed = false;                          // `record` is an empty Checkpoint meanwhile
};

/// About how much memory a record takes; 0 for checkpoints, which have a bound of their own.
std::size_t bytes_of(const Record& record);

/// How a run's file is closed.
struct Closing {
    std::vector<WaitingRecord> last; // its last record is the end mark
    std::string renamed;             // the file's new path; empty: it stays
    bool replaced = false;           // wait until the run that takes its place allows it
    bool marked = false, finished = false;
};

} // namespace evod::recording
