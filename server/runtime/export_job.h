// Export job: writes a table of a run, in parts that the client requests one by one.
//
// Threads   a job queue runs it. It reads the run's file while a server writes to it, and simulates alone what the file
//           does not retain; no world waits for it.
// Full      it waits with a part that has not been requested. Meanwhile it keeps a snapshot of the file, so it ends after
//           `patience`.
#pragma once

#include "server/jobs/job_queue.h"
#include "server/replay/run_tables.h"
#include "server/replay/stored_run.h"

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <stop_token>
#include <string>

namespace evod::runtime {

class ExportJob {
  public:
    static constexpr std::size_t part_bytes = 256 << 10; // at least, of all parts but the last
    static constexpr std::chrono::milliseconds patience = std::chrono::seconds{30};

    struct Part {
        std::string text;
        bool last = false;                      // of the table
        std::uint64_t generations_left_out = 0; // replay::generations_out_of_reach(), of organisms or their lineage
    };
    /// Called on the job's thread; must not block.
    using Reply = std::function<void(base::Result<Part>)>;

    /// jobs  outlives this and has a free thread; each export waits on one.
    ExportJob(jobs::JobQueue& jobs, replay::StoredRun run, const replay::WantedTable& wanted,
              std::chrono::milliseconds patience_time = patience);
    /// Cancels the job and waits for its end.
    ~ExportJob();

    /// Requests the next part, after the reply to the request before. After the last part and after a refusal: refused.
    void next(Reply reply);

    /// Cancels the job.
    void request_stop() { stop_.request_stop(); }
    /// Whether the job has ended.
    bool finished();

  private:
    class PartBuffer;

    void work(const std::stop_token& stop);
    base::Result<void> write(const std::stop_token& stop);
    /// Replies with a part, once it is requested; false if it is not within the patience.
    bool give(Part part, const std::stop_token& stop);

    const replay::StoredRun run_;
    const replay::WantedTable wanted_;
    const std::chrono::milliseconds patience_;
    std::uint64_t generations_left_out_ = 0;
    std::string text_; // of the next part

    std::mutex mutex_; // guards what follows
    std::condition_variable_any changed_;
    Reply reply_;       // to the request under way
    bool over_ = false; // there are no more parts
    bool finished_ = false;
    std::stop_source stop_; // last: the job begins with it, and uses the rest
};

} // namespace evod::runtime
