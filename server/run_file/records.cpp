#include "server/run_file/records.h"

#include "server/base/assert.h"
#include "server/simulation/share.h"

namespace evod::run_file {

namespace {

/// Collects the islands of all processes that share the world on rank 0. All processes must call it.
///
/// pack    pack(packer, island) writes an island of this process.
/// unpack  unpack(unpacker, island) reads one of another process.
template <class Pack, class Unpack>
void collect_islands(const simulation::World& world, Pack&& pack, Unpack&& unpack) {
    base::Exchange& exchange = world.exchange();
    if (exchange.size() == 1) {
        return;
    }
    base::Packer packer;
    for (std::size_t island = world.share().begin; exchange.rank() > 0 && island < world.share().end; ++island) {
        pack(packer, island);
    }
    const std::vector<std::string> parts = exchange.collect(packer.take());
    std::size_t island = world.share().end; // rank 0 has the first islands
    for (std::size_t rank = 1; rank < parts.size(); ++rank) {
        for (base::Unpacker unpacker{parts[rank]}; !unpacker.empty(); ++island) {
            unpack(unpacker, island);
        }
    }
}

} // namespace

GenerationBegun beginning_of(const simulation::World& world) {
    GenerationBegun begun{.opening = world.opening(), .born = {}, .founders = world.founders_of_bred()};
    for (const simulation::Island& island : world.islands()) {
        begun.born.push_back(island.bred());
    }
    collect_islands(
        world,
        [&](base::Packer& packer, std::size_t island) {
            simulation::pack(packer, begun.born[island]);
            if (!begun.founders.empty()) {
                packer.add_list(begun.founders[island]);
            }
        },
        [&](base::Unpacker& unpacker, std::size_t island) {
            begun.born[island] = simulation::unpack_generation(unpacker);
            if (!begun.founders.empty()) {
                begun.founders[island] = unpacker.next_list<std::uint32_t>();
            }
        });
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
    collect_islands(
        world,
        [&](base::Packer& packer, std::size_t island) {
            const IslandOutcome& outcome = ended.outcomes[island];
            packer.add_list(outcome.fitness);
            packer.add_list(outcome.lived_ticks);
            packer.add_list(outcome.cause);
        },
        [&](base::Unpacker& unpacker, std::size_t island) {
            IslandOutcome& outcome = ended.outcomes[island];
            outcome.fitness = unpacker.next_list<double>();
            outcome.lived_ticks = unpacker.next_list<std::uint32_t>();
            outcome.cause = unpacker.next_list<simulation::CauseOfDeath>();
        });
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
