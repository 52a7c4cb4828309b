#include "server/runtime/simulation_loop.h"

#include "server/base/overloaded.h"
#include "server/log/log.h"
#include "server/protocol/queries.h"

#include <algorithm>
#include <memory>
#include <numeric>
#include <utility>

namespace evod::runtime {
namespace {

Clock::duration seconds(double s) {
    return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>{s});
}

constexpr std::chrono::milliseconds measuring_time{1000};

/// Returns how many ticks take about `time`, at least 1 and at most `most`.
std::uint64_t ticks_in(Clock::duration time, Clock::duration tick, std::int64_t most) {
    return static_cast<std::uint64_t>(tick.count() > 0 ? std::clamp<std::int64_t>(time / tick, 1, most) : 1);
}

} // namespace

SimulationLoop::SimulationLoop(Mailbox& mailbox, StreamDemand& demand, base::Executor& executor, Clock& clock,
                               LoopOutputs outputs, simulation::Laboratory laboratory, recording::Recorder* recorder,
                               std::optional<FileReplay> replay)
    : mailbox_{mailbox}
    , demand_{demand}
    , executor_{executor}
    , clock_{clock}
    , outputs_{std::move(outputs)}
    , laboratory_{std::move(laboratory)}
    , recorder_{recorder}
    , replays_{laboratory_, mailbox, executor, recorder, outputs_.reply}
    , builds_{mailbox, executor}
    , file_faults_{laboratory_, recorder, builds_} {
    if (recorder_) {
        laboratory_.set_storage({});
        recorder_->set_receipt_sink([&mailbox, reply = outputs_.reply](recording::Receipt receipt) {
            if (receipt.ticket >= RunReader::first_ticket) {
                mailbox.push(receipt);
            } else {
                reply(std::move(receipt));
            }
        });
    }
    count_damaged_worlds();
    if (replay) {
        replays_.shown().show(replay->name, replay->run, 0, std::move(replay->shown));
    }
}

std::optional<Clock::time_point> SimulationLoop::pass() {
    poll_storage();
    poll_run_files();
    poll_mailbox();
    answer_queries();
    poll_demand();

    // Paced live worlds come first, because their ticks are due at fixed times.
    std::optional<Clock::time_point> next;
    std::optional<Clock::time_point> in_time; // due times of the worlds that keep their pace
    const auto at_latest = [&next](Clock::time_point time) { next = next ? std::min(*next, time) : time; };
    if (waiting_since_ && !laboratory_.storage()->worlds_wait()) {
        at_latest(*waiting_since_ + slow_disk_patience);
    }
    const auto has_to_be_in_time = [](const simulation::Entry& entry) {
        return entry.control.speed.has_value() && !entry.replay;
    };
    const auto wants_tick = [this](const simulation::Entry& entry) {
        return entry.wants_tick() && !has_to_wait(entry);
    };
    for (const auto& entry : laboratory_.entries()) {
        if (!has_to_be_in_time(*entry) || !wants_tick(*entry)) {
            continue;
        }
        Track& track = tracks_.find(entry->name)->second;
        const auto now = clock_.now();
        if (track.due <= now) {
            advance_slice(*entry, track, now + slice);
        }
        if (!entry->wants_tick()) {
            continue;
        }
        at_latest(track.due);
        if (!entry->slowed) {
            in_time = in_time ? std::min(*in_time, track.due) : track.due;
        }
    }
    // The other worlds share the time until then. All seeks together count as one world.
    const auto wants_share = [&](const simulation::Entry& entry) {
        return !has_to_be_in_time(entry) && wants_tick(entry) &&
               (!entry.control.speed || tracks_.find(entry.name)->second.due <= clock_.now());
    };
    auto shares = std::ranges::count_if(laboratory_.entries(), [&](const auto& entry) { return wants_share(*entry); }) +
                  (replays_.seeks().under_way() ? 1 : 0);
    const auto end_of_share = [&](std::optional<Clock::time_point> until) {
        const auto now = clock_.now();
        const auto share = until ? (*until - now) / std::max<std::ptrdiff_t>(shares--, 1) : slice;
        return now + std::min<Clock::duration>(share, slice);
    };
    const auto paced_until = next;
    for (const auto& entry : laboratory_.entries()) {
        if (has_to_be_in_time(*entry) || !wants_tick(*entry)) {
            continue;
        }
        Track& track = tracks_.find(entry->name)->second;
        if (!entry->control.speed || track.due <= clock_.now()) {
            advance_slice(*entry, track, end_of_share(paced_until));
        }
        if (entry->wants_tick()) {
            at_latest(entry->control.speed ? track.due : clock_.now());
        }
    }
    if (replays_.seeks().under_way()) {
        // Seeks share the processor with worlds that cannot keep their pace.
        const auto end = end_of_share(in_time);
        replays_.seeks().advance([&] { return clock_.now() >= end || mailbox_.pending() || demand_.changed(); });
        at_latest(clock_.now());
    }
    if (const auto again = answer_queries()) { // answers queries until the next tick is due
        at_latest(*again);
    }

    const auto now = clock_.now();
    if (const auto again = replays_.shown().refresh(now)) {
        at_latest(*again);
    }
    for (const auto& entry : laboratory_.entries()) {
        Track& track = tracks_.find(entry->name)->second;
        measure(*entry, track, now);
        show(*entry, track, now);
        if (track.counted) {
            track.counted->ticks_per_s.set(entry->ticks_per_s);
        }
    }
    return next;
}

