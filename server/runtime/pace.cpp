#include "server/runtime/pace.h"

#include "server/simulation/world_name.h"

#include <algorithm>
#include <array>
#include <span>
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

/// Counts the species of a colony at the end of a generation.
void count_species(std::span<const simulation::GenerationStatistics> islands, std::array<metrics::Species, 2>& to) {
    std::array<double, 2> living{};
    std::array<std::uint64_t, 2> born{};
    std::array<bool, 2> has_come{};
    const auto add = [&](std::size_t species, const simulation::GenerationStatistics& of) {
        living[species] += of.alive_count;
        born[species] += of.colony ? of.colony->born_count : 0;
        has_come[species] = has_come[species] || of.colony;
    };
    for (const simulation::GenerationStatistics& island : islands) {
        add(0, island);
        for (const simulation::GenerationStatistics& predators : island.predators) {
            add(1, predators);
        }
    }
    for (std::size_t species = 0; species < to.size(); ++species) {
        if (has_come[species] || to[species].counted.value() > 0) {
            to[species].living.set(living[species]);
            to[species].born.add(born[species]);
            to[species].counted.add();
        }
    }
}

} // namespace

void Pace::follow_worlds() {
    for (const auto& entry : laboratory_.entries()) {
        follow(*entry);
    }
    if (world_data_.size() > laboratory_.entries().size()) {
        std::erase_if(world_data_, [this](const auto& item) {
            return std::ranges::none_of(laboratory_.entries(),
                                        [&](const auto& entry) { return entry->name == item.first; });
        });
    }
}

void Pace::follow(simulation::Entry& entry) {
    auto found = world_data_.find(entry.name);
    if (found == world_data_.end()) {
        found = world_data_.emplace(entry.name, WorldData{}).first;
        if (const auto wanted = demand_.find(entry.name); wanted != demand_.end()) {
            found->second.snapshots.set_demand(&wanted->second);
        }
        if (outputs_.counted != nullptr && !simulation::is_replay_name(entry.name)) {
            found->second.counted = outputs_.counted->add(entry.name);
        }
    }
    WorldData& data = found->second;
    data.user = rules_.user_of(entry);
    if (recorder_) {
        data.recorder = recorder_->of(entry.name);
    }
    // A short wait for the disk does not count as a pause.
    const bool runs = entry.wants_tick() && !(entry.storage && entry.storage->worlds_wait()) && !rules_.is_held(entry);
    if (data.pace.follow(entry, runs, tools_.clock.now())) {
        data.snapshots.show_change(); // the state changed, as after a Pause
    }
}

void Pace::show_change(const std::string& world) {
    if (const auto data = world_data_.find(world); data != world_data_.end()) {
        data->second.snapshots.show_change();
    }
}

void Pace::set_demand(WorldDemands demand) {
    demand_ = std::move(demand);
    for (auto& [name, data] : world_data_) {
        const auto wanted = demand_.find(name);
        data.snapshots.set_demand(wanted == demand_.end() ? nullptr : &wanted->second);
    }
}

std::optional<Clock::time_point> Pace::advance(std::vector<Contender>& contenders) {
    const Due due = advance_paced(contenders);
    return earlier(due.next, serve(contenders, due));
}

Pace::Due Pace::advance_paced(std::vector<Contender>& contenders) {
    Due due;
    for (const auto& entry : laboratory_.entries()) {
        if (!wants_tick(*entry)) {
            continue;
        }
        WorldData& data = data_of(*entry);
        if (!entry->control.speed) {
            contenders.push_back({data.user, &data.turn, entry.get()});
            continue;
        }
        const auto now = tools_.clock.now();
        if (data.pace.due() <= now) {
            if (entry->slowed && has_more_than_its_share(data.user, contenders)) {
                contenders.push_back({data.user, &data.turn, entry.get()});
                continue;
            }
            advance_slice(*entry, data, now + slice);
            if (!has_more_than_its_share(data.user, contenders)) {
                shares_.serve(data.user); // users who want nothing now do not save time
            }
            shares_.spend(data.user, tools_.clock.now() - now);
            if (!entry->wants_tick()) {
                continue;
            }
        }
        due.next = earlier(due.next, data.pace.due());
        if (!entry->slowed) {
            due.in_time = earlier(due.in_time, data.pace.due());
        }
    }
    return due;
}

bool Pace::has_more_than_its_share(const std::string& user, std::span<const Contender> contenders) const {
    const auto waits_with_less = [&, spent = shares_.spent(user)](std::string_view other) {
        return shares_.spent(other) + slice < spent;
    };
    return std::ranges::any_of(contenders, waits_with_less, &Contender::user) ||
           std::ranges::any_of(laboratory_.entries(), [&](const auto& entry) {
               return wants_tick(*entry) && waits_with_less(data_of(*entry).user);
           });
}

