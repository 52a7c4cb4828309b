#include "server/run_file/records.h"

#include <chrono>
#include <utility>

namespace evod::run_file {

GenerationBegun beginning_of(const simulation::World& world) {
    simulation::BredIslands bred = world.bred();
    return {.opening = world.opening(),
            .born = std::move(bred.islands),
            .founders = std::move(bred.founders),
            .openings = std::move(bred.openings)};
}

Checkpoint checkpoint_of(const simulation::World& world, std::uint64_t journal_entries, base::Executor& executor) {
    return {.state = world.state(executor), .hash = world.hash(), .journal_entries = journal_entries};
}

namespace {

/// The statistics of the generations before the first one of a fork.
Inherited inherited_by(const simulation::World& fork) {
    Inherited inherited{fork.history()};
    while (!inherited.history.empty() &&
           inherited.history.back().front().generation >= fork.opening().moment.generation) {
        inherited.history.pop_back();
    }
    return inherited;
}

} // namespace

RunIdentity identity_of(const simulation::World& world, std::string name, const simulation::RunId& run_id) {
    using namespace std::chrono;
    return {.name = std::move(name),
            .run_id = run_id,
            .seed = world.seed(),
            .parameters = world.parameters().active,
            .began_unix_ms = duration_cast<milliseconds>(system_clock::now().time_since_epoch()).count(),
            .first_generation = world.moment().generation,
            .first_tick = world.moment().tick,
            .first_population = world.first_population(),
            .schedule = world.schedule()};
}

RunBeginning beginning_of_run(const simulation::World& world, std::string name, const simulation::RunId& run_id) {
    return {.identity = identity_of(world, std::move(name), run_id), .generation = beginning_of(world)};
}

RunBeginning beginning_of_fork(const simulation::World& fork, std::string name, const simulation::RunId& run_id,
                               const simulation::RunId& origin, base::Executor& executor) {
    RunBeginning beginning = beginning_of_run(fork, std::move(name), run_id);
    beginning.inherited = inherited_by(fork);
    beginning.identity.forked_from = origin;
    beginning.identity.requested = fork.parameters().requested;
    beginning.identity.inherited_generations = beginning.inherited.history.size();
    if (!fork.is_as_begun()) { // the file does not contain the commands since the beginning of the generation
        beginning.state = checkpoint_of(fork, 0, executor);
    }
    if (fork.generation_over()) {
        beginning.ended = end_of(fork);
    }
    return beginning;
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
    case simulation::CauseOfDeath::Eaten:
        return "eaten";
    case simulation::CauseOfDeath::Old:
        return "old";
    }
    return "unknown";
}

} // namespace evod::run_file
