// BreedingQueries: answers GetBreeding. A job queue recomputes the breeding from the run file. Meanwhile the storage
// thread may write to that file.
//
// Owner        the dispatcher, on the network thread.
// Full         `at_once` queries run at the same time, at most one per session. Further queries wait in a queue.
//              The limit of unanswered requests per session also limits the length of the queue.
#pragma once

#include "server/jobs/job_queue.h"
#include "server/network/limits.h"
#include "server/network/session.h"
#include "server/runtime/mailbox.h"
#include "server/runtime/outbox.h"

#include <cstddef>
#include <deque>
#include <list>
#include <memory>
#include <stop_token>

namespace evod::network {

class BreedingQueries {
  public:
    static constexpr std::size_t at_once = 2;

    /// All arguments must outlive this object.
    BreedingQueries(runtime::Outbox& outbox, LimitCounters& limit_counters)
        : outbox_{outbox}, limit_counters_{limit_counters} {}

    /// Starts or queues the query. The session receives the answer later.
    void ask(Session& session, std::uint64_t request_id, const v1::GetBreeding& request, runtime::FoundRun run);
    /// Must be called when a session has ended.
    void forget(const Session& session);

  private:
    struct Asked {
        std::uint64_t session; // number of the session
        std::weak_ptr<Session> asking;
        std::uint64_t request_id;
        v1::GetBreeding request;
        runtime::FoundRun run;
    };
    struct Work {
        std::uint64_t session;
        std::stop_source stop;
    };

    void begin_next();
    void begin(Asked asked);
    /// Runs on a thread of the job queue.
    static v1::Response response_to(const Asked& asked, const std::stop_token& stop);

    runtime::Outbox& outbox_;
    LimitCounters& limit_counters_;
    std::deque<Asked> waiting_;
    std::list<Work> under_way_;
    jobs::JobQueue jobs_{{.name = "breeding", .threads_max = at_once}}; // last member, because its jobs use the rest
};

} // namespace evod::network
