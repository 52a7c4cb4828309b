#include "server/run_file/records.h"

#include "server/base/assert.h"

namespace evod::run_file {

GenerationBegun beginning_of(const simulation::World& world) {
    GenerationBegun begun{.opening = world.opening(), .born = {}, .founders = world.founders_of_bred()};
    for (const simulation::Island& island : world.islands()) {
        begun.born.push_back(island.bred());
    }
    return begun;
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
    EVOD_ASSERT(world.generation_over());
    GenerationEnded ended{
        .generation = world.moment().generation, .outcomes = {}, .statistics = world.history().back()};
    for (std::size_t i = 0; i < world.islands().size(); ++i) {
        const simulation::Fate& fate = world.islands()[i].fate();
        ended.outcomes.push_back({world.fitness()[i], fate.lived_ticks, fate.cause});
    }
    return ended;
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
