// Fuzz checkpoint: any bytes as the state in a checkpoint are refused, or give a world that continues.
//
// The first byte determines whether the rest is compressed, and the tick of the state.
#include "server/base/inline_executor.h"
#include "server/run_file/checkpoint.h"
#include "server/simulation/state_bytes.h"
#include "server/simulation/world.h"

#include <cstdlib>

namespace {

using namespace evod;

simulation::World beginning() {
    parameters::Parameters parameters;
    parameters.population_size = 3;
    parameters.island_count = 2;
    parameters.crate_count = 1;
    parameters.food_count = 2;
    parameters.poison_count = 2;
    parameters.respawn_s = 0.1;
    parameters.generation_s = 1;
    return {parameters, base::Seed{1}};
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const simulation::World first = beginning();
    static const std::vector<simulation::IslandShape> shapes = first.shapes();
    if (size == 0) {
        return 0;
    }
    const std::string_view bytes{reinterpret_cast<const char*>(data) + 1, size - 1};
    const std::uint64_t tick = data[0] % 128 % 62;
    simulation::WorldState state{.moment = {.tick = tick, .generation = 1, .generation_tick = tick, .simulated_s = 1},
                                 .parameters = first.parameters(),
                                 .islands = {},
                                 .ended = {}};
    const bool packed = data[0] >= 128;
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
    for (int ticks = 0; ticks < 3; ++ticks) {
        world.advance_tick(executor);
    }
    return 0;
}
