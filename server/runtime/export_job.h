// Export job: writes a table of a run as text, in parts that the client requests one by one.
//
// Threads   a job queue runs it. The parts go through the outbox to the network thread. It reads the run file while the
//           server may write to it. Generations that the file does not retain are simulated on the thread of the job,
//           so no world waits for the export.
// Full      the job waits until a finished part is requested, and lets other jobs compute (job_turns.h). It
//           holds a database snapshot of the run file, so it ends after waiting for `patience`.
#pragma once

#include "server/jobs/job_queue.h"
#include "server/replay/run_tables.h"
#include "server/replay/stored_run.h"
#include "server/runtime/job_turns.h"
#include "server/runtime/outbox.h"

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>

namespace evod::runtime {

class ExportJob {
  public:
    static constexpr std::size_t part_bytes = 256 << 10;      // minimum size of each part except the last
    static constexpr std::size_t held_bytes = 2 * part_bytes; // memory of a running export: a part that waits
    static constexpr std::chrono::milliseconds patience = std::chrono::seconds{30};

    struct Tools {
        jobs::JobQueue& jobs; // must have a free thread, because each export occupies a thread while it waits
        JobTurns& turns;
        Outbox& outbox; // receives the parts
    };
    /// tools  must outlive the job.
    /// user   whose account pays for the time of the job.
    ExportJob(const Tools& tools, const std::string& user, replay::StoredRun run, const replay::WantedTable& wanted,
              std::chrono::milliseconds patience_time = patience);
    /// Cancels the job and waits until it has ended.
    ~ExportJob();

    /// Requests the next part. The previous request must have been answered. Refused after the last part and after a
    /// refusal. The part or the refusal goes into the outbox.
    void next(const PartRequest& request);

    /// Cancels the job.
    ///
    /// why  the answer to the request for a part, if one waits.
    void cancel(const base::Refusal& why);
    /// Whether the job has ended.
    bool finished();

  private:
    class PartBuffer;

    void work(const std::stop_token& stop);
    base::Result<void> write(JobTurns::Turn& turn, const std::stop_token& stop);
    /// Answers the last request for a part, if there is one, with the reason why no part comes.
    void end(const base::Result<void>& written, const std::stop_token& stop);
    /// Waits until a part is requested and returns it to the client. Returns false if no request arrives within
    /// `patience`, or if the job is cancelled.
    bool give(ExportPart part, JobTurns::Turn& turn, const std::stop_token& stop);

    const Tools tools_;
    const std::string user_;
    const replay::StoredRun run_;
    const replay::WantedTable wanted_;
    const std::chrono::milliseconds patience_;
    std::uint64_t generations_left_out_ = 0;
    std::string text_; // text of the next part

    std::mutex mutex_; // guards the members below
    std::condition_variable_any changed_;
    std::optional<PartRequest> request_; // nullopt: no part is requested
    base::Refusal cancelled_;            // why the job is cancelled
    bool over_ = false;                  // no more parts will be returned
    bool finished_ = false;
    std::stop_source stop_; // last member, because initialising it starts the job, which uses the other members
};

} // namespace evod::runtime
