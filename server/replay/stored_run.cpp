#include "server/replay/stored_run.h"
#include "server/run_file/check.h"

#include <algorithm>
#include <utility>

namespace evod::replay {

using base::Refusal;
using base::RefusalCode;
using base::Result;

namespace {

simulation::Replay replay_of_file(run_file::RunFile& file) {
    return {.replay_of = {},
            .first_generation = file.identity().first_generation,
            .last_generation = std::max(file.identity().first_generation, file.generations().last()),
            .first_tick = file.identity().first_tick,
            .last_tick = file.last_tick()};
}

/// Formats a range: "3 to 17".
std::string range_text(std::uint64_t first, std::uint64_t last) {
    return std::to_string(first) + (first == last ? "" : " to " + std::to_string(last));
}

Refusal not_found_refusal(const char* field, const std::string& there_are, std::uint64_t got) {
    return {.code = RefusalCode::NotFound,
            .message = std::string{"the run has no such "} + field + ": allowed: " + there_are,
            .violations = {{field, there_are, std::to_string(got)}},
            .reason = base::Reason::MomentNotFound};
}

Result<SeekTarget> find(run_file::RunFile& file, const WantedMoment& wanted, const simulation::Replay& there) {
    const auto generations = range_text(there.first_generation, there.last_generation);
    if (!wanted.generation) {
        const std::uint64_t tick = wanted.tick.value_or(there.last_tick);
        if (tick < there.first_tick || tick > there.last_tick) {
            return not_found_refusal("tick", range_text(there.first_tick, there.last_tick), tick);
        }
        return SeekTarget{file.generations().at_tick(tick), tick};
    }
    const std::uint64_t generation = *wanted.generation;
    if (generation < there.first_generation || generation > there.last_generation) {
        return not_found_refusal("generation", generations, generation);
    }
    const auto opening = file.generations().opening_of(generation);
    if (!opening) {
        return opening.error();
    }
    const std::uint64_t first = *opening ? (*opening)->moment.tick : there.first_tick;
    std::uint64_t last = there.last_tick;
    if (generation < there.last_generation) {
        const auto next = file.generations().opening_of(generation + 1);
        if (!next) {
            return next.error();
        }
        last = *next ? (*next)->moment.tick : last;
    }
    // A fork may begin in the middle of its first generation.
    const std::uint64_t begins = std::max(first, there.first_tick) - first;
    const std::uint64_t tick = wanted.tick.value_or(begins);
    if (tick < begins || tick > last - first) {
        return not_found_refusal(
            "tick", range_text(begins, last - first) + " in generation " + std::to_string(generation), tick);
    }
    return SeekTarget{generation, first + tick};
}

} // namespace

Result<StoredRun> StoredRun::of_file(const std::string& path) {
    const auto file = run_file::RunFile::open_checked(path);
    if (!file) {
        return file.error();
    }
    if (auto refused = (*file)->other_model()) {
        return *refused;
    }
    if (auto held = (*file)->pin_snapshot(); !held) {
        return held.error();
    }
    if (auto whole = check_end_mark(**file); !whole) {
        return whole.error();
    }
    return StoredRun{{path}, (*file)->identity().run_id};
}

Result<std::unique_ptr<run_file::RunFile>> StoredRun::open() const {
    std::optional<Refusal> refused;
    for (const std::string& path : paths_) {
        auto file = run_file::RunFile::open_read_only(path);
        if (file && (*file)->identity().run_id == run_id_) {
            return file;
        }
        if (!file && (!refused || refused->code == RefusalCode::NotFound)) {
            refused = file.error();
        }
    }
    return refused.value_or(
        Refusal{.code = RefusalCode::NotFound,
                .message = paths_.front() + " now contains another run: close this replay and open a new one",
                .violations = {}});
}

Result<std::string> StoredRun::world_name() const {
    const auto file = open();
    if (!file) {
        return file.error();
    }
    return (*file)->identity().name;
}

Result<SeekStart> StoredRun::start_seek(const std::optional<WantedMoment>& wanted, RecordedUntil recorded,
                                        base::Executor& executor, const base::StopCheck& stop) const {
    const auto file = open();
    if (!file) {
        return file.error();
    }
    if (auto held = (*file)->pin_snapshot(); !held) {
        return held.error();
    }
    simulation::Replay there = replay_of_file(**file);
    there.last_generation = std::max(there.last_generation, recorded.generation);
    there.last_tick = std::max(there.last_tick, recorded.tick);
    const auto to =
        find(**file, wanted.value_or(WantedMoment{.generation = there.first_generation, .tick = {}}), there);
    if (!to) {
        return to.error();
    }
    auto from = Rerun::before(**file, to->generation, to->tick, history_generations_known, executor, stop);
    if (!from) {
        return from.error();
    }
    return SeekStart{std::move(there), *to, *std::move(from)};
}

Result<NewRecords> StoredRun::new_records(std::uint64_t after_entry, const base::StopCheck& stop) const {
    const auto file = open();
    if (!file) {
        return file.error();
    }
    if (auto held = (*file)->pin_snapshot(); !held) {
        return held.error();
    }
    NewRecords records{.there = replay_of_file(**file),
                       .path = (*file)->path(),
                       .after_entry = after_entry,
                       .last_entry = std::max(after_entry, (*file)->journal().last_number()),
                       .changes = {}};
    auto changes = world_changes(**file, after_entry, stop);
    if (!changes) {
        return changes.error();
    }
    records.changes = *std::move(changes);
    return records;
}

} // namespace evod::replay
