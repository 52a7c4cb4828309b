// galib_rastrigin: GAlib on the function of Rastrigin, with the algorithm that evod_rastrigin.cpp describes.
//
// GAlib's own tournament draws its two contestants by a roulette wheel; so the plain tournament of three is written
// here, on its interface for selection schemes. It works in float, as evod's genes are.
#include "server/simulation/fitness.h"
#include "tests/bench/stopwatch.h"

#include <CLI/CLI.hpp>
#include <boost/json.hpp>
#define INSTANTIATE_REAL_GENOME
#include <ga/GARealGenome.h>
#include <ga/GASimpleGA.h>

#include <iostream>

namespace evod::bench {
namespace {

std::uint64_t evaluation_count = 0;

float fitness(GAGenome& genome) {
    ++evaluation_count;
    const auto& x = static_cast<GARealGenome&>(genome);
    evolution::BodyGenes genes;
    for (int gene = 0; gene < static_cast<int>(evolution::body_gene_count); ++gene) {
        genes(gene) = 150 + 25 * x.gene(static_cast<unsigned>(gene));
    }
    return static_cast<float>(simulation::rastrigin(genes));
}

class Tournament final : public GASelectionScheme {
  public:
    GASelectionScheme* clone() const override { return new Tournament; } // owned by the population, as GAlib wants it
    GAGenome& select() const override {
        GAGenome* best = &contestant();
        for (int other = 1; other < 3; ++other) {
            if (GAGenome& next = contestant(); next.score() > best->score()) {
                best = &next;
            }
        }
        return *best;
    }

  private:
    GAGenome& contestant() const { return pop->individual(static_cast<unsigned>(GARandomInt(0, pop->size() - 1))); }
};

int run(int argc, char** argv) {
    int population = 1000, generations = 100;
    unsigned seed = 1;
    CLI::App app{"GAlib on the function of Rastrigin; prints one line of JSON."};
    app.add_option("--population", population)->capture_default_str();
    app.add_option("--generations", generations)->capture_default_str();
    app.add_option("--seed", seed)->capture_default_str();
    CLI11_PARSE(app, argc, argv);

    const Stopwatch stopwatch;
    GARandomSeed(seed);
    GARealGenome genome{evolution::body_gene_count, GARealAlleleSet{-5.12f, 5.12f}, fitness};
    genome.initializer(GARealUniformInitializer);
    genome.crossover(GARealUniformCrossover);
    genome.mutator(GARealGaussianMutator); // standard deviation 1
    GASimpleGA algorithm{genome};
    algorithm.populationSize(static_cast<unsigned>(population));
    algorithm.nGenerations(static_cast<unsigned>(generations));
    algorithm.pCrossover(1);
    algorithm.pMutation(0.15f); // per gene, while 6 times as much is below 1
    algorithm.elitist(gaTrue);
    algorithm.maximize();
    algorithm.scaling(GANoScaling{});
    algorithm.selector(Tournament{});
    algorithm.initialize(seed);
    for (int generation = 1; generation < generations; ++generation) {
        algorithm.step();
    }
    const Seconds took = stopwatch.elapsed();
    std::cout << boost::json::object{{"program", "galib"},
                                     {"population", population},
                                     {"generations", generations},
                                     {"seed", seed},
                                     {"evaluations", evaluation_count},
                                     {"ms_per_generation", 1e3 * took.processor / generations},
                                     {"fitness_best", algorithm.population().best().score()}}
              << '\n';
    return 0;
}

} // namespace
} // namespace evod::bench

int main(int argc, char** argv) {
    return evod::bench::run(argc, argv);
}
