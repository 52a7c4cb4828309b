#include "server/runtime/simulations.h"

#include "server/jobs/thread_pool.h"
#include "server/simulation/world_name.h"

#include <algorithm>
#include <utility>

namespace evod::runtime {

void Simulations::start(Start with) {
    if (shows_file_) {
        replays_.thread = std::make_unique<SimulationThread>(
            SimulationThread::Options{.name = "simulation"}, replays_.mailbox,
            std::make_unique<ReplayLoop>(LoopTools{replays_.mailbox, replays_.demand, with.executor, with.clock},
                                         std::move(with.outputs), job_turns_, std::move(with.file),
                                         std::move(with.laboratory)));
        return;
    }
    LoopOutputs of_replays = with.outputs;
    of_replays.counted = nullptr;
    live_.thread = std::make_unique<SimulationThread>(
        SimulationThread::Options{.name = "simulation"}, live_.mailbox,
        std::make_unique<SimulationLoop>(LoopTools{live_.mailbox, live_.demand, with.executor, with.clock},
                                         std::move(with.outputs), std::move(with.laboratory), with.recorder),
        with.recorder);
    // The threads of the pool inherit the priority of the thread that starts them, which is that of the replays.
    replay_executor_ = std::make_unique<jobs::ThreadPool>(with.executor.thread_count());
    replays_.thread = std::make_unique<SimulationThread>(
        SimulationThread::Options{.name = "replays", .niceness = replay_niceness}, replays_.mailbox,
        std::make_unique<ReplayLoop>(LoopTools{replays_.mailbox, replays_.demand, *replay_executor_, with.clock},
                                     std::move(of_replays), job_turns_));
}

void Simulations::stop() {
    for (Part* part : {&replays_, &live_}) {
        if (part->thread) {
            part->thread->stop();
        }
    }
}

void Simulations::for_each_thread(const std::function<void(const char*, pthread_t)>& use) {
    for (Part* part : {&live_, &replays_}) {
        if (part->thread) {
            use(part->thread->name(), part->thread->handle());
        }
    }
}

Simulations::Part& Simulations::part_of(std::string_view world) {
    return shows_file_ || simulation::is_replay_name(world) ? replays_ : live_;
}

bool Simulations::try_send(CommandMail mail) {
    const auto* fork = std::get_if<simulation::ForkWorld>(&mail.command);
    if (fork != nullptr && !shows_file_ && simulation::is_replay_name(fork->world)) {
        // The replay is forked as it is when the command comes, so the command goes to its thread.
        ForkAnnounced announced{fork->name, !fork->at_generation};
        const std::string user = mail.user;
        if (!replays_.mailbox.try_push(std::move(mail), user)) {
            return false;
        }
        live_.mailbox.push(std::move(announced));
        return true;
    }
    const std::string world = std::visit(
        [](const auto& command) {
            if constexpr (requires { command.name; }) {
                return std::string{}; // it creates a live world
            } else {
                return command.world;
            }
        },
        mail.command);
    const std::string user = mail.user;
    return mailbox_of(world).try_push(std::move(mail), user);
}

bool Simulations::try_send(ReplayMail mail) {
    const std::string user = mail.user;
    const std::string world = std::visit([](const auto& request) { return request.world; }, mail.request);
    std::string with_run;
    if (std::holds_alternative<OpenReplay>(mail.request)) {
        with_run = world;
    } else if (std::holds_alternative<Seek>(mail.request) && simulation::is_replay_name(world)) {
        with_run = simulation::original_of(world); // its run may have grown
    } else {
        return mailbox_of(world).try_push(std::move(mail), user);
    }
    const std::uint64_t session = mail.session;
    if (!mailbox_of(with_run).try_push(FindRun{with_run, session, std::move(mail)}, user)) {
        return false;
    }
    ++finding_[session];
    return true;
}

void Simulations::set_demand(WorldDemands worlds, bool events_wanted) {
    WorldDemands of_replays;
    for (auto world = worlds.begin(); world != worlds.end();) {
        const auto next = std::next(world);
        if (&part_of(world->first) == &replays_) {
            of_replays.insert(worlds.extract(world));
        }
        world = next;
    }
    live_.demand.set(std::move(worlds));
    replays_.demand.set(std::move(of_replays));
    for (Part* part : {&live_, &replays_}) {
        part->demand.want_events(events_wanted);
        part->mailbox.wake();
    }
}

void Simulations::forget(std::uint64_t session) {
    finding_.erase(session);
    replays_.mailbox.push(SessionEnded{session});
    if (!shows_file_) {
        live_.mailbox.push(SessionEnded{session});
    }
}

std::optional<Answer> Simulations::pass_on(Reply reply) {
    if (auto* computed = std::get_if<ForkWorldComputed>(&reply)) {
        part_of("").mailbox.push(std::move(*computed));
        return std::nullopt;
    }
    auto answer = unwritten_.pass(std::move(reply));
    if (auto* found = answer ? std::get_if<RunFound>(&*answer) : nullptr) {
        if (auto* fork = std::get_if<CommandMail>(&found->mail.purpose)) {
            replays_.mailbox.push(ComputeForkWorld{std::move(*fork), *std::move(found->run)});
            return std::nullopt;
        }
        if (auto* replay = std::get_if<ReplayMail>(&found->mail.purpose)) {
            const auto finding = finding_.find(replay->session);
            if (finding == finding_.end()) {
                return std::nullopt; // the session has ended
            }
            if (--finding->second == 0) {
                finding_.erase(finding);
            }
            if (!found->run && std::holds_alternative<OpenReplay>(replay->request)) {
                return ReplayDone{std::move(*replay), found->run.error()};
            }
            if (found->run) {
                replay->run = *std::move(found->run);
            }
            replays_.mailbox.push(std::move(*replay));
            return std::nullopt;
        }
    }
    return answer;
}

} // namespace evod::runtime
