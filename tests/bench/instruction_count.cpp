// instruction_count: fixed pieces of work whose instructions callgrind counts; see instruction_count.py.
//
// instruction_count WORK [--instructions NAME] does everything that is needed before the work, then the work
// inside counted_work(), which is what callgrind counts; one thread.
#include "server/base/inline_executor.h"
#include "server/evolution/next_generation.h"
#include "server/simulation/world.h"
#include "tests/bench/experiment.h"
#include "tests/bench/instructions_option.h"

#include <CLI/CLI.hpp>
#include <boost/json.hpp>

#include <functional>
#include <iostream>
#include <map>
#include <string>
#include <vector>

extern "C" {
/// The only code that is counted; it has a name that no compiler changes.
[[gnu::noinline]] void counted_work(const std::function<void()>& work) {
    work();
}
}

namespace evod::bench {
namespace {

/// Does the work and says how many units of it there were.
using Work = std::function<std::uint64_t()>;

/// 60 ticks of the benchmark world with 2,000 organisms, a second after its start. Unit: an organism and tick.
std::uint64_t ticks() {
    base::InlineExecutor executor;
    simulation::World world{bench_world(2'000), base::Seed{1}};
    for (int tick = 0; tick < 60; ++tick) {
        world.advance_tick(executor);
    }
    std::uint64_t organism_ticks = 0;
    counted_work([&] {
        for (int tick = 0; tick < 60; ++tick) {
            organism_ticks += world.alive_count();
            world.advance_tick(executor);
        }
    });
    return organism_ticks;
}

/// The second generation of the default world, its breeding and placing included. Unit: an organism and tick.
std::uint64_t generation() {
    base::InlineExecutor executor;
    simulation::World world{experiment("default"), base::Seed{1}};
    while (!world.generation_over()) {
        world.advance_tick(executor);
    }
    std::uint64_t organism_ticks = 0;
    counted_work([&] {
        do {
            organism_ticks += world.generation_over() ? world.parameters().active.population_size : world.alive_count();
            world.advance_tick(executor);
        } while (!world.generation_over());
    });
    return organism_ticks;
}

/// One breeding of 20,000 chromosomes with the default stages. Unit: a chromosome.
std::uint64_t breeding() {
    base::InlineExecutor executor;
    const evolution::Parameters parameters;
    constexpr std::uint32_t count = 20'000;
    const evolution::GeneMatrix genes = evolution::initial_population(count, parameters, base::Seed{1}, 0);
    base::RandomStream random{{base::Seed{1}, base::Purpose::ScenarioTest, 0, 1}, 0};
    std::vector<double> fitness(count);
    for (double& value : fitness) {
        value = random.uniform(0, 300);
    }
    counted_work(
        [&] { evolution::next_generation(fitness, genes, parameters, count, {.seed = base::Seed{1}}, executor); });
    return count;
}

int run(int argc, char** argv) {
    const std::map<std::string, Work> works = {{"ticks", ticks}, {"generation", generation}, {"breeding", breeding}};
    std::string work = "ticks";
    bool list = false;
    CLI::App app{"Does a fixed piece of work, to be counted by callgrind; prints how many units it was as JSON."};
    app.add_option("work", work, "ticks, generation or breeding")->check(CLI::IsMember(works));
    app.add_flag("--list", list, "print the sets of instructions that this processor has, and nothing else");
    add_instructions_option(app);
    CLI11_PARSE(app, argc, argv);
    if (list) {
        for (const std::string_view name : base::available_instructions()) {
            std::cout << name << '\n';
        }
        return 0;
    }
    std::cout << boost::json::object{{"work", work},
                                     {"units", works.at(work)()},
                                     {"compiler", EVOD_COMPILER},
                                     {"instruction_set", base::name_of(base::instructions())}}
              << '\n';
    return 0;
}

} // namespace
} // namespace evod::bench

int main(int argc, char** argv) {
    return evod::bench::run(argc, argv);
}
