// Worlds that are unlike the benchmark world: what an organism-tick costs where organisms see far, stand close, live on
// long thin land, or are few among many items. On one thread.
//
// Benchmarks are named WORLD; items_per_second is organism-ticks a second, tick_us the length of a tick.
#include "server/base/elementary.h"
#include "server/base/inline_executor.h"
#include "server/simulation/world.h"
#include "tests/bench/experiment.h"

#include <benchmark/benchmark.h>

#include <chrono>
#include <cmath>
#include <stdexcept>

namespace evod::bench {
namespace {

using parameters::Parameters;

constexpr std::uint32_t organisms = 20'000;

/// The benchmark world with its own size and items, not any more by its population.
Parameters unscaled_world() {
    Parameters parameters = bench_world(organisms);
    const parameters::IslandPlan plan = parameters::island_plan(parameters);
    parameters.scale_with_population = false;
    parameters.island_width_px = plan.width_px;
    parameters.island_height_px = plan.height_px;
    parameters.food_count = plan.food_count;
    parameters.poison_count = plan.poison_count;
    return parameters;
}

Parameters far_sighted() {
    Parameters parameters = unscaled_world();
    parameters.food_radius_min = parameters.food_radius_max = 1000;
    parameters.poison_radius_min = parameters.poison_radius_max = 1000;
    return parameters;
}

/// A hundred times as long as wide.
Parameters thin() {
    Parameters parameters = unscaled_world();
    const double area = parameters.island_width_px * parameters.island_height_px;
    parameters.island_width_px = std::sqrt(100 * area);
    parameters.island_height_px = std::sqrt(area / 100);
    return parameters;
}

/// As dense as the default world, in organisms, food and poison.
Parameters default_density() {
    Parameters parameters = experiment("default");
    parameters.scale_with_population = true;
    parameters.reference_population = parameters.population_size;
    parameters.population_size = organisms;
    return parameters;
}

/// All as large as may be, on so little land that their bodies cover 0.3 of it; as many items as ever.
Parameters crowded() {
    Parameters parameters = unscaled_world();
    parameters.body_size_min = parameters.body_size_max;
    const double radius = parameters.body_size_max * parameters.radius_per_unit_px;
    const double shrink = std::sqrt(base::pi * radius * radius * organisms / 0.3 /
                                    (parameters.island_width_px * parameters.island_height_px));
    parameters.island_width_px *= shrink;
    parameters.island_height_px *= shrink;
    return parameters;
}

/// Ten organisms among a million food.
Parameters few_organisms() {
    Parameters parameters = unscaled_world();
    parameters.population_size = 10;
    parameters.food_count = 1'000'000;
    return parameters;
}

Parameters many_islands() {
    Parameters parameters = bench_world(500);
    parameters.island_count = 64;
    return parameters;
}

/// So many ticks of fresh worlds after their first second.
void ticks(benchmark::State& state, Parameters (*world_of)(), int measured_ticks) {
    constexpr int warm_up_ticks = 60; // as in workload_bench
    const Parameters parameters = world_of();
    if (!parameters::validate(parameters).empty()) {
        throw std::runtime_error{"density_bench: no valid world"};
    }
    base::InlineExecutor executor;
    std::uint64_t organism_ticks = 0;
    double measured_s = 0;
    for (auto _ : state) {
        simulation::World world{parameters, base::Seed{1}};
        for (int tick = 0; tick < warm_up_ticks; ++tick) {
            world.advance_tick(executor);
        }
        const auto begin = std::chrono::steady_clock::now();
        for (int tick = 0; tick < measured_ticks; ++tick) {
            organism_ticks += world.alive_count();
            world.advance_tick(executor);
        }
        const double s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
        state.SetIterationTime(s);
        measured_s += s;
    }
    state.SetItemsProcessed(static_cast<std::int64_t>(organism_ticks));
    state.counters["tick_us"] = 1e6 * measured_s / measured_ticks / static_cast<double>(state.iterations());
}

struct NamedWorld {
    const char* name;
    Parameters (*parameters)();
    int measured_ticks = 60;
};

const bool registered = [] {
    for (const NamedWorld& world :
         {NamedWorld{"as it is", unscaled_world}, NamedWorld{"far-sighted", far_sighted}, NamedWorld{"thin", thin},
          NamedWorld{"default density", default_density}, NamedWorld{"crowded", crowded},
          NamedWorld{"few organisms", few_organisms, 600}, NamedWorld{"many islands", many_islands}}) {
        benchmark::RegisterBenchmark(world.name, ticks, world.parameters, world.measured_ticks)
            ->Iterations(8)
            ->UseManualTime()
            ->Unit(benchmark::kMillisecond);
    }
    return true;
}();

} // namespace
} // namespace evod::bench
