#include "server/runtime/simulation_loop.h"

#include "server/base/assert.h"
#include "server/base/overloaded.h"

#include <algorithm>
#include <string>
#include <utility>

namespace evod::runtime {

SimulationLoop::SimulationLoop(const LoopTools& tools, LoopOutputs outputs, simulation::Laboratory laboratory,
                               recording::Recorder* recorder)
    : tools_{tools}
    , outputs_{std::move(outputs)}
    , laboratory_{std::move(laboratory)}
    , recorder_{recorder}
    , runs_{laboratory_, recorder, outputs_}
    , pace_{tools, laboratory_, recorder, outputs_, *this}
    , builds_{tools.mailbox, tools.executor}
    , storage_{laboratory_, recorder, builds_, outputs_}
    , commands_{tools, laboratory_, recorder, outputs_, builds_, storage_, runs_} {
    if (recorder_) {
        recorder_->set_receipt_sink(
            [reply = outputs_.reply](recording::Receipt receipt) { reply(std::move(receipt)); });
    }
}

std::optional<Clock::time_point> SimulationLoop::pass() {
    storage_.poll(tools_.clock.now());
    poll_mailbox();
    answer_queries();
    if (tools_.demand.changed()) {
        pace_.set_demand(tools_.demand.take());
    }
    contenders_.clear();
    list_seeks(contenders_);
    const auto next_tick = pace_.advance(contenders_);
    const auto next_query = answer_queries(); // until the next tick is due
    const auto now = tools_.clock.now();
    const auto next_refresh = refresh(now);
    pace_.measure_and_show(now);

    std::optional<Clock::time_point> next;
    for (const auto& time : {next_tick, next_query, next_refresh, storage_.due()}) {
        if (time && (!next || *time < *next)) {
            next = time;
        }
    }
    return next;
}

void SimulationLoop::handle(Mail& mail) {
    std::visit(base::Overloaded{[this](CommandMail& command) { commands_.handle(command); },
                                [this](ForEachWorld& mail) { commands_.handle(mail); },
                                [this](SetClass& mail) { commands_.handle(mail); },
                                [this](QueryMail& query) { queries_.add(std::move(query)); },
                                [this](FindRun& run) { runs_.find(run); },
                                [this](ReplayMail& request) { refuse(request); },
                                [this](ForkAnnounced& announced) { commands_.take(announced); },
                                [this](ForkWorldComputed& computed) { commands_.take(computed); },
                                [this](SessionEnded& ended) { queries_.forget(ended.session); },
                                [this](WorldBuilt& built) { commands_.take(built); },
                                [this](Ping&) { outputs_.reply(Pong{}); }, [](auto&) { EVOD_ASSERT(false); }},
               mail);
}

void SimulationLoop::poll_mailbox() {
    update_worlds(); // before mail that concerns the worlds that have changed
    if (tools_.mailbox.pending()) {
        mail_ = tools_.mailbox.drain(std::move(mail_));
        for (Mail& mail : mail_) {
            handle(mail);
        }
        mail_.clear();
    }
    update_worlds();
    follow_worlds();
}

void SimulationLoop::follow_worlds() {
    for (const std::string& world : commands_.take_changed()) {
        pace_.show_change(world);
    }
    pace_.follow_worlds();
    if (outputs_.counted == nullptr) {
        return;
    }
    std::vector<std::string> damaged;
    for (const simulation::DamagedWorld& world : laboratory_.damaged()) {
        damaged.push_back(world.name);
    }
    if (damaged != damaged_counted_) {
        damaged_counted_ = damaged;
        outputs_.counted->set_damaged(std::move(damaged));
    }
}

std::optional<Clock::time_point> SimulationLoop::answer_queries() {
    if (queries_.empty()) {
        return std::nullopt;
    }
    auto now = tools_.clock.now();
    const auto end = now + Pace::slice;
    bool woken = false; // set by a wake-up that may have another cause than mail; the rest of the pass must then run
    while (!queries_.empty()) {
        if (now >= end) {
            return now;
        }
        contenders_.clear();
        list_seeks(contenders_);
        const bool time_is_free = contenders_.empty() && !pace_.is_work_due(now);
        if (!queries_.allows(now) && !time_is_free) {
            return woken ? now : queries_.next_at();
        }
        QueryDone done = queries_.answer_next(laboratory_);
        const std::string user = done.mail.user;
        outputs_.reply(std::move(done));
        const auto began = std::exchange(now, tools_.clock.now());
        queries_.spend(user, now - began, !time_is_free);
        if (tools_.mailbox.pending()) {
            poll_mailbox(); // commands do not wait for queries
            woken = true;
        }
    }
    return woken ? std::optional{now} : std::nullopt;
}

void SimulationLoop::refuse(const ReplayMail& mail) {
    const std::string& world =
        std::visit([](const auto& request) -> const std::string& { return request.world; }, mail.request);
    const auto entry = std::as_const(laboratory_).find(world);
    base::Refusal why = entry ? simulation::no_such_replay(world) : entry.error();
    if (entry && std::holds_alternative<Seek>(mail.request)) {
        why = base::refusal(base::RefusalCode::FailedPrecondition,
                            "this world is live and cannot be moved to another moment: open a replay of its run, as "
                            "evoview and evoctl stats --at-generation do, or serve its run file with evod replay",
                            base::Reason::WorldIsLive);
    }
    outputs_.reply(ReplayDone{.mail = mail, .world = std::move(why)});
}

void SimulationLoop::close() {
    poll_mailbox();
    while (builds_.holds("")) {
        tools_.mailbox.wait(std::nullopt);
        poll_mailbox();
    }
    while (!queries_.empty()) {
        outputs_.reply(queries_.answer_next(laboratory_));
    }
    if (recorder_) {
        recorder_->close_all(laboratory_);
    }
}

} // namespace evod::runtime
