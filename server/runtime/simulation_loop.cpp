#include "server/runtime/simulation_loop.h"

#include "server/base/assert.h"
#include "server/base/overloaded.h"
#include "server/log/log.h"
#include "server/simulation/world_name.h"

#include <algorithm>
#include <memory>
#include <utility>

namespace evod::runtime {
namespace {

/// Returns how many ticks take about `time`, at least 1 and at most `most`.
std::uint64_t ticks_in(Clock::duration time, Clock::duration tick, std::int64_t most) {
    return static_cast<std::uint64_t>(tick.count() > 0 ? std::clamp<std::int64_t>(time / tick, 1, most) : 1);
}

std::optional<Clock::time_point> earlier(std::optional<Clock::time_point> a, std::optional<Clock::time_point> b) {
    return a && b ? std::min(*a, *b) : a ? a : b;
}

} // namespace

SimulationLoop::SimulationLoop(Mailbox& mailbox, StreamDemand& demand, base::Executor& executor, Clock& clock,
                               LoopOutputs outputs, simulation::Laboratory laboratory, recording::Recorder* recorder)
    : executor_{executor}
    , outputs_{std::move(outputs)}
    , laboratory_{std::move(laboratory)}
    , mailbox_{mailbox}
    , demand_{demand}
    , clock_{clock}
    , recorder_{recorder}
    , builds_{mailbox, executor}
    , file_faults_{laboratory_, recorder, builds_} {
    if (recorder_) {
        laboratory_.set_storage({});
        recorder_->set_receipt_sink(
            [reply = outputs_.reply](recording::Receipt receipt) { reply(std::move(receipt)); });
    }
    count_damaged_worlds();
}

std::optional<Clock::time_point> SimulationLoop::pass() {
    poll_storage();
    poll_run_files();
    poll_mailbox();
    answer_queries();
    poll_demand();

    contenders_.clear();
    list_contenders(contenders_);
    const Due due = advance_paced(contenders_);
    auto next = earlier(due.next, serve(contenders_, due));
    if (waiting_since_ && !laboratory_.storage()->worlds_wait()) {
        next = earlier(next, *waiting_since_ + slow_disk_patience);
    }
    next = earlier(next, answer_queries()); // answers queries until the next tick is due

    const auto now = clock_.now();
    next = earlier(next, refresh(now));
    for (const auto& entry : laboratory_.entries()) {
        Track& track = track_of(*entry);
        measure(*entry, track, now);
        show(*entry, track, now);
        if (track.counted) {
            track.counted->ticks_per_s.set(entry->ticks_per_s);
        }
    }
    return next;
}

SimulationLoop::Due SimulationLoop::advance_paced(std::vector<Contender>& contenders) {
    Due due;
    for (const auto& entry : laboratory_.entries()) {
        if (!wants_tick(*entry)) {
            continue;
        }
        Track& track = track_of(*entry);
        if (!entry->control.speed) {
            contenders.push_back({track.user, &track.turn, entry.get()});
            continue;
        }
        const auto now = clock_.now();
        if (track.pace.due() <= now) {
            if (entry->slowed && has_more_than_its_share(track.user, contenders)) {
                contenders.push_back({track.user, &track.turn, entry.get()});
                continue;
            }
            advance_slice(*entry, track, now + slice);
            shares_.spend(track.user, clock_.now() - now);
            if (!entry->wants_tick()) {
                continue;
            }
        }
        due.next = earlier(due.next, track.pace.due());
        if (!entry->slowed) {
            due.in_time = earlier(due.in_time, track.pace.due());
        }
    }
    return due;
}

bool SimulationLoop::has_more_than_its_share(const std::string& user, std::span<const Contender> contenders) const {
    const auto waits_with_less = [&, spent = shares_.spent(user)](std::string_view other) {
        return shares_.spent(other) + slice < spent;
    };
    return std::ranges::any_of(contenders, waits_with_less, &Contender::user) ||
           std::ranges::any_of(laboratory_.entries(), [&](const auto& entry) {
               return wants_tick(*entry) && waits_with_less(track_of(*entry).user);
           });
}

std::optional<Clock::time_point> SimulationLoop::serve(std::vector<Contender>& contenders, const Due& due) {
    if (contenders.empty()) {
        return std::nullopt;
    }
    const Contender& next = *std::ranges::min_element(contenders, {}, [this](const Contender& contender) {
        return std::pair{shares_.spent(contender.user), *contender.turn};
    });
    *next.turn = ++last_turn_;
    shares_.serve(next.user);
    const std::string user{next.user};
    const auto began = clock_.now();
    // A seek shares the processor with worlds that cannot keep their pace.
    const auto end = *earlier(began + slice, next.world != nullptr ? due.next : due.in_time);
    if (next.world != nullptr) {
        advance_slice(*next.world, track_of(*next.world), end);
    } else {
        advance_seek(next.seek, [&] { return clock_.now() >= end || mailbox_.pending() || demand_.changed(); });
    }
    const auto now = clock_.now();
    shares_.spend(user, now - began);
    if (contenders.size() > 1 || next.world == nullptr) {
        return now;
    }
    const simulation::Entry& world = *next.world;
    return !world.wants_tick() ? std::nullopt : std::optional{world.control.speed ? track_of(world).pace.due() : now};
}

void SimulationLoop::show_change(const std::string& world) {
    if (const auto track = tracks_.find(world); track != tracks_.end()) {
        track->second.snapshots.show_change();
    }
}

void SimulationLoop::handle(Mail& mail) {
    std::visit(
        base::Overloaded{
            [this](CommandMail& command) { apply(command); },
            [this](QueryMail& query) { queries_.add(std::move(query)); }, [this](FindRun& run) { find_run(run); },
            [this](ReplayMail& request) { answer(request); }, [this](WorldBrought& brought) { take(brought); },
            [this](SessionEnded& ended) { queries_.forget(ended.session); }, [this](WorldBuilt& built) { take(built); },
            [this](Ping&) { outputs_.reply(Pong{}); }, [](auto&) { EVOD_ASSERT(false); }},
        mail);
}

void SimulationLoop::poll_mailbox() {
    if (mailbox_.pending()) {
        mail_ = mailbox_.drain(std::move(mail_));
        for (Mail& mail : mail_) {
            handle(mail);
        }
        mail_.clear();
    }
    update_worlds();
    follow_worlds();
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
        if (!queries_.allows(now) && !time_is_free) {
            return woken ? now : queries_.next_at();
        }
        outputs_.reply(queries_.answer_next(laboratory_));
        const auto began = std::exchange(now, clock_.now());
        if (!time_is_free) {
            queries_.spend(now - began);
        }
        if (mailbox_.pending()) {
            poll_mailbox(); // commands do not wait for queries
            woken = true;
        }
    }
    return woken ? std::optional{now} : std::nullopt;
}

