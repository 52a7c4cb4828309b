#include "server/network/background_queries.h"

#include "server/base/within_memory.h"
#include "server/protocol/breeding.h"
#include "server/protocol/refusals.h"
#include "server/replay/breeding.h"
#include "server/runtime/fork_check.h"
#include "server/runtime/worker_pool.h"

#include <algorithm>
#include <memory>
#include <utility>

namespace evod::network {
namespace {

using base::RefusalCode;

base::Result<replay::Bred> breeding_of(const v1::GetBreeding& request, const runtime::FoundRun& run,
                                       const std::stop_token& stop) {
    const auto file = run.run.open();
    if (!file) {
        return file.error();
    }
    if (auto held = (*file)->pin_snapshot(); !held) {
        return held.error();
    }
    replay::WantedBreeding wanted{.generation = {},
                                  .seen_from = run.generation,
                                  .island = request.island(),
                                  .rows = protocol::wanted_rows(request)};
    if (request.has_generation()) {
        wanted.generation = request.generation();
    }
    const auto executor = runtime::make_executor(1);
    return replay::breeding_of(**file, wanted, *executor, stop);
}

/// Whether the answer omits rows because of a limit.
bool is_shortened(const v1::GetBreeding& request, const v1::Breeding& answer) {
    const auto more = [](std::uint64_t first, int rows, std::uint32_t count) {
        return first + static_cast<std::uint64_t>(rows) < count;
    };
    return more(request.first_contender(), answer.contenders_size(), answer.contender_count()) ||
           more(request.first_pick(), answer.picks_size(), answer.pick_count()) ||
           more(request.first_descendant(), answer.descendants_size(), answer.descendant_count());
}

} // namespace

// ---- exports ---------------------------------------------------------------------------------------------------

void BackgroundQueries::begin_export(Session& session, std::uint64_t request_id, const replay::StoredRun& run,
                                     const replay::WantedTable& wanted) {
    if (const auto before = exports_.find(session.number()); before != exports_.end()) {
        cancel(before);
    }
    std::erase_if(cancelled_, [](const auto& job) { return job->finished(); });
    if (exports_.size() + cancelled_.size() >= exports_max) {
        limit_counters_.met(Limit::Exports);
        return session.answer(protocol::refusing(
            request_id,
            refusal(RefusalCode::ResourceExhausted,
                    std::to_string(exports_max) + " exports are already running: try again when one has ended",
                    base::Reason::ExportsMax)));
    }
    session.requests.expect(static_cast<std::ptrdiff_t>(runtime::ExportJob::held_bytes));
    Export begun{++last_export_id_, std::make_unique<runtime::ExportJob>(export_jobs_, outbox_, run, wanted)};
    ask(session, request_id, exports_.emplace(session.number(), std::move(begun)).first->second);
}

void BackgroundQueries::send_next_part(Session& session, std::uint64_t request_id, const v1::ContinueExport& request) {
    const auto found = exports_.find(session.number());
    if (found == exports_.end() || found->second.id != request.export_id()) {
        return session.answer(protocol::refusing(
            request_id, {.code = RefusalCode::NotFound,
                         .message = "this session has no export with this id: start one with export_run",
                         .violations = {{"continue_export.export_id", "the id of the running export",
                                         std::to_string(request.export_id())}},
                         .reason = base::Reason::ExportNotFound}));
    }
    if (found->second.asked) {
        return session.answer(protocol::refusing(
            request_id, refusal(RefusalCode::FailedPrecondition,
                                "the previous request for a part is not answered yet: wait for its answer",
                                base::Reason::ExportEnded)));
    }
    ask(session, request_id, found->second);
}

void BackgroundQueries::ask(const Session& session, std::uint64_t request_id, Export& from) {
    from.asked = true;
    from.job->next({.session = session.number(), .request_id = request_id, .export_id = from.id});
}

void BackgroundQueries::cancel(Exports::iterator of) {
    if (const SessionPtr session = find_session(sessions_, of->first)) {
        session->requests.expect(-static_cast<std::ptrdiff_t>(runtime::ExportJob::held_bytes));
    }
    of->second.job->request_stop();
    cancelled_.push_back(std::move(of->second.job));
    exports_.erase(of);
}

void BackgroundQueries::on_done(runtime::ExportPartDone done) {
    const runtime::PartRequest& request = done.request;
    if (!done.part && done.part.error().code == RefusalCode::FailedPrecondition) {
        limit_counters_.met(Limit::ExportPatience);
    }
    // The session may have started another export in the meantime.
    if (const auto found = exports_.find(request.session);
        found != exports_.end() && found->second.id == request.export_id) {
        found->second.asked = false;
        if (!done.part || done.part->last) {
            cancel(found);
        }
    }
    const SessionPtr session = find_session(sessions_, request.session);
    if (!session) {
        return;
    }
    if (!done.part) {
        return session->answer(
            protocol::refusing(request.request_id, protocol::with_paths(done.part.error(), "export_run")));
    }
    v1::Response response;
    response.set_request_id(request.request_id);
    v1::ExportPart& answer = *response.mutable_export_part();
    answer.set_export_id(request.export_id);
    answer.set_text(std::move(done.part->text));
    answer.set_last(done.part->last);
    answer.set_generations_left_out(done.part->generations_left_out);
    session->answer(std::move(response));
}

// ---- GetBreeding -----------------------------------------------------------------------------------------------

void BackgroundQueries::ask_breeding(Session& session, const v1::Request& request, runtime::FoundRun run) {
    const auto bytes = static_cast<std::ptrdiff_t>(sizeof(WaitingBreeding) + request.SpaceUsedLong());
    session.requests.expect(bytes);
    waiting_breedings_.push_back(
        {session.number(), request.request_id(), request.get_breeding(), std::move(run), bytes});
    begin_next_breeding();
}

void BackgroundQueries::begin_next_breeding() {
    while (running_breedings_.size() < breedings_at_once) {
        const auto next = std::ranges::find_if(waiting_breedings_, [&](const WaitingBreeding& breeding) {
            return std::ranges::none_of(running_breedings_,
                                        [&](const auto& item) { return item.second.session == breeding.session; });
        });
        if (next == waiting_breedings_.end()) {
            return;
        }
        WaitingBreeding breeding = std::move(*next);
        waiting_breedings_.erase(next);
        begin(std::move(breeding));
    }
}

void BackgroundQueries::begin(WaitingBreeding breeding) {
    const std::uint64_t session_number = breeding.session, query = ++last_query_;
    running_breedings_[query] = {
        session_number, breeding.bytes,
        breeding_jobs_.add([&outbox = outbox_, query, breeding = std::move(breeding)](const std::stop_token& stop) {
            outbox.reply(compute(query, breeding, stop));
        })};
}

runtime::BreedingDone BackgroundQueries::compute(std::uint64_t query, const WaitingBreeding& breeding,
                                                 const std::stop_token& stop) {
    const auto bred = base::within_memory([&] { return breeding_of(breeding.request, breeding.run, stop); });
    if (!bred) {
        return {.query = query,
                .response =
                    protocol::refusing(breeding.request_id, protocol::with_paths(bred.error(), "get_breeding"))};
    }
    runtime::BreedingDone done{.query = query, .response = {}};
    done.response.set_request_id(breeding.request_id);
    v1::Breeding& answer = *done.response.mutable_breeding();
    answer = protocol::to_proto(bred->record, bred->parameters);
    answer.set_generation(bred->generation);
    answer.set_island(bred->island);
    done.is_shortened = is_shortened(breeding.request, answer);
    return done;
}

void BackgroundQueries::on_done(runtime::BreedingDone done) {
    const RunningBreeding& running = running_breedings_.at(done.query);
    if (const SessionPtr session = find_session(sessions_, running.session)) {
        session->requests.expect(-running.bytes);
        if (done.is_shortened) {
            limit_counters_.met(Limit::BreedingRows);
        }
        session->answer(std::move(done.response));
    }
    running_breedings_.erase(done.query);
    begin_next_breeding();
}

// ---- both ------------------------------------------------------------------------------------------------------

void BackgroundQueries::check_fork(runtime::CommandDone done) {
    fork_jobs_.add([&outbox = outbox_, waiting = std::make_shared<runtime::CommandDone>(std::move(done))](
                       const std::stop_token&) { outbox.reply(runtime::check_fork(std::move(*waiting))); });
}

void BackgroundQueries::forget(const Session& session) {
    if (const auto found = exports_.find(session.number()); found != exports_.end()) {
        cancel(found);
    }
    std::erase_if(waiting_breedings_,
                  [&](const WaitingBreeding& breeding) { return breeding.session == session.number(); });
    for (auto& [query, running] : running_breedings_) {
        if (running.session == session.number()) {
            running.stop.request_stop();
        }
    }
}

} // namespace evod::network
