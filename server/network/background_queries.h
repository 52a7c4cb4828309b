// Background queries: exports, GetBreeding and the checks of new forks, which job queues compute from run files.
// Meanwhile the storage thread may write to these files.
//
// Users        a user has at most half of the exports and of the GetBreeding that run at once (base/quota.h), whatever
//              number of sessions the user has. All jobs together compute on few processors, at a low priority, and the
//              users get equal parts of that time (runtime/job_turns.h).
// Owner        the dispatcher, on the network thread. The jobs return their results through the outbox.
// Full         a session has at most one export. While exports_max exports are running, a new one is refused, or takes
//              the place of the oldest export of the user with the most.
//              A session has at most one running GetBreeding. Further ones wait in a queue, which serves users in turn.
//              While all places are taken, the last GetBreeding of the user with the most may have to begin again
//              later. Above breedings_waiting_max waiting GetBreeding of a user, further ones are refused.
#pragma once

#include "server/base/fair_queue.h"
#include "server/base/quota.h"
#include "server/jobs/job_queue.h"
#include "server/network/limits.h"
#include "server/network/session.h"
#include "server/runtime/export_job.h"
#include "server/runtime/outbox.h"

#include <chrono>
#include <cstddef>
#include <map>
#include <memory>
#include <stop_token>
#include <string>
#include <vector>

namespace evod::network {

class BackgroundQueries {
  public:
    /// All references must outlive this object.
    BackgroundQueries(runtime::Outbox& outbox, runtime::JobTurns& turns, const Sessions& sessions,
                      LimitCounters& limit_counters,
                      std::chrono::milliseconds export_patience = runtime::ExportJob::patience)
        : outbox_{outbox}
        , turns_{turns}
        , sessions_{sessions}
        , limit_counters_{limit_counters}
        , export_patience_{export_patience} {}

    /// Cancels everything, so that no job waits for its client while another one is awaited.
    ~BackgroundQueries();

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

    /// The places of exports, by user.
    const base::Quota& exports() {
        give_abandoned_places_back();
        return export_quota_;
    }
    /// The places of GetBreeding that run, by user.
    const base::Quota& breedings() const { return breeding_quota_; }
    /// The number of cancelled exports whose jobs have not ended.
    std::size_t cancelled_count();

  private:
    /// Memory that is counted for a session as long as this object exists.
    class HeldMemory {
      public:
        HeldMemory(Session& session, std::size_t bytes)
            : session_{session.weak_from_this()}, bytes_{static_cast<std::ptrdiff_t>(bytes)} {
            session.requests.expect(bytes_);
        }
        HeldMemory(const HeldMemory&) = delete;
        ~HeldMemory() {
            if (const SessionPtr session = session_.lock()) {
                session->requests.expect(-bytes_);
            }
        }

      private:
        std::weak_ptr<Session> session_;
        std::ptrdiff_t bytes_;
    };
    struct Export {
        std::uint64_t id;
        std::string user;
        std::unique_ptr<runtime::ExportJob> job; // nullptr: another user has got the place
        std::unique_ptr<HeldMemory> held;        // of the job
        bool part_requested = false;             // the client has requested the next part and has not received it yet
        bool has_place = true;                   // it counts in the pool
    };
    using Exports = std::map<std::uint64_t, Export>; // key: number of the session
    struct CancelledExport {
        std::string user;
        std::unique_ptr<runtime::ExportJob> job;
    };

    void ask(const Session& session, std::uint64_t request_id, Export& from);
    /// Cancels the job of an export, and gives its place back.
    void cancel(Export& of, const base::Refusal& why);
    void give_place_back(Export& of);
    /// Gives the places back of exports whose clients have requested no part in time.
    void give_abandoned_places_back();
    /// Takes a place in the pool of exports. Returns the reason if the user can have none.
    base::Result<void> take_export_place(const std::string& user);
    /// Cancels the oldest export of the user with the most.
    void take_back_export();

    /// A GetBreeding that has not been answered.
    struct Breeding {
        std::uint64_t session; // number of the session
        std::string user;
        std::uint64_t request_id;
        v1::GetBreeding request;
        runtime::FoundRun run;
        std::ptrdiff_t bytes; // memory of the request
    };
    using BreedingPtr = std::shared_ptr<const Breeding>;
    struct RunningBreeding {
        BreedingPtr breeding;
        std::stop_source stop;
        bool is_taken_back = false;
    };
    bool may_begin(const Breeding& breeding) const;
    void begin_next_breeding();
    void begin(BreedingPtr breeding);
    /// Cancels the GetBreeding that began last, of those of the user with the most. It begins again later.
    void take_back_breeding();
    /// Runs on a thread of the job queue.
    static runtime::BreedingDone compute(std::uint64_t query, const Breeding& breeding, const base::StopCheck& stop);

    runtime::Outbox& outbox_;
    runtime::JobTurns& turns_;
    const Sessions& sessions_;
    LimitCounters& limit_counters_;
    const std::chrono::milliseconds export_patience_;

    base::Quota export_quota_{exports_max};
    jobs::JobQueue export_jobs_{
        {.name = "export", .threads_max = exports_max, .niceness = runtime::JobTurns::niceness}};
    Exports exports_;
    std::vector<CancelledExport> cancelled_; // their jobs are still finishing
    std::uint64_t last_export_id_ = 0;

    base::Quota breeding_quota_{breedings_max};
    jobs::JobQueue breeding_jobs_{
        {.name = "breeding", .threads_max = breedings_max, .niceness = runtime::JobTurns::niceness}};
    base::FairQueue<BreedingPtr> waiting_breedings_;
    std::map<std::uint64_t, RunningBreeding> running_breedings_; // key: number of the query
    std::uint64_t last_query_ = 0;

    jobs::JobQueue fork_jobs_{{.name = "fork check", .niceness = runtime::JobTurns::niceness}};
};

} // namespace evod::network
