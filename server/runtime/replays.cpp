#include "server/runtime/replays.h"

#include "server/base/inline_executor.h"
#include "server/base/overloaded.h"
#include "server/base/within_memory.h"
#include "server/protocol/commands.h"
#include "server/protocol/request_rules.h"
#include "server/protocol/worlds.h"

#include <algorithm>
#include <memory>
#include <utility>

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

Refusal superseded() {
    return refusal(RefusalCode::FailedPrecondition,
                   "superseded by a later seek: seek again if this moment is still wanted",
                   base::Reason::SeekSuperseded);
}

Refusal owner_gone() {
    return refusal(RefusalCode::NotFound, "the session that asked for it has ended");
}

Refusal closed_since() {
    return refusal(RefusalCode::NotFound, "the replay has been closed: open it again", base::Reason::WorldNotFound);
}

} // namespace

Result<Replays::FileReplay> Replays::replay_of(const std::string& path, std::optional<std::uint64_t> generation,
                                               base::Executor& executor) {
    auto run = replay::StoredRun::of_file(path);
    if (!run) {
        return run.error();
    }
    const auto name = run->world_name();
    if (!name) {
        return name.error();
    }
    std::optional<replay::WantedMoment> wanted;
    if (generation) {
        wanted = replay::WantedMoment{.generation = generation, .tick = {}};
    }
    auto start = run->start_seek(wanted, {}, executor);
    if (!start) {
        return start.error();
    }
    RunningSeek running{.number = 0,
                        .owner = 0,
                        .rerun = std::move(start->from),
                        .to = start->to,
                        .there = std::move(start->there),
                        .done = {}};
    while (!advance(running, executor)) {
    }
    return FileReplay{*name, *std::move(run), std::move(running.rerun), std::move(running.there)};
}

void Replays::show(FileReplay replay) {
    show(replay.name, std::move(replay.run), 0, {std::move(replay.rerun), std::move(replay.replay)});
}

void Replays::show(const std::string& name, replay::StoredRun run, std::uint64_t owner, SeekResult result) {
    simulation::RunControl control;
    control.endless = control.paused = true;
    const replay::ComingChanges& changes = result.rerun.changes();
    replays_.emplace(name, Shown{run, changes, changes.last_entry(), owner, {}, false, 0});
    laboratory_.adopt(std::make_unique<simulation::Entry>(simulation::Entry{
        name, run.run_id(), control, std::move(result.rerun).take(), 0, false, std::move(result.there)}));
    (void)entry_of(name)->world.take_events(); // discard the events that the seek caused
}

simulation::Entry* Replays::entry_of(const std::string& world) {
    const auto found = laboratory_.find(world);
    return found ? *found : nullptr;
}

void Replays::apply(const ReplayMail& mail) {
    std::visit(base::Overloaded{[&](const OpenReplay& request) { open(request, mail); },
                                [&](const Seek& request) { seek(request, mail); },
                                [&](const CloseReplay& request) { answer(mail, close(request)); }},
               mail.request);
}

void Replays::answer(const ReplayMail& mail, const Result<std::string>& world) {
    ReplayDone done{.mail = mail, .world = world};
    if (world && !std::holds_alternative<CloseReplay>(mail.request)) {
        if (const simulation::Entry* entry = entry_of(*world)) {
            done.shown = protocol::to_proto(*entry);
        }
    }
    reply_(std::move(done));
}

void Replays::find_run(const FindRun& mail) {
    const auto entry = std::as_const(laboratory_).find(protocol::lookup_name(protocol::world_of(*mail.request)));
    if (!entry) {
        return reply_(RunFound{mail, entry.error()});
    }
    const auto run = replay_of((*entry)->name);
    if (!run) {
        return reply_(RunFound{mail, run.error()});
    }
    once_written((*entry)->name, [this, found = RunFound{mail, FoundRun{*run, (*entry)->world.moment().generation}}](
                                     bool) { reply_(found); });
}

Result<replay::StoredRun> Replays::replay_of(const std::string& world) const {
    const auto entry = std::as_const(laboratory_).find(world);
    if (!entry) {
        return entry.error();
    }
    if (const auto shown = replays_.find((*entry)->name); shown != replays_.end()) {
        return shown->second.run;
    }
    if (!recorder_) {
        return refusal(RefusalCode::FailedPrecondition,
                       "this server keeps no runs, so it cannot replay them: start it without --keep-nothing",
                       base::Reason::RunsNotKept);
    }
    return replay::StoredRun{recorder_->paths_of((*entry)->name, (*entry)->run_id), (*entry)->run_id};
}

