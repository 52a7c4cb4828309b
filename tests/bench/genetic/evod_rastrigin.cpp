// evod_rastrigin: evod's genetic algorithm on the function of Rastrigin; one run as one line of JSON.
//
// The algorithm of all programs of this folder, as near as each offers it: `population` chromosomes of six real genes
// with x in ±5.12; all replaced by children but the best, who is kept; tournaments of three; uniform crossover of every
// pair; a Gaussian step of standard deviation 1 with chance 0.15 per gene, clamped to the bounds. A gene is 150 + 25 x
// (simulation/fitness.h). Timed is everything from the first population on.
#include "server/base/inline_executor.h"
#include "server/simulation/world.h"
#include "tests/bench/stopwatch.h"

#include <CLI/CLI.hpp>
#include <boost/json.hpp>

#include <iostream>

namespace evod::bench {
namespace {

parameters::Parameters rastrigin_parameters(std::uint32_t population) {
    parameters::Parameters p;
    p.fitness = parameters::FitnessFunction::Rastrigin;
    p.population_size = population;
    p.population_model = evolution::PopulationModel::Generational;
    p.elite_count = 1;
    p.selection = evolution::SelectionMethod::Tournament;
    p.tournament_size = 3;
    p.crossover = evolution::CrossoverMethod::Uniform;
    p.crossover_chance = 1;
    p.creep = evolution::Creep::Gaussian;
    p.mutation_chance = 0.15;
    p.mutation_step = 25;
    p.initial_gene_min = p.normal_speed_min = p.impulse_min = p.body_size_min = p.base_health_min = p.food_radius_min =
        p.poison_radius_min = 22;
    p.initial_gene_max = p.normal_speed_max = p.impulse_max = p.body_size_max = p.base_health_max = p.food_radius_max =
        p.poison_radius_max = 278;
    return p;
}

int run(int argc, char** argv) {
    std::uint32_t population = 1000, generations = 100;
    std::uint64_t seed = 1;
    CLI::App app{"evod's genetic algorithm on the function of Rastrigin; prints one line of JSON."};
    app.add_option("--population", population)->capture_default_str();
    app.add_option("--generations", generations)->capture_default_str();
    app.add_option("--seed", seed)->capture_default_str();
    CLI11_PARSE(app, argc, argv);

    base::InlineExecutor executor;
    simulation::World world{rastrigin_parameters(population), base::Seed{seed}};
    const Stopwatch stopwatch;
    for (std::uint32_t generation = 0; generation < generations; ++generation) {
        world.advance_tick(executor);
    }
    const Seconds took = stopwatch.elapsed();
    std::cout << boost::json::object{{"program", "evod"},
                                     {"population", population},
                                     {"generations", generations},
                                     {"seed", seed},
                                     {"ms_per_generation", 1e3 * took.processor / generations},
                                     {"fitness_best", world.history().back()[0].fitness_best}}
              << '\n';
    return 0;
}

} // namespace
} // namespace evod::bench

int main(int argc, char** argv) {
    return evod::bench::run(argc, argv);
}
