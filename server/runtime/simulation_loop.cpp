#include "server/runtime/simulation_loop.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace evod::runtime {
namespace {

Clock::duration seconds(double s) {
    return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>{s});
}

constexpr std::chrono::milliseconds measuring_time{1000};

void give(const CommandAnswer& answer) {
    if (answer.give)
        answer.give();
}

bool changes_something(const simulation::Command& command) {
    const auto* set = std::get_if<simulation::SetParameters>(&command);
    return set == nullptr || !set->dry_run;
}

} // namespace

SimulationLoop::SimulationLoop(Mailbox& mailbox, Demand& demand, base::Executor& executor, Clock& clock,
                               LoopOutputs outputs, simulation::Laboratory laboratory, storage::Recorder* recorder)
    : mailbox_{mailbox}
    , demand_{demand}
    , executor_{executor}
    , clock_{clock}
    , outputs_{std::move(outputs)}
    , laboratory_{std::move(laboratory)}
    , recorder_{recorder} {}

std::optional<Clock::time_point> SimulationLoop::pass() {
    mind_mail();
    mind_demand();
    follow_worlds();
    if (recorder_ && !recorder_->has_room())
        return clock_.now() + slice; // the disk does not keep up: every world waits

    // Paced worlds first: they have a time to keep.
    std::optional<Clock::time_point> next;
    const auto at_latest = [&next](Clock::time_point time) { next = next ? std::min(*next, time) : time; };
    for (const auto& entry : laboratory_.entries()) {
        Track& track = tracks_.find(entry->name)->second;
        if (entry->wants_tick() && entry->control.speed) {
            const auto now = clock_.now();
            if (track.due <= now)
                advance_slice(*entry, track, now + slice);
        }
        if (entry->wants_tick() && entry->control.speed)
            at_latest(track.due);
    }
    for (const auto& entry : laboratory_.entries()) {
        if (!entry->wants_tick() || entry->control.speed)
            continue;
        const auto now = clock_.now();
        advance_slice(*entry, tracks_.find(entry->name)->second, next ? std::min(*next, now + slice) : now + slice);
        if (entry->wants_tick())
            at_latest(now);
    }

    const auto now = clock_.now();
    for (const auto& entry : laboratory_.entries()) {
        Track& track = tracks_.find(entry->name)->second;
        measure(*entry, track, now);
        show(*entry, track, now);
    }
    return next;
}

void SimulationLoop::mind_mail() {
    if (!mailbox_.pending())
        return;
    mail_ = mailbox_.drain(std::move(mail_));
    for (Mail& mail : mail_) {
        if (auto* command = std::get_if<CommandMail>(&mail))
            apply(*command);
        else
            std::get<QueryMail>(mail).ask(laboratory_);
    }
    mail_.clear();
}

void SimulationLoop::apply(CommandMail& mail) {
    // From here on the command names its world, so that it means the same when it is read again.
    std::visit(
        [this](auto& command) {
            if constexpr (requires { command.world; }) {
                if (command.world.empty())
                    if (const auto entry = std::as_const(laboratory_).find(""))
                        command.world = (*entry)->name;
            }
        },
        mail.command);
    std::optional<RunBefore> before;
    std::visit(
        [&](const auto& command) {
            if constexpr (requires { command.world; })
                if (const auto entry = std::as_const(laboratory_).find(command.world))
                    before = {(*entry)->run_id, (*entry)->world.moment().tick};
        },
        mail.command);
    const auto applied = apply(mail.command);
    tell_events();
    CommandAnswer answer = mail.reply(laboratory_, mail.command, applied);
    if (recorder_ && applied && changes_something(mail.command))
        record(mail, *applied, std::move(answer), before);
    else
        give(answer);
    if (applied)
        if (const auto track = tracks_.find(applied->world); track != tracks_.end())
            track->second.changed = true;
}

base::Result<simulation::Applied> SimulationLoop::apply(const simulation::Command& command) {
    if (recorder_ && changes_something(command))
        if (auto refused = recorder_->refusal())
            return *refused;
    return laboratory_.apply(command);
}

void SimulationLoop::record(CommandMail& mail, const simulation::Applied& applied, CommandAnswer answer,
                            const std::optional<RunBefore>& before) {
    const bool ends = std::holds_alternative<simulation::DeleteWorld>(mail.command);
    const bool begins = std::holds_alternative<simulation::CreateWorld>(mail.command) ||
                        std::holds_alternative<simulation::ResetWorld>(mail.command);
    if (std::holds_alternative<simulation::ResetWorld>(mail.command))
        recorder_->end(applied.world, before->run_id, before->tick);
    const auto entry = std::as_const(laboratory_).find(applied.world);
    storage::RunRecorder& run = begins ? recorder_->begin(**entry) : *recorder_->of(applied.world);
    run.journal(applied.tick, ends ? simulation::RunControl{} : (*entry)->control, std::move(mail.origin),
                std::move(answer.frame), std::move(answer.give));
    if (ends)
        recorder_->end(applied.world, before->run_id, before->tick);
}

void SimulationLoop::close() {
    mind_mail();
    if (recorder_)
        recorder_->close_all(laboratory_);
}

