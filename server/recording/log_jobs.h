// Log jobs: the background jobs of the run logs. They compress checkpoints and copy write-ahead logs.
//
// Owner        the storage thread.
// Threads      a job queue. The results come back through the record queue.
#pragma once

#include "server/jobs/job_queue.h"
#include "server/recording/record_queue.h"

#include <pthread.h>

#include <functional>
#include <map>

namespace evod::recording {

class LogJobs {
  public:
    /// The queue must outlive this object.
    explicit LogJobs(RecordQueue& queue) : queue_{queue} {}

    void compress_next(RunLog& run);
    void copy_log_if_due(RunLog& run);
    bool are_running() const { return running_count_ > 0; }
    /// Passes the results of jobs that have ended to their runs.
    ///
    /// wait  true: waits until there is a result.
    void apply_results(std::map<RunNumber, RunLog>& runs, bool wait);
    /// Returns the handle of the thread of the job queue, for reading its CPU time.
    pthread_t handle() { return jobs_.handle(); }

  private:
    void start(const RunLog& run, std::function<decltype(JobResult::result)()> job);

    RecordQueue& queue_;
    std::size_t running_count_ = 0;
    jobs::JobQueue jobs_{{.name = "packing", .niceness = 10}}; // its jobs use the members above
};

} // namespace evod::recording
