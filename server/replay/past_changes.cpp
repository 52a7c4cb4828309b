#include "server/replay/past_changes.h"

#include <algorithm>
#include <set>
#include <string>
#include <tuple>
#include <vector>

namespace evod::replay {
namespace {

/// Assignments of the schedule, of a planned change or of a command, and where the run applied them.
struct Due {
    // The order in which a run applies assignments. When a generation begins: the values of the schedule, then planned
    // changes. After a tick of the generation: planned changes, then commands.
    enum Kind { Schedule, PlannedForGeneration, PlannedForTick, Command };
    std::uint64_t reached; // the generation that begins, or to which the tick belongs
    std::uint64_t place;   // 0 when a generation begins; otherwise 1 + the tick after which it was applied
    Kind kind;
    std::uint64_t generation; // Change::generation
    const std::vector<parameters::Assignment>* assignments;
    const base::Actor* by;

    auto order() const { return std::tuple{reached, place, kind}; }
};

} // namespace

simulation::Changes past_changes(run_file::RunFile& file, std::span<const WorldChange> changes,
                                 std::uint64_t after_entry, const simulation::Moment& moment) {
    const run_file::RunIdentity& identity = file.identity();
    changes = {changes.begin(), std::ranges::upper_bound(changes, after_entry, {}, &WorldChange::entry)};
    std::set<std::uint64_t> cancelled; // ids of planned changes
    for (const WorldChange& change : changes) {
        if (change.cancels) {
            cancelled.insert(*change.cancels);
        }
    }
    const base::Actor the_schedule;
    std::vector<Due> due; // commands and planned changes in order of the journal
    const auto add_at_tick = [&](const WorldChange& change, std::uint64_t tick, Due::Kind kind) {
        due.push_back({file.generations().at_tick(tick), tick + 1, kind, file.generations().at_tick(tick + 1),
                       &change.assignments, &change.by});
    };
    std::uint64_t planned_count = 0;
    for (const WorldChange& change : changes) {
        if (change.checked) {
            continue;
        }
        if (!change.at) {
            add_at_tick(change, change.tick, Due::Command);
        } else if (cancelled.contains(++planned_count)) {
            continue;
        } else if (change.at->tick && *change.at->tick <= moment.tick) {
            add_at_tick(change, *change.at->tick, Due::PlannedForTick);
        } else if (change.at->generation && *change.at->generation <= moment.generation) {
            due.push_back({*change.at->generation, 0, Due::PlannedForGeneration, *change.at->generation,
                           &change.assignments, &change.by});
        }
    }
    for (const auto& [generation, assignments] : identity.schedule.changes()) {
        if (generation > identity.first_generation && generation <= moment.generation) {
            due.push_back({generation, 0, Due::Schedule, generation, &assignments, &the_schedule});
        }
    }
    simulation::Changes past;
    if (due.empty()) {
        return past;
    }
    std::ranges::stable_sort(due, {}, &Due::order);
    parameters::ParameterSet set{identity.parameters, identity.requested_parameters(), 1};
    std::uint64_t bred = identity.first_generation; // the last generation whose values are in effect in `set`
    for (const Due& now : due) {
        const bool begins = now.kind == Due::Schedule || now.kind == Due::PlannedForGeneration;
        if (const std::uint64_t last_bred = now.reached - (begins ? 1 : 0); bred < last_bred) {
            set.active = taking_effect(set.active, set.requested, base::Effect::NextGeneration);
            bred = last_bred;
        }
        const auto requested =
            begins ? request_at_generation(set, *now.assignments) : request_of(set, *now.assignments);
        if (requested) { // otherwise the run dropped the change
            past.add(now.generation, *now.by, set.requested, *requested);
            if (begins) {
                set.requested = *requested; // it takes effect when the generation is bred
            } else {
                set = after_request(set, *requested);
            }
        }
    }
    return past;
}

} // namespace evod::replay
