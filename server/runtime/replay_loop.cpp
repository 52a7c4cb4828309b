#include "server/runtime/replay_loop.h"

#include "server/base/overloaded.h"
#include "server/base/within_memory.h"
#include "server/protocol/worlds.h"
#include "server/runtime/admission.h"
#include "server/runtime/fork.h"

#include <algorithm>
#include <memory>
#include <utility>

namespace evod::runtime {

using base::Refusal;
using base::RefusalCode;
using base::Result;

namespace {

/// Completes the names of the fields in a refusal of a seek, which are those of a moment.
Refusal with_prefix(const std::string& prefix, Refusal refused) {
    for (base::Violation& violation : refused.violations) {
        violation.field = prefix + violation.field;
    }
    return refused;
}

LoopOutputs with_users(LoopOutputs outputs, LoopOutputs::UserOf user_of) {
    outputs.user_of = std::move(user_of);
    return outputs;
}

} // namespace

ReplayLoop::ReplayLoop(const LoopTools& tools, LoopOutputs outputs, JobTurns& turns, std::optional<FileReplay> file,
                       simulation::Laboratory laboratory)
    : SimulationLoop{tools, with_users(std::move(outputs), [this](const std::string& world) { return user_of(world); }),
                     std::move(laboratory)}
    , hosts_worlds_{file.has_value()}
    , jobs_{turns}
    , seeks_{tools.mailbox, jobs_, tools.executor}
    , shown_{laboratory_, tools.mailbox, jobs_} {
    if (file) {
        shown_.show(file->name, file->run, {}, std::move(file->shown));
    }
}

void ReplayLoop::handle(Mail& mail) {
    std::visit(base::Overloaded{
                   [this](ComputeForkWorld& request) { begin_seek(request.fork, request.run.run, request.run.until); },
                   [this](SeekRead& read) { report_memory(seeks_.take(read)); },
                   [this](RecordsRead& read) {
                       shown_.take(read);
                       if (const ShownReplays::Owner* owner = shown_.owner_of(read.replay)) {
                           report_memory(owner->session);
                       }
                   },
                   [this](FindRun& run) { find_run(run); },
                   [&](ReplayMail& request) {
                       if (!answer(request)) {
                           SimulationLoop::handle(mail);
                       }
                   },
                   [&](CommandMail& command) {
                       if (!fork(command)) {
                           SimulationLoop::handle(mail);
                       }
                   },
                   [this](EndReplay& ended) { end(ended); },
                   [&](SessionEnded& ended) {
                       forget(ended.session);
                       SimulationLoop::handle(mail);
                   },
                   [&](auto&) { SimulationLoop::handle(mail); }},
               mail);
}

void ReplayLoop::update_worlds() {
    for (Seeks::Ended& seek : seeks_.take_ended()) {
        finish(std::move(seek));
    }
}

void ReplayLoop::list_seeks(std::vector<Pace::Contender>& contenders) {
    for (auto& [number, seek] : seeks_.all()) {
        if (seek.at) {
            contenders.push_back({.user = seek.user, .turn = &seek.turn, .seek = number});
        }
    }
}

void ReplayLoop::after_tick(simulation::Entry& entry) {
    shown_.follow(entry);
    laboratory_.settle(entry);
    if (entry.world.generation_over()) {
        if (const ShownReplays::Owner* owner = shown_.owner_of(entry.name)) {
            report_memory(owner->session); // the history has grown
        }
    }
}

std::string ReplayLoop::user_of(const std::string& world) const {
    const ShownReplays::Owner* owner = shown_.owner_of(world);
    return owner != nullptr ? owner->user : std::string{};
}

void ReplayLoop::find_run(const FindRun& mail) {
    const auto entry = std::as_const(laboratory_).find(mail.world);
    if (!entry) {
        return outputs_.reply(RunFound{mail, entry.error()});
    }
    const replay::StoredRun* run = shown_.run_of((*entry)->name);
    if (run == nullptr) {
        return runs_.find(mail);
    }
    const std::string& original = (*entry)->replay->replay_of;
    outputs_.reply(RunFound{mail, FoundRun{.world = original.empty() ? (*entry)->name : original,
                                           .run = *run,
                                           .ownership = (*entry)->ownership,
                                           .generation = (*entry)->world.moment().generation}});
}

bool ReplayLoop::answer(const ReplayMail& mail) {
    return std::visit(base::Overloaded{[&](const OpenReplay& request) {
                                           open(mail, request);
                                           return true;
                                       },
                                       [&](const Seek& request) { return seek(mail, request); },
                                       [&](const CloseReplay& request) { return close(mail, request); }},
                      mail.request);
}

void ReplayLoop::open(const ReplayMail& mail, const OpenReplay& request) {
    seeks_.begin({.purpose = {mail}, .run = mail.run->run, .to = request.at, .until = mail.run->until});
}

bool ReplayLoop::seek(const ReplayMail& mail, const Seek& request) {
    const auto entry = std::as_const(laboratory_).find(request.world);
    const replay::StoredRun* run = entry ? shown_.run_of((*entry)->name) : nullptr;
    if (run == nullptr) {
        return false;
    }
    const simulation::Replay& seen = *(*entry)->replay;
    replay::RecordedUntil until{.generation = seen.last_generation, .tick = seen.last_tick};
    // The world may have begun a new run; the replay still shows this one.
    if (mail.run && mail.run->run.run_id() == run->run_id()) {
        until.generation = std::max(until.generation, mail.run->until.generation);
        until.tick = std::max(until.tick, mail.run->until.tick);
    }
    seeks_.begin({.purpose = {mail, (*entry)->name}, .run = *run, .to = request.to, .until = until});
    return true;
}

bool ReplayLoop::close(const ReplayMail& mail, const CloseReplay& request) {
    const ShownReplays::Owner* owner = shown_.owner_of(request.world);
    if (owner == nullptr || owner->session == 0) {
        return false;
    }
    const std::uint64_t session = owner->session;
    shown_.close(request.world);
    seeks_.cancel_of_replay(request.world);
    outputs_.reply(ReplayDone{mail, request.world});
    report_memory(session);
    return true;
}

void ReplayLoop::end(const EndReplay& mail) {
    if (mail.name.empty()) {
        seeks_.cancel_opening(mail.session, mail.request_id, replay_taken_back());
    } else if (const ShownReplays::Owner* owner = shown_.owner_of(mail.name)) {
        const std::uint64_t session = owner->session;
        shown_.close(mail.name);
        seeks_.cancel_of_replay(mail.name);
        report_memory(session);
        outputs_.reply(ReplayEnded{mail.name});
    }
}

bool ReplayLoop::fork(CommandMail& mail) {
    const auto* command = std::get_if<simulation::ForkWorld>(&mail.command);
    if (command == nullptr) {
        return false;
    }
    const auto entry = std::as_const(laboratory_).find(command->world);
    const replay::StoredRun* run = entry ? shown_.run_of((*entry)->name) : nullptr;
    if (hosts_worlds_) {
        if (run == nullptr) {
            return false; // the original is not a replay
        }
        Mail announced = ForkAnnounced{command->name, !command->at_generation};
        SimulationLoop::handle(announced);
    }
    if (!entry) {
        send_fork_world(mail, {}, entry.error());
    } else if (const auto refused = admit(mail, *entry)) {
        send_fork_world(mail, {}, *refused);
    } else if (begins_in_another_generation(*command, (*entry)->world)) {
        begin_seek(mail, *run, {});
    } else {
        send_fork_world(mail, (*entry)->run_id, base::within_memory([&]() -> Result<simulation::World> {
                            return (*entry)->world.copy(tools_.executor);
                        }));
    }
    return true;
}

void ReplayLoop::begin_seek(const CommandMail& fork, const replay::StoredRun& run, replay::RecordedUntil until) {
    const auto& command = std::get<simulation::ForkWorld>(fork.command);
    const replay::WantedMoment to{.generation = command.at_generation, .tick = {}};
    seeks_.begin({.purpose = {fork}, .run = run, .to = to, .until = until});
}

void ReplayLoop::send_fork_world(const CommandMail& fork, const simulation::RunId& run_id,
                                 Result<simulation::World> world) {
    outputs_.reply(ForkWorldComputed{fork, run_id, std::make_shared<Result<simulation::World>>(std::move(world))});
}

void ReplayLoop::finish(Seeks::Ended ended) {
    const replay::StoredRun& run = ended.request.run;
    if (const auto* fork = std::get_if<CommandMail>(&ended.request.purpose.request)) {
        return ended.result ? send_fork_world(*fork, run.run_id(), std::move(ended.result->rerun).take())
                            : send_fork_world(*fork, run.run_id(), with_prefix("at_", ended.result.error()));
    }
    finish(std::get<ReplayMail>(ended.request.purpose.request), ended.request.purpose.replay, run,
           std::move(ended.result));
}

void ReplayLoop::finish(const ReplayMail& mail, const std::string& moved, const replay::StoredRun& run,
                        Result<SeekResult> result) {
    report_memory(mail.session);
    if (!result) {
        const std::string field = moved.empty() ? "at." : "to.";
        return outputs_.reply(ReplayDone{mail, with_prefix(field, result.error())});
    }
    std::string name = moved;
    if (moved.empty()) {
        result->there.replay_of = mail.run->world;
        name = mail.run->world + "@" + std::to_string(++last_name_);
        shown_.show(name, run, {mail.session, mail.user}, *std::move(result));
        (*laboratory_.find(name))->ownership = mail.run->ownership;
    } else {
        shown_.move_to(name, *std::move(result));
    }
    report_memory(shown_.owner_of(name)->session); // another session may have moved it
    const simulation::Entry& entry = **laboratory_.find(name);
    outputs_.reply(ReplayDone{mail, name, protocol::to_proto(entry)});
    if (!moved.empty()) {
        pace_.show_change(name);
        outputs_.events(laboratory_, {{name, entry.run_id, entry.world.moment().tick, simulation::GoalReached{}}},
                        outputs_.user_of);
    }
}

void ReplayLoop::report_memory(std::uint64_t session) {
    if (session == 0) {
        return;
    }
    const std::size_t bytes = seeks_.held_bytes(session) + shown_.held_bytes(session);
    const auto reported = reported_bytes_.find(session);
    if (bytes == (reported == reported_bytes_.end() ? 0 : reported->second)) {
        return;
    }
    if (bytes == 0) {
        reported_bytes_.erase(reported); // also if the session has ended
    } else {
        reported_bytes_[session] = bytes;
    }
    outputs_.reply(ReplayMemory{.session = session, .bytes = bytes});
}

void ReplayLoop::forget(std::uint64_t session) {
    reported_bytes_.erase(session);
    seeks_.cancel_of_session(session);
    for (const std::string& name : shown_.names(session)) {
        shown_.close(name);
        seeks_.cancel_of_replay(name);
    }
}

} // namespace evod::runtime
