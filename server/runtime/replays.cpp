#include "server/runtime/replays.h"

#include "server/base/overloaded.h"
#include "server/protocol/commands.h"
#include "server/protocol/request_rules.h"
#include "server/protocol/worlds.h"

namespace evod::runtime {

using base::Refusal;
using base::RefusalCode;
using base::Result;

namespace {

/// Adds the path of the RunMoment to the field names in a refusal, because clients know these fields by their path.
Refusal within(Refusal refused, const std::string& field) {
    for (base::Violation& violation : refused.violations) {
        violation.field = field + "." + violation.field;
    }
    return refused;
}

} // namespace

void Replays::apply(const ReplayMail& mail) {
    std::visit(base::Overloaded{[&](const OpenReplay& request) { open(request, mail); },
                                [&](const Seek& request) { seek(request, mail); },
                                [&](const CloseReplay& request) { answer(mail, close(request)); }},
               mail.request);
}

void Replays::answer(const ReplayMail& mail, const Result<std::string>& world) {
    ReplayDone done{.mail = mail, .world = world};
    if (world && !std::holds_alternative<CloseReplay>(mail.request)) {
        done.shown = protocol::to_proto(**laboratory_.find(*world));
    }
    reply_(std::move(done));
}

void Replays::find_run(const FindRun& mail) {
    const std::string world = protocol::lookup_name(protocol::world_of(*mail.request));
    const auto entry = std::as_const(laboratory_).find(world);
    if (!entry) {
        const simulation::DamagedWorld* damaged = laboratory_.find_damaged(world);
        if (damaged && damaged->run_id && mail.request->has_export_run()) {
            const replay::StoredRun run{recorder_->paths_of(damaged->name, *damaged->run_id), *damaged->run_id};
            return reply_(RunFound{mail, FoundRun{run}});
        }
        return reply_(RunFound{mail, entry.error()});
    }
    const auto run = run_of((*entry)->name);
    if (!run) {
        return reply_(RunFound{mail, run.error()});
    }
    reader_.once_written(
        (*entry)->name,
        [this, found = RunFound{mail, FoundRun{*run, (*entry)->world.moment().generation}}](bool) { reply_(found); });
}

Result<replay::StoredRun> Replays::run_of(const std::string& world) const {
    const auto entry = std::as_const(laboratory_).find(world);
    if (!entry) {
        return entry.error();
    }
    if (const replay::StoredRun* run = shown_.run_of((*entry)->name)) {
        return *run;
    }
    if (!recorder_) {
        return refusal(RefusalCode::FailedPrecondition,
                       "this server stores no runs, so it cannot replay them: start it without --keep-nothing",
                       base::Reason::RunsNotKept);
    }
    return replay::StoredRun{recorder_->paths_of((*entry)->name, (*entry)->run_id), (*entry)->run_id};
}

replay::RecordedUntil Replays::recorded_until(const std::string& world, const simulation::RunId& run_id) const {
    const auto living = std::as_const(laboratory_).find(world);
    if (!living || (*living)->replay || (*living)->run_id != run_id) {
        return {};
    }
    const simulation::Moment& now = (*living)->world.moment();
    return {.generation = now.generation, .tick = now.tick};
}

void Replays::open(const OpenReplay& request, const ReplayMail& mail) {
    const auto origin = std::as_const(laboratory_).find(request.world);
    if (!origin) {
        return answer(mail, origin.error());
    }
    const bool session_full = shown_.names(mail.session).size() + seeks_.opening_count(mail.session) >= replays_max;
    if (session_full || shown_.names().size() + seeks_.opening_count() >= replays_of_all_max) {
        return answer(mail, refusal(RefusalCode::ResourceExhausted,
                                    session_full ? "this session has " + std::to_string(replays_max) +
                                                       " replays open already: close one first"
                                                 : "all clients together have " + std::to_string(replays_of_all_max) +
                                                       " replays open already: try again when one of them is closed",
                                    base::Reason::ReplaysMax));
    }
    const std::string name = (*origin)->replays_another_world() ? (*origin)->replay->replay_of : (*origin)->name;
    const std::string world = (*origin)->name;
    const auto run = run_of(world);
    if (!run) {
        return answer(mail, run.error());
    }
    const auto done = [this, mail, name, run = *run](Result<SeekResult> result) {
        if (!result) {
            return answer(mail, within(result.error(), "at"));
        }
        result->there.replay_of = name;
        const std::string replay_name = name + "@" + std::to_string(++last_name_);
        shown_.show(replay_name, run, mail.session, *std::move(result));
        answer(mail, replay_name);
    };
    seeks_.begin(world, {.session = mail.session,
                         .opens = true,
                         .run = *run,
                         .to = request.at,
                         .known = recorded_until(world, run->run_id()),
                         .done = done});
}

void Replays::seek(const Seek& request, const ReplayMail& mail) {
    const auto entry = std::as_const(laboratory_).find(request.world);
    if (!entry) {
        return answer(mail, entry.error());
    }
    const std::string name = (*entry)->name;
    const replay::StoredRun* run = shown_.run_of(name);
    if (!run) {
        return answer(mail, Refusal{.code = RefusalCode::FailedPrecondition,
                                    .message = "this world is live and cannot be moved to another moment: open a "
                                               "replay of its run, as evoview and evoctl stats --at-generation do, or "
                                               "serve its run file with evod replay",
                                    .violations = {},
                                    .reason = base::Reason::WorldIsLive});
    }
    const simulation::Replay& seen = *(*entry)->replay;
    const std::string origin = seen.replay_of.empty() ? name : seen.replay_of;
    const auto done = [this, mail, name](Result<SeekResult> result) {
        if (!result) {
            return answer(mail, within(result.error(), "to"));
        }
        shown_.move_to(name, *std::move(result));
        answer(mail, name);
    };
    seeks_.begin(origin, {.session = mail.session,
                          .moves = name,
                          .run = *run, // the world may begin a new run; the replay still shows this one
                          .to = request.to,
                          .known = recorded_until(origin, run->run_id()),
                          .shown = {.generation = seen.last_generation, .tick = seen.last_tick},
                          .done = done});
}

void Replays::seek_for_fork(const std::string& world, std::uint64_t generation,
                            std::function<void(Result<SeekResult>)> done) {
    const auto run = run_of(world);
    if (!run) {
        return done(run.error());
    }
    seeks_.begin(world, {.run = *run,
                         .to = replay::WantedMoment{.generation = generation, .tick = {}},
                         .known = recorded_until(world, run->run_id()),
                         .done = std::move(done)});
}

Result<std::string> Replays::close(const CloseReplay& request) {
    if (!shown_.is_owned(request.world)) {
        return Refusal{.code = RefusalCode::NotFound,
                       .message = "there is no such replay",
                       .violations = {{"world", "one that was opened with OpenReplay", request.world}},
                       .reason = base::Reason::WorldNotFound};
    }
    shown_.close(request.world);
    seeks_.cancel_of_replay(request.world);
    return request.world;
}

void Replays::forget(std::uint64_t session) {
    seeks_.cancel_of_session(session);
    for (const std::string& name : shown_.names(session)) {
        shown_.close(name);
        seeks_.cancel_of_replay(name);
    }
}

} // namespace evod::runtime
