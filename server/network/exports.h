// Exports: sends tables of stored runs to clients, at most one export per session at a time.
//
// Owner        the dispatcher, on the network thread. A job queue produces the parts (runtime/export_job.h).
// Full         while exports_max exports are running, a new export is refused.
#pragma once

#include "server/network/session.h"
#include "server/runtime/export_job.h"
#include "server/runtime/outbox.h"

#include <map>
#include <memory>
#include <vector>

namespace evod::network {

class Exports {
  public:
    /// All arguments must outlive this object.
    Exports(runtime::Outbox& outbox, LimitCounters& limit_counters)
        : outbox_{outbox}, limit_counters_{limit_counters} {}

    /// Starts an export and answers the request with the first part. Cancels the session's previous export.
    void begin(Session& session, std::uint64_t request_id, const replay::StoredRun& run,
               const replay::WantedTable& wanted);
    /// Answers the request with the next part.
    void send_next_part(Session& session, std::uint64_t request_id, const v1::ContinueExport& request);
    /// Must be called when a session has ended.
    void forget(const Session& session);

  private:
    struct Export {
        std::uint64_t id;
        std::unique_ptr<runtime::ExportJob> job;
        bool asked = false; // the client has requested the next part and has not received it yet
    };

    void ask(Session& session, std::uint64_t request_id, Export& from);
    /// The network thread calls this function when the job has produced a part or a refusal.
    ///
    /// last  true: the export has ended.
    void on_export_part(std::uint64_t session, std::uint64_t id, bool last);
    void cancel(std::map<std::uint64_t, Export>::iterator of);

    runtime::Outbox& outbox_;
    LimitCounters& limit_counters_;
    std::uint64_t last_id_ = 0;
    jobs::JobQueue jobs_{{.name = "export", .threads_max = exports_max}}; // must outlive the exports
    std::map<std::uint64_t, Export> exports_;                             // key: number of the session
    std::vector<std::unique_ptr<runtime::ExportJob>> cancelled_; // cancelled exports whose jobs are still finishing
};

} // namespace evod::network