bool SimulationLoop::is_work_due(Clock::time_point now) const {
    return is_seeking() || std::ranges::any_of(laboratory_.entries(), [&](const auto& entry) {
               return wants_tick(*entry) && (!entry->control.speed || track_of(*entry).pace.due() <= now);
           });
}

base::Result<FoundRun> SimulationLoop::run_of(const simulation::Entry& entry) const {
    if (!recorder_) {
        return refusal(base::RefusalCode::FailedPrecondition,
                       "this server stores no runs, so it cannot replay them: start it without --keep-nothing",
                       base::Reason::RunsNotKept);
    }
    const simulation::Moment& now = entry.world.moment();
    return FoundRun{.world = entry.name,
                    .run = {recorder_->paths_of(entry.name, entry.run_id), entry.run_id},
                    .generation = now.generation,
                    .until = {.generation = now.generation, .tick = now.tick}};
}

void SimulationLoop::find_run(const FindRun& mail) {
    const auto entry = std::as_const(laboratory_).find(mail.world);
    if (!entry) {
        const simulation::DamagedWorld* damaged = laboratory_.find_damaged(mail.world);
        const auto* request = std::get_if<std::shared_ptr<const v1::Request>>(&mail.purpose);
        if (damaged && damaged->run_id && request && (*request)->has_export_run()) {
            const replay::StoredRun run{recorder_->paths_of(damaged->name, *damaged->run_id), *damaged->run_id};
            return outputs_.reply(RunFound{mail, FoundRun{damaged->name, run}});
        }
        return outputs_.reply(RunFound{mail, entry.error()});
    }
    auto run = run_of(**entry);
    if (!run) {
        return outputs_.reply(RunFound{mail, run.error()});
    }
    recording::RunRecorder* const recorder = recorder_->of((*entry)->name);
    if (recorder == nullptr || recorder_->refusal()) {
        run->until = {}; // nothing more will be written
        return outputs_.reply(RunFound{mail, *std::move(run)});
    }
    const recording::Ticket ticket = ++last_ticket_;
    outputs_.reply(RunFound{mail, *std::move(run), ticket});
    recorder->once_written(ticket);
}