void Replays::once_written(const std::string& world, std::function<void(bool)> then) {
    recording::RunRecorder* recorder = recorder_ ? recorder_->of(world) : nullptr;
    if (!recorder || recorder_->refusal()) {
        return then(false); // nothing more will be written, so the caller reads the file in its present state
    }
    const std::uint64_t number = ++last_waiting_;
    waiting_.emplace(number, std::move(then));
    recorder->once_written([this, number] {
        mailbox_.push(CallMail{[this, number] {
            if (auto waited = waiting_.extract(number)) {
                waited.mapped()(true);
            }
        }});
    });
}

replay::RecordedUntil Replays::recorded_until(const std::string& world, const simulation::RunId& run_id) const {
    const auto living = std::as_const(laboratory_).find(world);
    if (!living || (*living)->replay || (*living)->run_id != run_id) {
        return {};
    }
    const simulation::Moment& now = (*living)->world.moment();
    return {.generation = now.generation, .tick = now.tick};
}

void Replays::stop_waiting() {
    for (const auto& [number, then] : std::exchange(waiting_, {})) {
        then(false);
    }
}

void Replays::read_and_seek(const replay::StoredRun& run, const std::optional<replay::WantedMoment>& to,
                            replay::RecordedUntil known, std::uint64_t owner, SeekDone done, const Begun& begun) {
    if (pending_.size() + seeks_.size() >= seeks_max) {
        return done(refusal(RefusalCode::ResourceExhausted, "too many seeks are under way: try again",
                            base::Reason::ReplaysMax));
    }
    const std::uint64_t number = ++last_seek_;
    pending_.emplace(number, PendingSeek{.owner = owner, .begun = begun, .done = std::move(done)});
    read_file([this, number, run, to, known]() -> std::function<void()> {
        base::InlineExecutor executor;
        const auto start = std::make_shared<Result<replay::SeekStart>>(
            base::within_memory([&] { return run.start_seek(to, known, executor); }));
        return [this, number, start] { begin(number, std::move(*start)); };
    });
}

void Replays::begin(std::uint64_t number, Result<replay::SeekStart> start) {
    const auto found = pending_.extract(number);
    if (!found) { // the session that requested the seek has ended
        return;
    }
    PendingSeek pending = std::move(found.mapped());
    if (!start) {
        return pending.done(start.error());
    }
    if (pending.begun && !pending.begun(number)) {
        return pending.done(closed_since());
    }
    seeks_.push_back({.number = number,
                      .owner = pending.owner,
                      .rerun = std::move(start->from),
                      .to = start->to,
                      .there = std::move(start->there),
                      .done = std::move(pending.done)});
}

void Replays::cancel(std::uint64_t number, const Refusal& why) {
    const auto running = std::ranges::find(seeks_, number, &RunningSeek::number);
    if (running == seeks_.end()) {
        return;
    }
    const SeekDone cancelled = std::move(running->done);
    seeks_.erase(running);
    cancelled(why);
}

void Replays::begin_seek(const std::string& world, std::uint64_t generation, SeekDone done) {
    const auto run = replay_of(world);
    if (!run) {
        return done(run.error());
    }
    const auto known = recorded_until(world, run->run_id());
    once_written(world, [this, generation, known, run = *run, done = std::move(done)](bool all_is_written) {
        read_and_seek(run, replay::WantedMoment{.generation = generation, .tick = {}},
                      all_is_written ? known : replay::RecordedUntil{}, 0, done);
    });
}

bool Replays::is_over(const RunningSeek& running) {
    const simulation::Moment& now = running.rerun.world().moment();
    return now.generation > running.to.generation ||
           (now.generation == running.to.generation && now.tick >= running.to.tick);
}

bool Replays::advance(RunningSeek& running, base::Executor& executor) {
    const simulation::World& world = running.rerun.world();
    const simulation::Moment& now = world.moment();
    if (is_over(running)) {
        return true;
    }
    if (now.generation < running.to.generation && world.generation_over()) {
        running.rerun.turn_over(executor);
    } else if (world.outcome() == evolution::Outcome::Running) {
        running.rerun.advance_tick(executor);
    } else {
        return true; // the run ends before the target; advance_seeks() reports it
    }
    return is_over(running);
}

void Replays::advance_seeks(const std::function<bool()>& stop) {
    for (std::size_t next = 0; !seeks_.empty() && (next == 0 || !stop()); ++next) {
        const std::size_t i = next % seeks_.size();
        if (!advance(seeks_[i], executor_)) {
            continue;
        }
        RunningSeek running = std::move(seeks_[i]);
        seeks_.erase(seeks_.begin() + static_cast<std::ptrdiff_t>(i));
        const simulation::Moment& there = running.rerun.world().moment();
        if (there.generation == running.to.generation && there.tick == running.to.tick) {
            finished_.push_back(
                {std::move(running.done), SeekResult{std::move(running.rerun), std::move(running.there)}});
        } else {
            finished_.push_back({std::move(running.done),
                                 refusal(RefusalCode::DataLoss,
                                         "simulated again, the run does not reach the moment that its file contains")});
        }
    }
}

