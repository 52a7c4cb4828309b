// Background queries: exports, GetBreeding and the checks of new forks, which job queues compute from run files. Meanwhile
// the storage thread may write to these files.
//
// Owner        the dispatcher, on the network thread. The jobs return their results through the outbox.
// Full         while exports_max exports are running, a new export is refused. A session has at most one export.
//              breedings_at_once GetBreeding run at the same time, at most one per session. Further ones wait in a queue.
//              The limit of unanswered requests per session also limits the length of the queue.
#pragma once

#include "server/jobs/job_queue.h"
#include "server/network/limits.h"
#include "server/network/session.h"
#include "server/runtime/export_job.h"
#include "server/runtime/outbox.h"

#include <cstddef>
#include <deque>
#include <map>
#include <memory>
#include <stop_token>
#include <vector>

namespace evod::network {

class BackgroundQueries {
  public:
    static constexpr std::size_t breedings_at_once = 2;

    /// All arguments must outlive this object.
    BackgroundQueries(runtime::Outbox& outbox, const Sessions& sessions, LimitCounters& limit_counters)
        : outbox_{outbox}, sessions_{sessions}, limit_counters_{limit_counters} {}

    /// Starts an export and answers the request with the first part. Cancels the session's previous export.
    void begin_export(Session& session, std::uint64_t request_id, const replay::StoredRun& run,
                      const replay::WantedTable& wanted);
    /// Answers the request with the next part.
    void send_next_part(Session& session, std::uint64_t request_id, const v1::ContinueExport& request);
    /// Starts or queues a GetBreeding. The session receives the answer later.
    void ask_breeding(Session& session, const v1::Request& request, runtime::FoundRun run);

    /// Reads the file of a new fork back. The result is the answer to the command that created it.
    void check_fork(runtime::CommandDone done);

    // Must be called with the results of the jobs. They send the answers, if the sessions still exist.
    void on_done(runtime::ExportPartDone done);
    void on_done(runtime::BreedingDone done);

    /// Must be called when a session has ended. Cancels its export and its GetBreeding.
    void forget(const Session& session);

  private:
    struct Export {
        std::uint64_t id;
        std::unique_ptr<runtime::ExportJob> job;
        bool asked = false; // the client has requested the next part and has not received it yet
    };
    using Exports = std::map<std::uint64_t, Export>; // key: number of the session

    void ask(const Session& session, std::uint64_t request_id, Export& from);
    void cancel(Exports::iterator of);

    /// A GetBreeding that waits until it may start.
    struct WaitingBreeding {
        std::uint64_t session; // number of the session
        std::uint64_t request_id;
        v1::GetBreeding request;
        runtime::FoundRun run;
        std::ptrdiff_t bytes; // memory of the request
    };
    struct RunningBreeding {
        std::uint64_t session; // number of the session
        std::ptrdiff_t bytes;  // memory of the request
        std::stop_source stop;
    };
    void begin_next_breeding();
    void begin(WaitingBreeding breeding);
    /// Runs on a thread of the job queue.
    static runtime::BreedingDone compute(std::uint64_t query, const WaitingBreeding& breeding,
                                         const std::stop_token& stop);

    runtime::Outbox& outbox_;
    const Sessions& sessions_;
    LimitCounters& limit_counters_;

    jobs::JobQueue export_jobs_{{.name = "export", .threads_max = exports_max}}; // must outlive the exports
    Exports exports_;
    std::vector<std::unique_ptr<runtime::ExportJob>> cancelled_; // cancelled exports whose jobs are still finishing
    std::uint64_t last_export_id_ = 0;

    jobs::JobQueue breeding_jobs_{{.name = "breeding", .threads_max = breedings_at_once}};
    std::deque<WaitingBreeding> waiting_breedings_;
    std::map<std::uint64_t, RunningBreeding> running_breedings_; // key: number of the query
    std::uint64_t last_query_ = 0;

    jobs::JobQueue fork_jobs_{{.name = "fork check"}};
};

} // namespace evod::network
