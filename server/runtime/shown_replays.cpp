#include "server/runtime/shown_replays.h"

#include "server/base/within_memory.h"
#include "server/simulation/world_bytes.h"

#include <algorithm>
#include <memory>
#include <utility>

namespace evod::runtime {

simulation::Entry& ShownReplays::entry_of(const std::string& name) {
    return **laboratory_.find(name);
}

void ShownReplays::show(const std::string& name, const replay::StoredRun& run, Owner owner, SeekResult result) {
    simulation::RunControl control;
    control.endless = control.paused = true;
    replay::ComingChanges changes = std::move(result.rerun).take_changes();
    const std::uint64_t entries_read = changes.last_entry();
    replays_.emplace(name, Shown{run, std::move(changes), entries_read, std::move(owner)});
    laboratory_.adopt(std::make_unique<simulation::Entry>(simulation::Entry{
        name, run.run_id(), control, std::move(result.rerun).take(), 0, false, std::move(result.there)}));
    (void)entry_of(name).world.take_events(); // discard the events that the seek caused
}

void ShownReplays::move_to(const std::string& name, SeekResult result) {
    Shown& shown = replays_.find(name)->second;
    simulation::Entry& entry = entry_of(name);
    shown.changes = std::move(result.rerun).take_changes();
    shown.entries_read = shown.changes.last_entry();
    shown.refreshed = {};
    result.there.replay_of = entry.replay->replay_of;
    entry.world = std::move(result.rerun).take();
    entry.replay = std::move(result.there);
    (void)entry.world.take_events(); // discard the events that the seek caused
}

void ShownReplays::close(const std::string& name) {
    laboratory_.dismiss(name);
    replays_.erase(name);
}

const replay::StoredRun* ShownReplays::run_of(const std::string& name) const {
    const auto shown = replays_.find(name);
    return shown == replays_.end() ? nullptr : &shown->second.run;
}

const ShownReplays::Owner* ShownReplays::owner_of(std::string_view name) const {
    const auto shown = replays_.find(name);
    return shown == replays_.end() ? nullptr : &shown->second.owner;
}

std::vector<std::string> ShownReplays::names(std::optional<std::uint64_t> session) const {
    std::vector<std::string> names;
    for (const auto& [name, shown] : replays_) {
        if (!session || shown.owner.session == *session) {
            names.push_back(name);
        }
    }
    return names;
}

std::size_t ShownReplays::held_bytes(std::uint64_t session) const {
    std::size_t bytes = 0;
    for (const auto& [name, shown] : replays_) {
        if (shown.owner.session == session) {
            bytes += simulation::estimated_bytes((*laboratory_.find(name))->world) + shown.changes.held_bytes();
        }
    }
    return bytes;
}

void ShownReplays::follow(simulation::Entry& entry) {
    if (const auto shown = replays_.find(entry.name); shown != replays_.end()) {
        shown->second.changes.apply_due(entry.world);
    }
}

std::optional<Clock::time_point> ShownReplays::refresh(Clock::time_point now) {
    std::optional<Clock::time_point> next;
    for (auto& [name, shown] : replays_) {
        const simulation::Entry& entry = entry_of(name);
        const bool at_its_end = entry.world.moment().tick >= entry.replay->last_tick;
        if (!at_its_end || (entry.control.paused && !entry.control.until_tick) || shown.being_read) {
            continue;
        }
        if (now >= shown.refreshed + refresh_time) {
            shown.refreshed = now;
            shown.being_read = true;
            jobs_.add(shown.owner.user, [&mailbox = mailbox_, name = name, run = shown.run,
                                         after = shown.entries_read](const base::StopCheck& stop) {
                mailbox.push(RecordsRead{name, std::make_shared<const base::Result<replay::NewRecords>>(
                                                   base::within_memory([&] { return run.new_records(after, stop); }))});
            });
        }
        const auto again = shown.refreshed + refresh_time;
        next = next ? std::min(*next, again) : again;
    }
    return next;
}

void ShownReplays::take(const RecordsRead& mail) {
    const auto shown = replays_.find(mail.replay);
    if (shown == replays_.end()) {
        return; // it was closed
    }
    shown->second.being_read = false;
    if (*mail.records) {
        extend(entry_of(mail.replay), shown->second, **mail.records);
    }
}

void ShownReplays::extend(simulation::Entry& entry, Shown& shown, const replay::NewRecords& records) {
    // A seek may have moved the replay since it requested these records. They may then leave a gap after its known
    // records.
    if (records.there.last_tick <= entry.replay->last_tick || records.after_entry > shown.entries_read) {
        return;
    }
    if (!shown.changes.extend(records.path, records.changes)) {
        return;
    }
    shown.entries_read = std::max(shown.entries_read, records.last_entry);
    shown.changes.apply_due(entry.world);
    const std::string replay_of = entry.replay->replay_of;
    entry.replay = records.there;
    entry.replay->replay_of = replay_of;
}

} // namespace evod::runtime