void Replays::finish_seeks() {
    for (FinishedSeek& seek : std::exchange(finished_, {})) {
        seek.done(std::move(seek.result));
    }
}

void Replays::move_to(simulation::Entry& entry, Shown& shown, SeekResult result) {
    shown.changes = result.rerun.changes();
    shown.entries_read = shown.changes.last_entry();
    shown.refreshed = {};
    entry.world = std::move(result.rerun).take();
    entry.replay = std::move(result.there);
    (void)entry.world.take_events(); // discard the events that the seek caused
    moved_.push_back(entry.name);
}

void Replays::open(const OpenReplay& request, const ReplayMail& mail) {
    const auto origin = std::as_const(laboratory_).find(request.world);
    if (!origin) {
        return answer(mail, origin.error());
    }
    std::size_t of_owner = 0, of_all = replays_.size();
    for (const auto& [name, shown] : replays_) {
        of_owner += shown.owner == mail.session;
    }
    for (const auto& [owner, count] : opening_) {
        of_owner += owner == mail.session ? count : 0;
        of_all += count;
    }
    if (of_owner >= replays_max || of_all >= replays_of_all_max) {
        return answer(mail, refusal(RefusalCode::ResourceExhausted,
                                    of_owner >= replays_max
                                        ? "this session has " + std::to_string(replays_max) +
                                              " replays open already: close one first"
                                        : "all clients together have " + std::to_string(replays_of_all_max) +
                                              " replays open already: try again when one of them is closed",
                                    base::Reason::ReplaysMax));
    }
    const std::string name = (*origin)->replays_another_world() ? (*origin)->replay->replay_of : (*origin)->name;
    const std::string world = (*origin)->name;
    const auto run = replay_of(world);
    if (!run) {
        return answer(mail, run.error());
    }
    ++opening_[mail.session];
    const auto opened = [this, mail](const Result<std::string>& shown) {
        if (const auto opening = opening_.find(mail.session); opening != opening_.end() && --opening->second == 0) {
            opening_.erase(opening);
        }
        answer(mail, shown);
    };
    const auto known = recorded_until(world, run->run_id());
    once_written(world, [this, name, known, run = *run, request, owner = mail.session, opened](bool all_is_written) {
        std::optional<replay::WantedMoment> at;
        if (request.at.generation || request.at.tick) {
            at = request.at;
        }
        const auto done = [this, name, run, owner, opened](Result<SeekResult> result) {
            if (!result) {
                return opened(within(result.error(), "at"));
            }
            result->there.replay_of = name;
            const std::string replay_name = name + "@" + std::to_string(++last_name_);
            show(replay_name, run, owner, *std::move(result));
            opened(replay_name);
        };
        if (!opening_.contains(owner)) {
            return opened(owner_gone());
        }
        read_and_seek(run, at, all_is_written ? known : replay::RecordedUntil{}, owner, done);
    });
}

void Replays::seek(const Seek& request, const ReplayMail& mail) {
    const auto entry = std::as_const(laboratory_).find(request.world);
    if (!entry) {
        return answer(mail, entry.error());
    }
    const std::string name = (*entry)->name;
    if (!replays_.contains(name)) {
        return answer(
            mail, Refusal{.code = RefusalCode::FailedPrecondition,
                          .message =
                              "this world lives and cannot be taken to another moment: open its "
                              "run, as evoview and evoctl stats --at-generation do, or serve its file with evod replay",
                          .violations = {},
                          .reason = base::Reason::WorldIsLive});
    }
    const std::string& replay_of = (*entry)->replay->replay_of;
    const std::string origin = replay_of.empty() ? name : replay_of;
    const auto known_now = recorded_until(origin, replays_.find(name)->second.run.run_id());
    ++seeking_[mail.session];
    const auto sought = [this, mail](const Result<std::string>& world) {
        if (const auto seeking = seeking_.find(mail.session); seeking != seeking_.end() && --seeking->second == 0) {
            seeking_.erase(seeking);
        }
        answer(mail, world);
    };
    once_written(origin, [this, name, known_now, request, owner = mail.session, sought](bool all_is_written) {
        const auto shown = replays_.find(name);
        if (shown == replays_.end()) {
            return sought(closed_since());
        }
        if (!seeking_.contains(owner)) {
            return sought(owner_gone());
        }
        const replay::StoredRun& run = shown->second.run;
        // The world may have begun a new run in the meantime. The replay still shows the run for which it was opened.
        const simulation::Replay& seen = *entry_of(name)->replay;
        replay::RecordedUntil known{.generation = seen.last_generation, .tick = seen.last_tick};
        if (all_is_written) {
            known.generation = std::max(known.generation, known_now.generation);
            known.tick = std::max(known.tick, known_now.tick);
        }
        const auto done = [this, name, replay_of = seen.replay_of, sought](Result<SeekResult> result) {
            if (!result) {
                return sought(within(result.error(), "to"));
            }
            const auto seen_from = replays_.find(name);
            if (seen_from == replays_.end()) {
                return sought(closed_since());
            }
            result->there.replay_of = replay_of;
            move_to(*entry_of(name), seen_from->second, *std::move(result));
            sought(name);
        };
        read_and_seek(run, request.to, known, owner, done, [this, name](std::uint64_t running) {
            const auto shown_now = replays_.find(name);
            if (shown_now == replays_.end()) {
                return false;
            }
            cancel(std::exchange(shown_now->second.running, running), superseded());
            return true;
        });
    });
}

