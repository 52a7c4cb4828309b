// Storage worker: the loop of the storage thread: which run is written when.
//
// A round takes what has been handed over, writes the records of all runs, those with a `done` first, and then does one
// background step. If commands wait, it skips the background step, at most eight times in a row.
//
// Owner        the storage thread, and used by it alone.
#pragma once

#include "server/recording/storage_thread.h"

#include <map>
#include <string>
#include <vector>

namespace evod::recording {

class StorageThread::Worker {
  public:
    explicit Worker(StorageThread& thread) : thread_{thread} {}

    /// Until the thread is to stop and everything that can be written is.
    void work();

  private:
    /// Waits for something to do, unless there is `more`, and takes what has come.
    ///
    /// returns  whether the server stops.
    bool take(bool more);
    void run_results();
    /// Whether a job is running, or something has been handed over and not taken.
    bool is_awaiting();
    bool commands_waiting();
    void start_job(RunLog& run, const std::function<std::function<void(RunLog&)>()>& job);
    void compress_next(RunLog& run);
    void copy_log_if_due(RunLog& run);

    /// Writes the records of all runs, until a command comes.
    ///
    /// returns  whether one has come.
    bool write_out();
    /// false: it failed, or has to wait for another run.
    bool write_out(RunLog& run);
    /// Runs with the same path use the name NAME.evod-next one after another, in the order of their creation: a run
    /// begins after the runs before it have ended or, if it replaces the last of them, after that one has its name.
    /// Writes the runs before it first. false: one of them is still in the way.
    bool is_its_turn(const RunLog& run);
    bool commit(RunLog& run, const std::vector<WaitingRecord>& records);
    bool take_name(RunLog& run);
    bool end(RunLog& run);
    /// One step for one run, of each in turn. Whether there was anything to do.
    bool background_step();
    bool background_step(RunLog& run);

    /// Records are on the disk: calls `done` and frees their memory.
    void report_written(std::vector<WaitingRecord>& records);
    bool fail(const base::Refusal& why);
    /// Logs for each run what could not be written.
    void report_lost();

    StorageThread& thread_;
    std::map<RunNumber, RunLog> runs_;
    RunNumber last_written_ = 0, last_background_ = 0; // the last runs that were served
    bool failed_ = false;                              // something, in this round
    bool advanced_ = false;                            // something has been written in this round
};

} // namespace evod::recording
