// How long breeding the next generation takes: 100,000 and 1,000,000 chromosomes, on one thread and on two, for every
// choice of every stage with the other stages at their defaults, and for the slowest choices together; and the account
// of what selection did to the genes, beside it.
#include "server/evolution/next_generation.h"
#include "server/evolution/price.h"

#include "server/jobs/thread_pool.h"
#include "tests/unit/evolution/stage_choices.h"

#include <benchmark/benchmark.h>

#include <string>
#include <vector>

namespace evod::evolution {
namespace {

void breed(benchmark::State& state, const Parameters& parameters) {
    const auto count = static_cast<std::uint32_t>(state.range(0));
    jobs::ThreadPool executor{static_cast<std::size_t>(state.range(1))};
    const base::Seed seed{1};
    const GeneMatrix genes = initial_population(count, parameters, seed, 0);
    base::RandomStream random{{seed, base::Purpose::ScenarioTest, 0, 1}, 0};
    std::vector<double> fitness(count);
    for (double& value : fitness) {
        value = random.uniform(0, 300);
    }
    std::uint64_t generation = 0;
    for (auto _ : state) {
        const BreedingKey key{.seed = seed, .island = 0, .generation = ++generation};
        benchmark::DoNotOptimize(next_generation(fitness, genes, parameters, count, key, executor));
    }
    state.SetItemsProcessed(state.iterations() * count);
}

/// migrants_came  some places are taken by others than were born there.
void account(benchmark::State& state, bool migrants_came) {
    const auto count = static_cast<std::uint32_t>(state.range(0));
    jobs::ThreadPool executor{static_cast<std::size_t>(state.range(1))};
    const base::Seed seed{1};
    const Parameters parameters;
    const GeneMatrix before = initial_population(count, parameters, seed, 0);
    GeneMatrix bred_from = before;
    bred_from.leftCols(count / 100) += 1;
    base::RandomStream random{{seed, base::Purpose::ScenarioTest, 0, 1}, 0};
    std::vector<double> fitness(count);
    for (double& value : fitness) {
        value = random.uniform(0, 300);
    }
    const NextGeneration next =
        next_generation(fitness, before, parameters, count, {.seed = seed, .island = 0, .generation = 1}, executor);
    for (auto _ : state) {
        benchmark::DoNotOptimize(
            account_for(before, migrants_came ? bred_from : before, next.genes, next.parents, executor));
    }
    state.SetItemsProcessed(state.iterations() * count);
}

const bool registered = [] {
    for (const bool migrants_came : {false, true}) {
        benchmark::RegisterBenchmark(migrants_came ? "account_for/migrants" : "account_for", account, migrants_came)
            ->ArgNames({"chromosomes", "threads"})
            ->ArgsProduct({{100'000, 1'000'000}, {1, 2}})
            ->Unit(benchmark::kMillisecond)
            ->MeasureProcessCPUTime()
            ->UseRealTime();
    }
    for (const StageChoice& choice : stage_choices()) {
        benchmark::RegisterBenchmark(("next_generation/" + choice.name).c_str(), breed, choice)
            ->ArgNames({"chromosomes", "threads"})
            ->ArgsProduct({{100'000, 1'000'000}, {1, 2}})
            ->Unit(benchmark::kMillisecond)
            ->MeasureProcessCPUTime()
            ->UseRealTime();
    }
    return true;
}();

} // namespace
} // namespace evod::evolution