Result<std::string> Replays::close(const CloseReplay& request) {
    const auto shown = replays_.find(request.world);
    if (shown == replays_.end() || shown->second.owner == 0) {
        return Refusal{.code = RefusalCode::NotFound,
                       .message = "there is no such shown at the past",
                       .violations = {{"world", "one that was opened with OpenReplay", request.world}},
                       .reason = base::Reason::WorldNotFound};
    }
    cancel(shown->second.running, closed_since());
    laboratory_.dismiss(request.world);
    replays_.erase(shown);
    return request.world;
}

void Replays::forget(std::uint64_t session) {
    std::erase_if(replays_, [&](const auto& item) {
        if (item.second.owner != session) {
            return false;
        }
        laboratory_.dismiss(item.first);
        return true;
    });
    opening_.erase(session);
    seeking_.erase(session);
    std::vector<SeekDone> cancelled;
    std::erase_if(pending_, [&](auto& item) {
        if (item.second.owner != session) {
            return false;
        }
        cancelled.push_back(std::move(item.second.done));
        return true;
    });
    std::erase_if(seeks_, [&](RunningSeek& running) {
        if (running.owner != session) {
            return false;
        }
        cancelled.push_back(std::move(running.done));
        return true;
    });
    for (const SeekDone& done : cancelled) {
        done(owner_gone());
    }
}

void Replays::follow(simulation::Entry& entry) {
    if (const auto shown = replays_.find(entry.name); shown != replays_.end()) {
        shown->second.changes.make_due(entry.world);
    }
}

std::optional<Clock::time_point> Replays::refresh(Clock::time_point now) {
    std::optional<Clock::time_point> next;
    for (auto& [name, shown] : replays_) {
        simulation::Entry& entry = *entry_of(name);
        const bool at_its_end = entry.world.moment().tick >= entry.replay->last_tick;
        if (!at_its_end || (entry.control.paused && !entry.control.until_tick) || shown.being_read) {
            continue;
        }
        if (now >= shown.refreshed + refresh_time) {
            shown.refreshed = now;
            read_new_records(name, shown);
        }
        const auto again = shown.refreshed + refresh_time;
        next = next ? std::min(*next, again) : again;
    }
    return next;
}

void Replays::read_new_records(const std::string& name, Shown& shown) {
    shown.being_read = true;
    read_file([this, name, run = shown.run, after = shown.entries_read]() -> std::function<void()> {
        return [this, name, records = base::within_memory([&] { return run.new_records(after); })] {
            const auto shown_now = replays_.find(name);
            if (shown_now == replays_.end()) {
                return;
            }
            shown_now->second.being_read = false;
            if (records) {
                extend(*entry_of(name), shown_now->second, *records);
            }
        };
    });
}

void Replays::read_file(std::function<std::function<void()>()> read) {
    reader_.add([this, read = std::move(read)](const std::stop_token&) { mailbox_.push(CallMail{read()}); });
}

void Replays::extend(simulation::Entry& entry, Shown& shown, const replay::NewRecords& records) {
    // If a seek has moved the replay since the records were requested, they may start after the end of its known
    // records.
    if (records.there.last_tick <= entry.replay->last_tick || records.after_entry > shown.entries_read) {
        return;
    }
    if (!shown.changes.extend(records.path, records.changes)) {
        return;
    }
    shown.entries_read = std::max(shown.entries_read, records.last_entry);
    shown.changes.make_due(entry.world);
    const std::string replay_of = entry.replay->replay_of;
    entry.replay = records.there;
    entry.replay->replay_of = replay_of;
}

} // namespace evod::runtime