void SimulationLoop::announce_moved_replays() {
    for (const std::string& name : replays_.shown().take_moved_replays()) {
        const auto entry = std::as_const(laboratory_).find(name);
        const auto track = tracks_.find(name);
        if (!entry || track == tracks_.end()) {
            continue; // the replay was closed in the meantime
        }
        track->second.changed = true;
        outputs_.events(laboratory_,
                        {{name, (*entry)->run_id, (*entry)->world.moment().tick, simulation::GoalReached{}}});
    }
}

void SimulationLoop::poll_mailbox() {
    replays_.seeks().finish();
    if (mailbox_.pending()) {
        mail_ = mailbox_.drain(std::move(mail_));
        for (Mail& mail : mail_) {
            std::visit(base::Overloaded{[this](CommandMail& command) { apply(command); },
                                        [this](QueryMail& query) { queries_.push_back(std::move(query)); },
                                        [this](FindRun& run) { replays_.find_run(run); },
                                        [this](ReplayMail& request) { replays_.apply(request); },
                                        [this](SessionEnded& ended) {
                                            std::erase_if(queries_, [&](const QueryMail& query) {
                                                return query.session == ended.session;
                                            });
                                            replays_.forget(ended.session);
                                        },
                                        [](CallMail& call) { call.call(); }, [this](WorldBuilt& built) { take(built); },
                                        [this](const recording::Receipt& receipt) { replays_.take(receipt); }},
                       mail);
        }
        mail_.clear();
    }
    follow_worlds();
    announce_moved_replays();
}

std::optional<Clock::time_point> SimulationLoop::answer_queries() {
    if (queries_.empty()) {
        return std::nullopt;
    }
    auto now = clock_.now();
    const auto end = now + slice;
    bool woken = false; // set by a wake-up that may have another cause than mail; the rest of the pass must then run
    while (!queries_.empty()) {
        if (now >= end) {
            return now;
        }
        const bool time_is_free = !is_work_due(now);
        if (!query_budget_.allows(now) && !time_is_free) {
            return woken ? now : query_budget_.next_query_at();
        }
        answer_query();
        const auto began = std::exchange(now, clock_.now());
        if (!time_is_free) {
            query_budget_.spend(now - began);
        }
        if (mailbox_.pending()) {
            poll_mailbox(); // commands do not wait for queries
            woken = true;
        }
    }
    return woken ? std::optional{now} : std::nullopt;
}

void SimulationLoop::answer_query() {
    QueryDone done{.mail = std::move(queries_.front()), .response = {}, .result = {}};
    queries_.pop_front();
    const QueryMail& query = done.mail;
    done.response.set_request_id(query.request->request_id());
    done.result = protocol::answer_query(*query.request, laboratory_, query.users_only, done.response);
    outputs_.reply(std::move(done));
}

bool SimulationLoop::is_work_due(Clock::time_point now) const {
    return replays_.seeks().under_way() || std::ranges::any_of(laboratory_.entries(), [&](const auto& entry) {
               if (!entry->wants_tick() || has_to_wait(*entry)) {
                   return false;
               }
               return !entry->control.speed || tracks_.find(entry->name)->second.due <= now;
           });
}

void SimulationLoop::close() {
    poll_mailbox();
    while (builds_.holds("")) {
        mailbox_.wait(std::nullopt);
        poll_mailbox();
    }
    while (!queries_.empty()) {
        answer_query();
    }
    if (recorder_) {
        recorder_->close_all(laboratory_);
    }
}

