// How long it takes to turn a generation over at a million organisms: the statistics of the one that ended, breeding,
// new bodies, places, items, first state hashes.
#include "server/base/elementary.h"
#include "server/parameters/experiment.h"
#include "server/simulation/placement.h"
#include "server/simulation/world.h"
#include "server/jobs/thread_pool.h"

#include <benchmark/benchmark.h>

#include <chrono>
#include <cmath>
#include <fstream>
#include <functional>
#include <sstream>

namespace evod {
namespace {

enum World : std::int64_t { Bench, Crowded, Obstructed };

/// The benchmark's world; one of bodies of equal size that cover 0.4 of their island; one with a thousand obstacles and
/// as many crates.
parameters::Parameters parameters_of(std::int64_t world, std::int64_t organisms) {
    std::ifstream file{EVOD_EXPERIMENTS "/bench.json"};
    std::ostringstream text;
    text << file.rdbuf();
    parameters::Parameters parameters = parameters::parse_experiment(text.str()).value().parameters;
    parameters.population_size = static_cast<std::uint32_t>(organisms);
    if (world == Crowded) {
        const double radius = parameters.body_size_max * parameters.radius_per_unit_px;
        // A little less than 0.4, as the room of a centre ends before the walls.
        const double shrink = std::sqrt(base::pi * radius * radius / (organisms < 10'000 ? 0.35 : 0.398) / 46'080);
        parameters.body_size_min = parameters.body_size_max;
        parameters.island_width_px *= shrink;
        parameters.island_height_px *= shrink;
    }
    if (world == Obstructed) {
        parameters.obstacle_count = parameters.crate_count = 1000;
    }
    return parameters;
}

double seconds(const std::function<void()>& work) {
    const auto begin = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

/// Generations of two ticks. The time is that of turn_over() and of what the last tick takes longer than the first.
void turnover(benchmark::State& state) {
    jobs::ThreadPool executor{static_cast<std::size_t>(state.range(2))};
    parameters::Parameters parameters = parameters_of(state.range(0), state.range(1));
    parameters.generation_s = 2 * parameters.tick_s;
    simulation::World world{parameters, base::Seed{1}};
    double breeding_and_placing = 0, ending = 0;
    for (auto _ : state) {
        const double first = seconds([&] { world.advance_tick(executor); });
        const double end = std::max(seconds([&] { world.advance_tick(executor); }) - first, 0.0);
        const double begin = seconds([&] { world.turn_over(executor); });
        state.SetIterationTime(begin + end);
        breeding_and_placing += begin;
        ending += end;
    }
    state.counters["turn_over_s"] = benchmark::Counter(breeding_and_placing, benchmark::Counter::kAvgIterations);
    state.counters["end_s"] = benchmark::Counter(ending, benchmark::Counter::kAvgIterations);
}
BENCHMARK(turnover)
    ->ArgNames({"world", "organisms", "threads"})
    ->ArgsProduct({{Bench, Crowded, Obstructed}, {1'000, 1'000'000}, {1, 2}})
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseManualTime();

/// place_circles alone, where the bodies cover so many hundredths of the area.
void place_circles(benchmark::State& state) {
    jobs::ThreadPool executor{static_cast<std::size_t>(state.range(2))};
    const std::vector<float> radius(static_cast<std::size_t>(state.range(0)), 20);
    const physics::Coordinate side = physics::to_units(
        std::sqrt(base::pi * 400 * 100 / static_cast<double>(state.range(1)) * static_cast<double>(state.range(0))) +
        40);
    std::uint64_t generation = 0;
    for (auto _ : state) {
        benchmark::DoNotOptimize(
            simulation::place_circles(radius, base::Seed{1}, 0, ++generation, {side, side}, {}, executor));
    }
}
BENCHMARK(place_circles)
    ->ArgNames({"organisms", "covered", "threads"})
    ->ArgsProduct({{50, 1'000, 10'000, 1'000'000}, {1, 40}, {1, 2}})
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

/// A place for an item among so many obstacles, which cover a tenth of the island however many there are.
void item_place(benchmark::State& state) {
    const auto count = static_cast<std::uint32_t>(state.range(0));
    const physics::Area area{physics::to_units(9000.0), physics::to_units(5000.0)};
    const float half_size = count == 0 ? 0 : static_cast<float>(std::sqrt(0.1 * 9000 * 5000 / count) / 2);
    const simulation::BoxGrid obstacles{area, simulation::place_boxes({.obstacle_count = count,
                                                                       .crate_count = 0,
                                                                       .obstacle_half_size_px = half_size,
                                                                       .crate_half_size_px = 1,
                                                                       .crate_mass_kg = 1},
                                                                      base::Seed{1}, 0, 1, area)
                                                  .obstacles};
    const base::RandomKey key{base::Seed{1}, base::Purpose::ScenarioTest, 0, 1};
    std::uint32_t item = 0;
    for (auto _ : state) {
        base::RandomStream random{key, item++};
        benchmark::DoNotOptimize(simulation::random_place(random, area, 4, obstacles));
    }
}
BENCHMARK(item_place)->ArgName("obstacles")->Arg(0)->Arg(1)->Arg(30)->Arg(1'000);

} // namespace
} // namespace evod
