#include "server/network/exports.h"

#include "server/network/limits.h"
#include "server/protocol/refusals.h"

#include <utility>

namespace evod::network {
namespace {

using base::RefusalCode;

v1::Response refused(std::uint64_t request_id, const base::Refusal& why) {
    return protocol::refusing(request_id, why);
}

} // namespace

void Exports::cancel(std::map<std::uint64_t, Export>::iterator of) {
    of->second.job->request_stop();
    cancelled_.push_back(std::move(of->second.job));
    exports_.erase(of);
}

void Exports::begin(Session& session, std::uint64_t request_id, const replay::StoredRun& run,
                    const replay::WantedTable& wanted) {
    if (const auto before = exports_.find(session.number()); before != exports_.end()) {
        cancel(before);
    }
    std::erase_if(cancelled_, [](const auto& job) { return job->finished(); });
    if (exports_.size() + cancelled_.size() >= exports_max) {
        limit_counters_.met(Limit::Exports);
        return session.answer(
            refused(request_id,
                    refusal(RefusalCode::ResourceExhausted,
                            std::to_string(exports_max) + " exports are already running: try again when one has ended",
                            base::Reason::ExportsMax)));
    }
    Export begun{++last_id_, std::make_unique<runtime::ExportJob>(jobs_, run, wanted)};
    ask(session, request_id, exports_.emplace(session.number(), std::move(begun)).first->second);
}

void Exports::send_next_part(Session& session, std::uint64_t request_id, const v1::ContinueExport& request) {
    const auto found = exports_.find(session.number());
    if (found == exports_.end() || found->second.id != request.export_id()) {
        return session.answer(
            refused(request_id, {.code = RefusalCode::NotFound,
                                 .message = "this session has no export with this id: start one with export_run",
                                 .violations = {{"continue_export.export_id", "the id of the running export",
                                                 std::to_string(request.export_id())}},
                                 .reason = base::Reason::ExportNotFound}));
    }
    if (found->second.asked) {
        return session.answer(
            refused(request_id, refusal(RefusalCode::FailedPrecondition,
                                        "the previous request for a part is not answered yet: wait for its answer",
                                        base::Reason::ExportEnded)));
    }
    ask(session, request_id, found->second);
}

void Exports::ask(Session& session, std::uint64_t request_id, Export& from) {
    from.asked = true;
    from.job->next([this, request_id, id = from.id, number = session.number(),
                    weak = session.weak_from_this()](base::Result<runtime::ExportJob::Part> part) {
        outbox_.answer([this, request_id, id, number, weak, part = std::move(part)]() mutable {
            if (!part && part.error().code == RefusalCode::FailedPrecondition) {
                limit_counters_.met(Limit::ExportPatience);
            }
            on_export_part(number, id, !part || part->last);
            const auto asking = weak.lock();
            if (!asking) {
                return;
            }
            if (!part) {
                return asking->answer(refused(request_id, protocol::with_paths(part.error(), "export_run")));
            }
            v1::Response response;
            response.set_request_id(request_id);
            v1::ExportPart& answer = *response.mutable_export_part();
            answer.set_export_id(id);
            answer.set_text(std::move(part->text));
            answer.set_last(part->last);
            answer.set_generations_left_out(part->generations_left_out);
            asking->answer(std::move(response));
        });
    });
}

void Exports::on_export_part(std::uint64_t session, std::uint64_t id, bool last) {
    const auto found = exports_.find(session);
    if (found == exports_.end() || found->second.id != id) {
        return; // the session has started another export in the meantime
    }
    found->second.asked = false;
    if (last) {
        cancel(found);
    }
}

void Exports::forget(const Session& session) {
    if (const auto found = exports_.find(session.number()); found != exports_.end()) {
        cancel(found);
    }
}

} // namespace evod::network