void SimulationLoop::poll_demand() {
    if (!demand_.changed()) {
        return;
    }
    watches_ = demand_.take();
    for (auto& [name, track] : tracks_) {
        const auto watch = watches_.find(name);
        track.watch = watch == watches_.end() ? nullptr : &watch->second;
    }
}

void SimulationLoop::poll_storage() {
    if (!recorder_) {
        return;
    }
    // trouble() must be read before has_room(), because the storage thread makes room before it clears the trouble.
    const auto trouble = recorder_->trouble();
    worlds_wait_ = !recorder_->has_room();
    if (!worlds_wait_ || trouble) {
        waiting_since_.reset();
    } else if (!waiting_since_) {
        waiting_since_ = clock_.now();
    }
    simulation::Storage now;
    if (trouble) {
        now = {worlds_wait_ ? simulation::StorageState::Stalled : simulation::StorageState::Failing, *trouble};
    } else if (waiting_since_ && clock_.now() - *waiting_since_ >= slow_disk_patience) {
        now = {simulation::StorageState::Behind,
               std::to_string(recording::DiskState::waiting_bytes_max >> 20) + " MiB wait to be written"};
    }
    const simulation::Storage before = *laboratory_.storage();
    if (now == before) {
        return;
    }
    if (now.worlds_wait() && !before.worlds_wait()) {
        log::warn("worlds wait for the disk: {}", now.reason);
    } else if (before.worlds_wait() && !now.worlds_wait()) {
        log::info("worlds continue");
    }
    laboratory_.set_storage(now);
    outputs_.storage(now);
}

void SimulationLoop::poll_run_files() {
    const FileFaults::Changes changes = file_faults_.poll();
    if (!changes.damaged.empty()) {
        count_damaged_worlds();
        follow_worlds();
    }
    for (const simulation::DamagedWorld& world : changes.damaged) {
        outputs_.damaged(world);
    }
    for (const auto& [world, storage] : changes.storage) {
        outputs_.storage_of_world(world, storage);
    }
}

void SimulationLoop::follow_worlds() {
    for (const auto& entry : laboratory_.entries()) {
        follow(*entry);
    }
    if (tracks_.size() > laboratory_.entries().size()) {
        std::erase_if(tracks_, [this](const auto& item) {
            return std::none_of(laboratory_.entries().begin(), laboratory_.entries().end(),
                                [&](const auto& entry) { return entry->name == item.first; });
        });
    }
}

void SimulationLoop::count_damaged_worlds() {
    if (outputs_.counted == nullptr) {
        return;
    }
    std::vector<std::string> names;
    for (const simulation::DamagedWorld& world : laboratory_.damaged()) {
        names.push_back(world.name);
    }
    outputs_.counted->set_damaged(std::move(names));
}

SimulationLoop::Track& SimulationLoop::follow(simulation::Entry& entry) {
    auto found = tracks_.find(entry.name);
    if (found == tracks_.end()) {
        found = tracks_.emplace(entry.name, Track{}).first;
        if (const auto watch = watches_.find(entry.name); watch != watches_.end()) {
            found->second.watch = &watch->second;
        }
        if (outputs_.counted != nullptr && !entry.replays_another_world()) {
            found->second.counted = outputs_.counted->add(entry.name);
        }
    }
    Track& track = found->second;
    if (recorder_) {
        track.recorder = recorder_->of(entry.name);
    }
    // A short wait for the disk does not count as a pause.
    const bool wants_tick =
        entry.wants_tick() && !(entry.storage && entry.storage->worlds_wait()) && !builds_.holds(entry.name);
    const double tick_s = entry.world.parameters().active.tick_s;
    const bool restarts = track.run_id != entry.run_id || track.speed != entry.control.speed || track.tick_s != tick_s;
    if (wants_tick && (restarts || !track.running)) {
        // Start a new time grid for the ticks. The time before the pause, or at another speed, does not count.
        track.due = clock_.now();
        track.measured_since = track.due;
        track.ticks = 0;
        track.lost = {};
        entry.slowed = false;
    }
    if (!wants_tick) {
        entry.ticks_per_s = 0;
        entry.slowed = false;
        track.changed |= track.running; // the state changed, as after a Pause
    }
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
        const std::uint64_t ticks_per_clock_reading = ticks_in(between_clock_readings, track.tick_time, 100);
        std::uint64_t taken = 0;
        bool stopped = false;
        do {
            taken += advance(entry, track);
            if (track.recorder) {
                track.recorder->follow(entry.world);
            }
            if (entry.replay) {
                replays_.shown().follow(entry);
                laboratory_.settle(entry);
            }
            stopped = !entry.wants_tick();
            publish_events();
        } while (!paced && taken < ticks_per_clock_reading && !stopped && !mailbox_.pending());
        track.ticks += taken;
        if (stopped) {
            track.changed = true; // the world has reached a goal
            track.running = false;
            entry.ticks_per_s = 0;
        }
        const auto now = clock_.now();
        if (paced) {
            const auto due = track.due + period(entry);
            track.due = std::max(due, now - catch_up_max);
            track.lost += track.due - due;
        }
        measure(entry, track, now);
        show(entry, track, now);
        const auto spent = now - std::exchange(before, now);
        track.tick_time = spent / taken;
        if (track.counted) {
            track.counted->tick_time.add(track.tick_time, taken);
        }
        make_due_checkpoint(entry, track, spent);
        if (stopped || now >= end || (paced && track.due > now)) {
            return;
        }
    } while (!mailbox_.pending() && !demand_.changed());
}

