// Fuzz checkpoint: any bytes as the state in a checkpoint are refused, or give a world that continues.
//
// The first byte determines whether the rest is compressed, the tick of the state, and whether the world is a colony.
// If its lower seven bits are 124 or more, the rest is the opening of an interval.
#include "server/base/inline_executor.h"
#include "server/run_file/checkpoint.h"
#include "server/simulation/opening_check.h"
#include "server/simulation/state_bytes.h"
#include "server/simulation/world.h"

#include <cstdlib>

namespace {

using namespace evod;

simulation::World beginning(bool is_colony) {
    parameters::Parameters parameters;
    if (is_colony) {
        parameters.reproduction = parameters::Reproduction::Births;
        parameters.births = parameters::Births::Asexual;
        parameters.predator_count = 2;
    }
    parameters.population_size = 3;
    parameters.island_count = 2;
    parameters.crate_count = 1;
    parameters.food_count = 2;
    parameters.poison_count = 2;
    parameters.respawn_s = 0.1;
    parameters.generation_s = 1;
    return {parameters, base::Seed{1}};
}

/// An opening is refused, or is one with which an interval can begin.
void begin_interval(std::string_view bytes, bool packed, const simulation::World& first) {
    auto opening = packed ? run_file::unpack_opening(bytes) : simulation::read_opening(bytes);
    if (!opening) {
        return;
    }
    const parameters::ParameterSet& set = first.parameters();
    simulation::BredIslands bred;
    for (int island = 0; island < 2; ++island) {
        evolution::NextGeneration& born = bred.islands.emplace_back();
        born.genes.setConstant(evolution::body_gene_count, std::ssize(opening->numbers), 100);
        born.parents.resize(opening->numbers.size());
        born.predator_count = opening->predator_count;
        bred.openings.push_back(*opening);
        if (fault_of(*opening, born, set.active) != nullptr) {
            return;
        }
    }
    base::InlineExecutor executor;
    simulation::World world{base::Seed{1},
                            {.moment = {.tick = 60, .generation = 2}, .parameters = set, .progress = {}},
                            bred,
                            {},
                            executor};
    if (world.bred().openings != bred.openings) {
        std::abort();
    }
    for (int ticks = 0; ticks < 3 && world.outcome() == evolution::Outcome::Running; ++ticks) {
        world.advance_tick(executor);
    }
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const simulation::World worlds[] = {beginning(false), beginning(true)};
    if (size == 0) {
        return 0;
    }
    const std::string_view bytes{reinterpret_cast<const char*>(data) + 1, size - 1};
    const std::uint64_t tick = data[0] % 128 % 62;
    const bool is_colony = data[0] % 128 >= 62;
    const simulation::World& first = worlds[is_colony];
    const std::vector<simulation::IslandShape> shapes = first.shapes();
    simulation::WorldState state{.moment = {.tick = tick, .generation = 1, .generation_tick = tick, .simulated_s = 1},
                                 .parameters = first.parameters(),
                                 .islands = {},
                                 .ended = {}};
    const bool packed = data[0] >= 128;
    if (data[0] % 128 >= 124) {
        begin_interval(bytes, packed, first);
        return 0;
    }
    if (const auto read =
            packed ? run_file::unpack(bytes, shapes, state) : simulation::read_state(bytes, shapes, state);
        !read) {
        return 0;
    }
    base::InlineExecutor executor;
    simulation::World world = first.copy(executor);
    if (const auto restored = world.restore(state, executor); !restored) {
        if (restored.error().message.empty() || world.hash() != first.hash()) {
            std::abort();
        }
        return 0;
    }
    // Compressing and decompressing it again gives the same state.
    simulation::WorldState again;
    if (!run_file::unpack(run_file::pack(world.state(executor)), shapes, again) ||
        again.islands != world.state(executor).islands) {
        std::abort();
    }
    for (int ticks = 0; ticks < 3 && world.outcome() == evolution::Outcome::Running; ++ticks) {
        world.advance_tick(executor);
    }
    return 0;
}
