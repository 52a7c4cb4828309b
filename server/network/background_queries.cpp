#include "server/network/background_queries.h"

#include "server/base/within_memory.h"
#include "server/protocol/breeding.h"
#include "server/protocol/refusals.h"
#include "server/replay/breeding.h"
#include "server/runtime/fork.h"
#include "server/runtime/worker_pool.h"

#include <algorithm>
#include <memory>
#include <utility>

namespace evod::network {
namespace {

using base::RefusalCode;

base::Result<replay::Bred> breeding_of(const v1::GetBreeding& request, const runtime::FoundRun& run,
                                       const base::StopCheck& stop) {
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

base::Refusal export_not_wanted() {
    return refusal(RefusalCode::FailedPrecondition, "the export was cancelled", base::Reason::ExportEnded);
}

base::Refusal export_taken_back() {
    return refusal(RefusalCode::ResourceExhausted,
                   "the export was cancelled, because this user had the most exports and another user needed a place: "
                   "begin it again when another one has ended",
                   base::Reason::ExportsMax);
}

} // namespace

BackgroundQueries::~BackgroundQueries() {
    for (auto& [session, item] : exports_) {
        if (item.job) {
            item.job->cancel(export_not_wanted());
        }
    }
}

// ---- exports ---------------------------------------------------------------------------------------------------

void BackgroundQueries::begin_export(Session& session, std::uint64_t request_id, const replay::StoredRun& run,
                                     const replay::WantedTable& wanted) {
    if (const auto before = exports_.find(session.number()); before != exports_.end()) {
        cancel(before->second, export_not_wanted());
        exports_.erase(before);
    }
    const std::string user = session.account();
    if (auto taken = take_export_place(user); !taken) {
        limit_counters_.met(Limit::Exports);
        return session.answer(protocol::refusing(request_id, taken.error()));
    }
    Export begun{++last_export_id_, user,
                 std::make_unique<runtime::ExportJob>(runtime::ExportJob::Tools{export_jobs_, turns_, outbox_}, user,
                                                      run, wanted, export_patience_),
                 std::make_unique<HeldMemory>(session, runtime::ExportJob::held_bytes)};
    ask(session, request_id, exports_.emplace(session.number(), std::move(begun)).first->second);
}

base::Result<void> BackgroundQueries::take_export_place(const std::string& user) {
    const auto full = [](std::string message, std::size_t held, std::size_t allowed) {
        return base::limit_refusal(std::move(message), base::Reason::ExportsMax, "exports_max", held, allowed);
    };
    give_abandoned_places_back();
    (void)cancelled_count(); // deletes those that have ended
    if (std::ranges::count(cancelled_, user, &CancelledExport::user) >= std::ptrdiff_t{exports_max}) {
        return full("many exports of this user are just being cancelled: try again", exports_max, exports_max);
    }
    base::Quota& quota = export_quota_;
    switch (quota.ask(user)) {
    case base::Quota::Verdict::UserFull:
        return full("this user has " + std::to_string(quota.share()) +
                        " exports running already, half of those that may run at once: try again when one has ended",
                    quota.held(user), quota.share());
    case base::Quota::Verdict::PoolFull:
        return full(std::to_string(exports_max) + " exports are already running: try again when one has ended",
                    quota.held(), quota.total());
    case base::Quota::Verdict::FromLargest:
        take_back_export();
        break;
    case base::Quota::Verdict::Free:
        break;
    }
    quota.take(user);
    return {};
}

std::size_t BackgroundQueries::cancelled_count() {
    std::erase_if(cancelled_, [](const CancelledExport& item) { return item.job->finished(); });
    return cancelled_.size();
}

void BackgroundQueries::take_back_export() {
    const std::string user = export_quota_.largest();
    auto oldest = exports_.end();
    for (auto item = exports_.begin(); item != exports_.end(); ++item) {
        if (item->second.user == user && item->second.has_place &&
            (oldest == exports_.end() || item->second.id < oldest->second.id)) {
            oldest = item;
        }
    }
    limit_counters_.took_back(Limit::Exports);
    cancel(oldest->second, export_taken_back());
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
    if (found->second.part_requested) {
        return session.answer(protocol::refusing(
            request_id, refusal(RefusalCode::FailedPrecondition,
                                "the previous request for a part is not answered yet: wait for its answer",
                                base::Reason::ExportEnded)));
    }
    if (!found->second.job) {
        return session.answer(protocol::refusing(request_id, export_taken_back()));
    }
    ask(session, request_id, found->second);
}

void BackgroundQueries::ask(const Session& session, std::uint64_t request_id, Export& from) {
    from.part_requested = true;
    from.job->next({.session = session.number(), .request_id = request_id, .export_id = from.id});
}

void BackgroundQueries::cancel(Export& of, const base::Refusal& why) {
    give_place_back(of);
    if (of.job) {
        of.job->cancel(why);
        cancelled_.push_back({of.user, std::move(of.job)});
        of.held.reset();
    }
}

void BackgroundQueries::give_place_back(Export& of) {
    if (std::exchange(of.has_place, false)) {
        export_quota_.give_back(of.user);
    }
}

void BackgroundQueries::give_abandoned_places_back() {
    for (auto& [session, item] : exports_) {
        if (item.job && item.job->finished()) {
            give_place_back(item);
        }
    }
}

void BackgroundQueries::on_done(runtime::ExportPartDone done) {
    const runtime::PartRequest& request = done.request;
    // The session may have started another export in the meantime.
    if (const auto found = exports_.find(request.session);
        found != exports_.end() && found->second.id == request.export_id) {
        found->second.part_requested = false;
        if (found->second.job && !done.part && done.part.error().code == RefusalCode::FailedPrecondition) {
            limit_counters_.met(Limit::ExportPatience);
        }
        if (!done.part || done.part->last) {
            cancel(found->second, export_not_wanted());
            exports_.erase(found);
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
    const std::string user = session.account();
    if (waiting_breedings_.count(user) >= breedings_waiting_max) {
        limit_counters_.met(Limit::RunningBreedings);
        return session.answer(protocol::refusing(
            request.request_id(), base::limit_refusal(std::to_string(breedings_waiting_max) +
                                                          " GetBreeding of this user wait already: try again later",
                                                      base::Reason::ServerBusy, "breedings_max",
                                                      waiting_breedings_.count(user), breedings_waiting_max)));
    }
    const auto bytes = static_cast<std::ptrdiff_t>(sizeof(Breeding) + request.SpaceUsedLong());
    session.requests.expect(bytes);
    waiting_breedings_.add(user,
                           std::make_shared<const Breeding>(Breeding{session.number(), user, request.request_id(),
                                                                     request.get_breeding(), std::move(run), bytes}));
    begin_next_breeding();
}

bool BackgroundQueries::may_begin(const Breeding& breeding) const {
    using Verdict = base::Quota::Verdict;
    const Verdict verdict = breeding_quota_.ask(breeding.user);
    return (verdict == Verdict::Free || verdict == Verdict::FromLargest) &&
           std::ranges::none_of(running_breedings_,
                                [&](const auto& item) { return item.second.breeding->session == breeding.session; });
}

void BackgroundQueries::begin_next_breeding() {
    const auto may = [this](const std::string& /*user*/, const BreedingPtr& breeding) { return may_begin(*breeding); };
    while (auto next = waiting_breedings_.take(may)) {
        begin(*std::move(next));
    }
}

void BackgroundQueries::begin(BreedingPtr breeding) {
    if (breeding_quota_.ask(breeding->user) == base::Quota::Verdict::FromLargest) {
        take_back_breeding();
    }
    breeding_quota_.take(breeding->user);
    const std::uint64_t query = ++last_query_;
    auto job = [&outbox = outbox_, &turns = turns_, query, breeding](const std::stop_token& stop) {
        runtime::JobTurns::Turn turn{turns, breeding->user, stop};
        outbox.reply(compute(query, *breeding, turn.stop_check()));
    };
    running_breedings_[query] = {breeding, breeding_jobs_.add(std::move(job), breeding->user)};
}

void BackgroundQueries::take_back_breeding() {
    const std::string user = breeding_quota_.largest();
    const auto last =
        std::ranges::find_if(running_breedings_.rbegin(), running_breedings_.rend(), [&](const auto& item) {
            return item.second.breeding->user == user && !item.second.is_taken_back;
        });
    limit_counters_.took_back(Limit::RunningBreedings);
    breeding_quota_.give_back(user);
    last->second.is_taken_back = true;
    last->second.stop.request_stop();
}

runtime::BreedingDone BackgroundQueries::compute(std::uint64_t query, const Breeding& breeding,
                                                 const base::StopCheck& stop) {
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
    const RunningBreeding ended = std::move(running_breedings_.extract(done.query).mapped());
    const Breeding& breeding = *ended.breeding;
    if (!ended.is_taken_back) {
        breeding_quota_.give_back(breeding.user);
    }
    if (const SessionPtr session = find_session(sessions_, breeding.session)) {
        if (done.is_shortened) {
            limit_counters_.met(Limit::BreedingRows);
        }
        if (ended.is_taken_back && !done.response.has_breeding()) {
            waiting_breedings_.add_first(breeding.user, ended.breeding);
        } else {
            session->requests.expect(-breeding.bytes);
            session->answer(std::move(done.response));
        }
    }
    begin_next_breeding();
}

// ---- both ------------------------------------------------------------------------------------------------------

void BackgroundQueries::check_fork(runtime::CommandDone done) {
    const std::string user = done.mail.user;
    fork_jobs_.add(
        [&outbox = outbox_, &turns = turns_, user,
         waiting = std::make_shared<runtime::CommandDone>(std::move(done))](const std::stop_token& stop) {
            runtime::JobTurns::Turn turn{turns, user, stop};
            outbox.reply(runtime::check_fork(std::move(*waiting), turn));
        },
        user);
}

void BackgroundQueries::forget(const Session& session) {
    if (const auto found = exports_.find(session.number()); found != exports_.end()) {
        cancel(found->second, export_not_wanted());
        exports_.erase(found);
    }
    waiting_breedings_.remove_if([&](const BreedingPtr& breeding) { return breeding->session == session.number(); });
    for (auto& [query, running] : running_breedings_) {
        if (running.breeding->session == session.number()) {
            running.stop.request_stop();
        }
    }
}

} // namespace evod::network