void SimulationLoop::answer(const ReplayMail& mail) {
    const std::string& world =
        std::visit([](const auto& request) -> const std::string& { return request.world; }, mail.request);
    const auto entry = std::as_const(laboratory_).find(world);
    base::Refusal refused = entry ? simulation::no_such_replay(world) : entry.error();
    if (entry && std::holds_alternative<Seek>(mail.request)) {
        refused =
            base::refusal(base::RefusalCode::FailedPrecondition,
                          "this world is live and cannot be moved to another moment: open a replay of its run, as "
                          "evoview and evoctl stats --at-generation do, or serve its run file with evod replay",
                          base::Reason::WorldIsLive);
    }
    outputs_.reply(ReplayDone{.mail = mail, .world = std::move(refused)});
}

void SimulationLoop::close() {
    poll_mailbox();
    while (builds_.holds("")) {
        mailbox_.wait(std::nullopt);
        poll_mailbox();
    }
    while (!queries_.empty()) {
        outputs_.reply(queries_.answer_next(laboratory_));
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
        track.snapshots.set_demand(watch == watches_.end() ? nullptr : &watch->second);
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

void SimulationLoop::follow(simulation::Entry& entry) {
    auto found = tracks_.find(entry.name);
    if (found == tracks_.end()) {
        found = tracks_.emplace(entry.name, Track{}).first;
        found->second.user = user_of(entry);
        if (const auto watch = watches_.find(entry.name); watch != watches_.end()) {
            found->second.snapshots.set_demand(&watch->second);
        }
        if (outputs_.counted != nullptr && !simulation::is_replay_name(entry.name)) {
            found->second.counted = outputs_.counted->add(entry.name);
        }
    }
    Track& track = found->second;
    if (recorder_) {
        track.recorder = recorder_->of(entry.name);
    }
    // A short wait for the disk does not count as a pause.
    const bool runs =
        entry.wants_tick() && !(entry.storage && entry.storage->worlds_wait()) && !builds_.holds(entry.name);
    if (track.pace.follow(entry, runs, clock_.now())) {
        track.snapshots.show_change(); // the state changed, as after a Pause
    }
}

void SimulationLoop::advance_slice(simulation::Entry& entry, Track& track, Clock::time_point end) {
    const bool paced = entry.control.speed.has_value();
    auto before = clock_.now();
    do {
        const std::uint64_t ticks_per_clock_reading = ticks_in(between_clock_readings, track.pace.tick_time(), 100);
        std::uint64_t taken = 0;
        bool stopped = false;
        do {
            taken += advance(entry, track);
            if (track.recorder) {
                track.recorder->follow(entry.world);
            }
            after_tick(entry);
            stopped = !entry.wants_tick();
            publish_events();
        } while (!paced && taken < ticks_per_clock_reading && !stopped && !mailbox_.pending());
        const auto now = clock_.now();
        const auto spent = now - std::exchange(before, now);
        track.pace.advanced(entry, taken, spent, now);
        if (stopped) {
            track.pace.stop(entry);
            track.snapshots.show_change(); // the world has reached a goal
        }
        measure(entry, track, now);
        show(entry, track, now);
        if (track.counted) {
            track.counted->tick_time.add(track.pace.tick_time(), taken);
        }
        make_due_checkpoint(entry, track, spent);
        if (stopped || now >= end || (paced && track.pace.due() > now)) {
            return;
        }
    } while (!mailbox_.pending() && !demand_.changed());
}

std::uint64_t SimulationLoop::advance(simulation::Entry& entry, Track& track) {
    const std::uint64_t before = entry.world.moment().tick;
    std::uint64_t ticks = 1;
    if (entry.world.is_shared() && !entry.control.speed) {
        const std::uint64_t to_next_hash = run_file::ticks_per_hash - before % run_file::ticks_per_hash;
        ticks = std::min(ticks_in(between_exchanges, track.pace.tick_time(), run_file::ticks_per_hash), to_next_hash);
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
    if (track.pace.measure(entry, now)) {
        track.snapshots.show_change();
    }
}

void SimulationLoop::show(const simulation::Entry& entry, Track& track, Clock::time_point now) {
    if (!track.snapshots.is_due(entry.world, now)) {
        return;
    }
    track.snapshots.list_islands(entry.world, island_indices_);
    const auto began = clock_.now();
    outputs_.snapshot(pool_.take(entry, island_indices_, track.snapshots.shows_change()));
    if (track.counted) {
        track.counted->snapshot_time.add(clock_.now() - began);
    }
    track.snapshots.taken(entry.world, now);
}

void SimulationLoop::publish_events() {
    auto events = laboratory_.take_events();
    if (!events.empty()) {
        outputs_.events(laboratory_, std::move(events));
    }
}

} // namespace evod::runtime
