// Ticks of whole worlds: the default one, and the benchmark's at several populations, on one thread.
//
// items_per_second is organism-ticks per second: organisms alive at the start of each tick, summed, by processor time.
#include "server/base/inline_executor.h"
#include "server/simulation/world.h"
#include "tests/bench/experiment.h"

#include <benchmark/benchmark.h>

namespace evod {
namespace {

void advance(benchmark::State& state, const parameters::Parameters& parameters) {
    base::InlineExecutor executor;
    simulation::World world{parameters, base::Seed{1}};
    std::uint64_t organism_ticks = 0;
    for (auto _ : state) {
        organism_ticks += world.generation_over() ? parameters.population_size : world.alive_count();
        world.advance_tick(executor);
    }
    state.SetItemsProcessed(static_cast<std::int64_t>(organism_ticks));
    state.counters["real_time_factor"] = benchmark::Counter(world.moment().simulated_s, benchmark::Counter::kIsRate);
}

/// Turnovers of generations included, as they come.
void default_world(benchmark::State& state) {
    advance(state, bench::experiment("default"));
}
BENCHMARK(default_world)->Unit(benchmark::kMicrosecond)->MinTime(3);

void benchmark_world(benchmark::State& state) {
    advance(state, bench::bench_world(static_cast<std::uint32_t>(state.range(0))));
}
BENCHMARK(benchmark_world)->Arg(100)->Arg(1'000)->Arg(10'000)->Arg(100'000)->Unit(benchmark::kMicrosecond)->MinTime(3);

} // namespace
} // namespace evod