std::uint64_t SimulationLoop::advance(simulation::Entry& entry, Track& track) {
    const std::uint64_t before = entry.world.moment().tick;
    std::uint64_t ticks = 1;
    if (entry.world.is_shared() && !entry.control.speed) {
        const std::uint64_t to_next_hash = run_file::ticks_per_hash - before % run_file::ticks_per_hash;
        ticks = std::min(ticks_in(between_exchanges, track.tick_time, run_file::ticks_per_hash), to_next_hash);
    }
    laboratory_.advance(entry, ticks, executor_);
    return entry.world.moment().tick - before;
}

void SimulationLoop::make_due_checkpoint(const simulation::Entry& entry, Track& track, Clock::duration spent) {
    if (!track.recorder || !track.recorder->checkpoint_due(entry.world, spent)) {
        return;
    }
    const auto began = clock_.now();
    track.recorder->make_checkpoint(entry.world, executor_);
    track.recorder->checkpoint_took(clock_.now() - began);
}

void SimulationLoop::measure(simulation::Entry& entry, Track& track, Clock::time_point now) {
    const std::chrono::duration<double> passed = now - track.measured_since;
    // The first measurement takes less time, because a user may be waiting for it.
    if (!track.running || passed < (entry.ticks_per_s == 0 ? measuring_time / 4 : measuring_time)) {
        return;
    }
    entry.ticks_per_s = static_cast<double>(track.ticks) / passed.count();
    const bool slowed = std::chrono::duration<double>{track.lost} > slowed_from * passed;
    track.changed |= slowed != entry.slowed;
    entry.slowed = slowed;
    track.ticks = 0;
    track.lost = {};
    track.measured_since = now;
}

void SimulationLoop::show(const simulation::Entry& entry, Track& track, Clock::time_point now) {
    if (!track.watch) {
        return;
    }
    const WorldDemand& watch = *track.watch;
    const bool newcomer = track.newcomers_served != watch.newcomers;
    const auto between = seconds(1 / watch.rate_hz);
    if (!newcomer && !track.changed) {
        // A snapshot may be taken early by 10 % of the interval. Ticks rarely coincide with the planned time, and
        // waiting for the next tick could delay the snapshot by a whole tick.
        if (entry.world.moment().tick == track.shown_tick || now + between / 10 < track.next_snapshot) {
            return;
        }
    }
    island_indices_.clear();
    const auto island_count = entry.world.island_count();
    if (watch.all_islands) {
        island_indices_.resize(island_count);
        std::iota(island_indices_.begin(), island_indices_.end(), 0u);
    } else {
        for (const std::uint32_t island : watch.islands) {
            if (island < island_count) {
                island_indices_.push_back(island);
            }
        }
    }
    const auto began = clock_.now();
    outputs_.snapshot(pool_.take(entry, island_indices_, track.changed));
    if (track.counted) {
        track.counted->snapshot_time.add(clock_.now() - began);
    }
    // Snapshots follow a fixed time grid, so that the average rate is exact. A pause or an extra snapshot restarts the
    // grid.
    track.next_snapshot += between;
    if (newcomer || track.changed || track.next_snapshot <= now) {
        track.next_snapshot = now + between;
    }
    track.newcomers_served = watch.newcomers;
    track.changed = false;
    track.shown_tick = entry.world.moment().tick;
}

void SimulationLoop::publish_events() {
    auto events = laboratory_.take_events();
    if (!events.empty()) {
        outputs_.events(laboratory_, std::move(events));
    }
}

} // namespace evod::runtime