std::optional<Clock::time_point> Pace::serve(std::vector<Contender>& contenders, const Due& due) {
    if (contenders.empty()) {
        return std::nullopt;
    }
    const Contender& next = *std::ranges::min_element(contenders, {}, [this](const Contender& contender) {
        return std::pair{shares_.spent(contender.user), *contender.turn};
    });
    *next.turn = ++last_turn_;
    shares_.serve(next.user);
    const std::string user{next.user};
    const auto began = tools_.clock.now();
    // A seek shares the processor with worlds that cannot keep their pace.
    const auto end = *earlier(began + slice, next.world != nullptr ? due.next : due.in_time);
    if (next.world != nullptr) {
        advance_slice(*next.world, data_of(*next.world), end);
    } else {
        rules_.advance_seek(next.seek, [&] {
            return tools_.clock.now() >= end || tools_.mailbox.pending() || tools_.demand.changed();
        });
    }
    const auto now = tools_.clock.now();
    shares_.spend(user, now - began);
    if (contenders.size() > 1 || next.world == nullptr) {
        return now;
    }
    const simulation::Entry& world = *next.world;
    return !world.wants_tick() ? std::nullopt : std::optional{world.control.speed ? data_of(world).pace.due() : now};
}

bool Pace::is_work_due(Clock::time_point now) const {
    return std::ranges::any_of(laboratory_.entries(), [&](const auto& entry) {
        return wants_tick(*entry) && (!entry->control.speed || data_of(*entry).pace.due() <= now);
    });
}

void Pace::measure_and_show(Clock::time_point now) {
    for (const auto& entry : laboratory_.entries()) {
        WorldData& data = data_of(*entry);
        measure_and_show(*entry, data, now);
        if (data.counted) {
            data.counted->ticks_per_s.set(entry->ticks_per_s);
        }
    }
}

void Pace::advance_slice(simulation::Entry& entry, WorldData& data, Clock::time_point end) {
    const bool paced = entry.control.speed.has_value();
    auto before = tools_.clock.now();
    do {
        const std::uint64_t ticks_per_clock_reading = ticks_in(between_clock_readings, data.pace.tick_time(), 100);
        std::uint64_t taken = 0;
        bool stopped = false;
        do {
            taken += advance(entry, data);
            if (data.recorder) {
                data.recorder->follow(entry.world);
            }
            rules_.after_tick(entry);
            stopped = !entry.wants_tick();
            outputs_.publish_events(laboratory_);
        } while (!paced && taken < ticks_per_clock_reading && !stopped && !tools_.mailbox.pending());
        const auto now = tools_.clock.now();
        const auto spent = now - std::exchange(before, now);
        data.pace.advanced(entry, taken, spent, now);
        if (stopped) {
            data.pace.stop(entry);
            data.snapshots.show_change(); // the world has reached a goal
        }
        measure_and_show(entry, data, now);
        if (data.counted) {
            data.counted->tick_time.add(data.pace.tick_time(), taken);
        }
        make_due_checkpoint(entry, data, spent);
        if (stopped || now >= end || (paced && data.pace.due() > now)) {
            return;
        }
    } while (!tools_.mailbox.pending() && !tools_.demand.changed());
}

std::uint64_t Pace::advance(simulation::Entry& entry, WorldData& data) {
    const std::uint64_t before = entry.world.moment().tick;
    std::uint64_t ticks = 1;
    if (entry.world.is_shared() && !entry.control.speed) {
        const std::uint64_t to_next_hash = run_file::ticks_per_hash - before % run_file::ticks_per_hash;
        ticks = std::min(ticks_in(between_exchanges, data.pace.tick_time(), run_file::ticks_per_hash), to_next_hash);
    }
    laboratory_.advance(entry, ticks, tools_.executor);
    if (data.counted && entry.world.generation_over()) {
        count_species(entry.world.history().back(), data.counted->species);
    }
    return entry.world.moment().tick - before;
}

void Pace::make_due_checkpoint(const simulation::Entry& entry, WorldData& data, Clock::duration spent) {
    if (!data.recorder || !data.recorder->checkpoint_due(entry.world, spent)) {
        return;
    }
    const auto began = tools_.clock.now();
    data.recorder->make_checkpoint(entry.world, tools_.executor);
    data.recorder->checkpoint_took(tools_.clock.now() - began);
}

void Pace::measure_and_show(simulation::Entry& world, WorldData& data, Clock::time_point now) {
    if (data.pace.measure(world, now)) {
        data.snapshots.show_change();
    }
    if (!data.snapshots.is_due(world.world, now)) {
        return;
    }
    const auto began = tools_.clock.now();
    outputs_.snapshot(pool_.take(world, data.snapshots.wanted_islands(world.world), data.snapshots.shows_change()));
    if (data.counted) {
        data.counted->snapshot_time.add(tools_.clock.now() - began);
    }
    data.snapshots.taken(world.world, now);
}

} // namespace evod::runtime
