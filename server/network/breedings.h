// Breedings: how generations were bred, on its way to those who have asked. A job queue works them
// out: a job reads the run's file while the server writes to it.
//
// Owner     the dispatcher; on the network thread.
// Full      at_once are worked out at a time, one of a session; the others wait for their turn, as many as sessions may
//           have unanswered.
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

class Breedings {
  public:
    static constexpr std::size_t at_once = 2;

    /// Everything handed in outlives this.
    Breedings(runtime::Outbox& outbox, LimitCounters& limit_counters)
        : outbox_{outbox}, limit_counters_{limit_counters} {}

    /// Answers the request, sooner or later.
    void ask(Session& session, std::uint64_t request_id, const v1::GetBreeding& request, runtime::FoundRun run);
    /// The session has ended.
    void forget(const Session& session);

  private:
    struct Asked {
        std::uint64_t session; // number
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
    /// On a thread of the job queue.
    static v1::Response response_to(const Asked& asked, const std::stop_token& stop);

    runtime::Outbox& outbox_;
    LimitCounters& limit_counters_;
    std::deque<Asked> waiting_;
    std::list<Work> under_way_;
    jobs::JobQueue jobs_{{.name = "breeding", .threads_max = at_once}}; // last: its jobs use the rest
};

} // namespace evod::network
