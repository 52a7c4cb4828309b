// Export job: writes a table of a run as text, in parts that the client requests one by one.
//
// Threads   a job queue runs it. The parts go through the outbox to the network thread. It reads the run file while the server may write to it. Generations that the file does
//           not retain are simulated on the thread of the job, so no world waits for the export.
// Full      the job waits until a finished part is requested. It holds a database snapshot of the run file meanwhile,
//           so it ends after waiting for `patience`.
#pragma once

#include "server/jobs/job_queue.h"
#include "server/replay/run_tables.h"
#include "server/replay/stored_run.h"
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

    /// jobs    must outlive the job and have a free thread, because each export occupies a thread while it waits.
    /// outbox  receives the parts. Must outlive the job.
    ExportJob(jobs::JobQueue& jobs, Outbox& outbox, replay::StoredRun run, const replay::WantedTable& wanted,
              std::chrono::milliseconds patience_time = patience);
    /// Cancels the job and waits until it has ended.
    ~ExportJob();

    /// Requests the next part. The previous request must have been answered. Refused after the last part and after a
    /// refusal. The part or the refusal goes into the outbox.
    void next(const PartRequest& request);

    /// Cancels the job.
    void request_stop() { stop_.request_stop(); }
    /// Whether the job has ended.
    bool finished();

  private:
    class PartBuffer;

    void work(const std::stop_token& stop);
    base::Result<void> write(const std::stop_token& stop);
    /// Waits until a part is requested and returns it to the client. Returns false if no request arrives within
    /// `patience`.
    bool give(ExportPart part, const std::stop_token& stop);

    Outbox& outbox_;
    const replay::StoredRun run_;
    const replay::WantedTable wanted_;
    const std::chrono::milliseconds patience_;
    std::uint64_t generations_left_out_ = 0;
    std::string text_; // text of the next part

    std::mutex mutex_; // guards the members below
    std::condition_variable_any changed_;
    std::optional<PartRequest> request_; // nullopt: no part is requested
    bool over_ = false;                  // no more parts will be returned
    bool finished_ = false;
    std::stop_source stop_; // last member, because initialising it starts the job, which uses the other members
};

} // namespace evod::runtime