void SimulationLoop::mind_demand() {
    if (!demand_.changed())
        return;
    watches_ = demand_.take();
    for (auto& [name, track] : tracks_) {
        const auto watch = watches_.find(name);
        track.watch = watch == watches_.end() ? nullptr : &watch->second;
    }
}

void SimulationLoop::follow_worlds() {
    for (const auto& entry : laboratory_.entries())
        follow(*entry);
    if (tracks_.size() > laboratory_.entries().size())
        std::erase_if(tracks_, [this](const auto& item) {
            return std::none_of(laboratory_.entries().begin(), laboratory_.entries().end(),
                                [&](const auto& entry) { return entry->name == item.first; });
        });
}

SimulationLoop::Track& SimulationLoop::follow(simulation::Entry& entry) {
    auto found = tracks_.find(entry.name);
    if (found == tracks_.end()) {
        found = tracks_.emplace(entry.name, Track{}).first;
        if (const auto watch = watches_.find(entry.name); watch != watches_.end())
            found->second.watch = &watch->second;
    }
    Track& track = found->second;
    if (recorder_)
        track.recorder = recorder_->of(entry.name);
    const bool wants_tick = entry.wants_tick();
    const double tick_s = entry.world.parameters().active.tick_s;
    const bool anew = track.run_id != entry.run_id || track.speed != entry.control.speed || track.tick_s != tick_s;
    if (wants_tick && (anew || !track.running)) {
        // Its clock starts now: it owes nothing for the time in which it stood, or went at another speed.
        track.due = clock_.now();
        track.measured_since = track.due;
        track.ticks = 0;
    }
    if (!wants_tick)
        entry.ticks_per_s = 0;
    track.run_id = entry.run_id;
    track.speed = entry.control.speed;
    track.tick_s = tick_s;
    track.running = wants_tick;
    return track;
}

Clock::duration SimulationLoop::period(const simulation::Entry& entry) const {
    return seconds(entry.world.parameters().active.tick_s / *entry.control.speed);
}

void SimulationLoop::advance_slice(simulation::Entry& entry, Track& track, Clock::time_point end) {
    const bool paced = entry.control.speed.has_value();
    auto before = clock_.now();
    do {
        laboratory_.advance(entry, executor_);
        if (track.recorder)
            track.recorder->follow(entry.world);
        ++track.ticks;
        const bool stopped = !entry.wants_tick();
        if (stopped) {
            track.changed = true; // a goal was reached
            track.running = false;
            entry.ticks_per_s = 0;
        }
        tell_events();
        const auto now = clock_.now();
        if (paced)
            track.due = std::max(track.due + period(entry), now - catch_up_max);
        measure(entry, track, now);
        show(entry, track, now);
        mind_checkpoint(entry, track, now - std::exchange(before, now));
        if (stopped || now >= end || (paced && track.due > now))
            return;
    } while (!mailbox_.pending() && !demand_.changed());
}

void SimulationLoop::mind_checkpoint(const simulation::Entry& entry, Track& track, Clock::duration spent) {
    if (!track.recorder || !track.recorder->checkpoint_due(entry.world, spent))
        return;
    const auto began = clock_.now();
    track.recorder->make_checkpoint(entry.world, executor_);
    track.recorder->checkpoint_took(clock_.now() - began);
}

void SimulationLoop::measure(simulation::Entry& entry, Track& track, Clock::time_point now) {
    const std::chrono::duration<double> passed = now - track.measured_since;
    // The first figure comes soon, for somebody may be waiting to see one.
    if (!track.running || passed < (entry.ticks_per_s == 0 ? measuring_time / 4 : measuring_time))
        return;
    entry.ticks_per_s = static_cast<double>(track.ticks) / passed.count();
    track.ticks = 0;
    track.measured_since = now;
}

void SimulationLoop::show(const simulation::Entry& entry, Track& track, Clock::time_point now) {
    if (!track.watch)
        return;
    const Watch& watch = *track.watch;
    const bool newcomer = track.newcomers_served != watch.newcomers;
    const auto between = seconds(1 / watch.rate_hz);
    if (!newcomer && !track.changed) {
        // A tenth early rather than a whole tick late: ticks do not fall exactly on a picture's time.
        if (entry.world.moment().tick == track.pictured_tick || now + between / 10 < track.next_picture)
            return;
    }
    island_indices_.clear();
    const auto island_count = static_cast<std::uint32_t>(entry.world.islands().size());
    if (watch.all_islands) {
        island_indices_.resize(island_count);
        std::iota(island_indices_.begin(), island_indices_.end(), 0u);
    } else {
        for (const std::uint32_t island : watch.islands)
            if (island < island_count)
                island_indices_.push_back(island);
    }
    outputs_.picture(pool_.take(entry, island_indices_, track.changed));
    // Kept on a grid, so that the rate holds on average; begun anew after a pause or a picture out of turn.
    track.next_picture += between;
    if (newcomer || track.changed || track.next_picture <= now)
        track.next_picture = now + between;
    track.newcomers_served = watch.newcomers;
    track.changed = false;
    track.pictured_tick = entry.world.moment().tick;
}

void SimulationLoop::tell_events() {
    auto events = laboratory_.take_events();
    if (!events.empty())
        outputs_.events(laboratory_, std::move(events));
}

} // namespace evod::runtime
