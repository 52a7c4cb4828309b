#include "server/run_file/records.h"

#include <utility>

namespace evod::run_file {

GenerationBegun beginning_of(const simulation::World& world) {
    simulation::BredIslands bred = world.bred();
    return {.opening = world.opening(), .born = std::move(bred.islands), .founders = std::move(bred.founders)};
}

Inherited inherited_by(const simulation::World& world) {
    Inherited inherited{world.history()};
    // The loop leaves out the fork's own first generation, if that generation is over.
    while (!inherited.history.empty() &&
           inherited.history.back().front().generation >= world.opening().moment.generation) {
        inherited.history.pop_back();
    }
    return inherited;
}

Checkpoint checkpoint_of(const simulation::World& world, std::uint64_t journal_entries, base::Executor& executor) {
    return {.state = world.state(executor), .hash = world.hash(), .journal_entries = journal_entries};
}

GenerationEnded end_of(const simulation::World& world) {
    return {
        .generation = world.moment().generation, .outcomes = world.outcomes(), .statistics = world.history().back()};
}

std::string_view name_of(simulation::CauseOfDeath cause) {
    switch (cause) {
    case simulation::CauseOfDeath::Alive:
        return "alive";
    case simulation::CauseOfDeath::Starved:
        return "starved";
    case simulation::CauseOfDeath::Poisoned:
        return "poisoned";
    case simulation::CauseOfDeath::Removed:
        return "removed";
    }
    return "unknown";
}

} // namespace evod::run_file
