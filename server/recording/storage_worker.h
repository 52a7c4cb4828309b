// Storage worker: the loop of the storage thread. It decides in which order the runs are written.
//
// In each round, it takes all new records, writes the records of all runs, those with a ticket first, and then does one
// background step. While commands wait, it skips the background step, but at most eight times in succession.
//
// Owner        the storage thread. No other thread uses it.
#pragma once

#include "server/recording/storage_thread.h"

#include <chrono>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace evod::recording {

class StorageWorker {
  public:
    StorageWorker(RecordQueue& queue, DiskState& disk, LogJobs& jobs, StorageTimes& times, const ReceiptSink& receipts,
                  std::chrono::milliseconds retry_after)
        : queue_{queue}, disk_{disk}, jobs_{jobs}, times_{times}, receipts_{receipts}, retry_after_{retry_after} {}

    /// Runs until the thread must stop and everything that can be written is written.
    ///
    /// returns  false if something could not be written; the log contains the details.
    bool work();

  private:
    /// Takes the new records and results. Waits for work first, unless `more` is set. After a failed write, waits until
    /// the next attempt is due, and refuses barriers.
    ///
    /// returns  whether the server stops.
    bool take(bool more);
    /// Passes the records that were taken to their runs.
    void distribute(HandedOver& taken);

    /// Writes the records of all runs, until a command arrives.
    ///
    /// returns  whether a command has arrived.
    bool write_records();
    /// Writes the records of one run. Returns false after an error, or if the run must wait for another one.
    bool write_records(RunLog& run);
    /// Whether a run may use the name NAME.evod-next. Runs with the same path use this name one after another, in the
    /// order of their creation. A run may begin when all earlier runs have ended. If it replaces the last of them, it
    /// may begin when the file of that run has its final name. Writes the earlier runs first. Returns false if one
    /// of them still uses the name.
    bool is_its_turn(RunLog& run);
    bool commit(RunLog& run, const std::vector<WaitingRecord>& records);
    bool rename_to_final_name(RunLog& run);
    bool end(RunLog& run);
    /// Deletes old runs of the world whose run has just ended, if the limits say so.
    void prune(const RunLog& ended);
    /// Fails if the folder contains more than the limits allow.
    void check_quota();
    /// Ends a run whose file is damaged. A deleted world's file gets its final name, so that the name of the world is
    /// free.
    bool end_damaged(RunLog& run);
    /// Marks a run as ended, after its file has been closed and renamed.
    void finish(Closing& closing);
    /// Does one background step for one run; the runs take turns. Returns whether there was any work.
    bool background_step();
    bool background_step(RunLog& run);

    /// Gives the receipts of records that are on the disk, or will not be written, and frees the memory of the records.
    ///
    /// refused  why they will not be written; nullopt: they are on the disk.
    void release(std::vector<WaitingRecord>& records, const std::optional<base::Refusal>& refused = {});
    /// Refuses the barriers of the runs whose records cannot be written now.
    void refuse_barriers();
    void refuse_records_of_damaged(RunLog& run);
    /// Handles a failed write that concerns all runs.
    void fail(const base::Refusal& why);
    /// Handles a failed write of a run's file. Returns false.
    bool fail(RunLog& run, const base::Refusal& why);
    void give_up(RunLog& run, const base::Refusal& why);
    /// Keeps the old run of a world, because the file of the run that should replace it cannot be created.
    void keep_old_run(RunLog& replacement);

    RecordQueue& queue_;
    DiskState& disk_;
    LogJobs& jobs_;
    StorageTimes& times_;
    const ReceiptSink& receipts_;
    const std::chrono::milliseconds retry_after_;
    std::map<RunNumber, RunLog> runs_;
    RunNumber last_written_ = 0, last_background_ = 0; // the last runs that were served
    std::optional<base::Refusal> failure_;             // the first write that has failed in this round
    std::chrono::steady_clock::time_point quota_checked_ = {};
    bool is_over_quota_ = false;
    bool advanced_ = false; // something has been written in this round
    bool lost_ = false;     // the last records of a run were lost, because its file is damaged
};

} // namespace evod::recording
