// Checks that the experiments with neural networks, rooy.json and brains.json, evolve as docs/BRAINS.md states.
//
// Seeds are literals, so the runs, and therefore the results, are always the same. A deliberate change of the model may
// make a mean differ by chance: the known means of rooy.json come from ten runs of the program that it repeats (seeds 1
// to 10), with their standard errors; every comparison allows 4 standard errors of the difference (6e-5, two-sided).

#include "server/base/inline_executor.h"
#include "server/jobs/thread_pool.h"
#include "server/parameters/experiment.h"
#include "server/simulation/world.h"

#include <boost/math/distributions/students_t.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <numeric>
#include <span>
#include <string>
#include <thread>
#include <vector>

namespace evod::simulation {
namespace {

using Curve = std::vector<double>; // mean fitness of each generation, from the first

parameters::Parameters experiment(const std::string& name) {
    std::ifstream file{EVOD_SOURCE_FOLDER "/experiments/" + name + ".json"};
    const std::string text{std::istreambuf_iterator<char>{file}, {}};
    return parameters::parse_experiment(text).value().parameters;
}

Curve curve_of(const parameters::Parameters& parameters, std::size_t generations, std::uint64_t seed) {
    World world{parameters, base::Seed{seed}};
    base::InlineExecutor executor;
    Curve curve;
    while (curve.size() < generations) {
        world.advance_tick(executor);
        world.take_events();
        if (world.generation_over()) {
            curve.push_back(world.history().back().front().fitness_mean);
        }
    }
    return curve;
}

/// Runs the world with the seeds 1 … seed_count.
std::vector<Curve> run(const parameters::Parameters& parameters, std::size_t generations, std::size_t seed_count) {
    std::vector<Curve> curves(seed_count);
    jobs::ThreadPool cores{std::max(std::thread::hardware_concurrency(), 1u)};
    cores.parallel_for(seed_count, 1, [&](base::Range seeds) {
        for (std::size_t i = seeds.begin; i < seeds.end; ++i) {
            curves[i] = curve_of(parameters, generations, i + 1);
        }
    });
    return curves;
}

/// Returns the mean fitness of the generations first … last of each run.
std::vector<double> fitness(const std::vector<Curve>& curves, std::size_t first, std::size_t last) {
    std::vector<double> means;
    for (const Curve& curve : curves) {
        const std::span generations{curve.data() + first - 1, last - first + 1};
        means.push_back(std::accumulate(generations.begin(), generations.end(), 0.0) /
                        static_cast<double>(generations.size()));
    }
    return means;
}

struct Estimate {
    double mean, error; // standard error of the mean
};

Estimate estimate(const std::vector<double>& values) {
    const auto count = static_cast<double>(values.size());
    const double mean = std::accumulate(values.begin(), values.end(), 0.0) / count;
    double squares = 0;
    for (const double value : values) {
        squares += (value - mean) * (value - mean);
    }
    return {mean, std::sqrt(squares / (count - 1) / count)};
}

void print(const char* name, const std::vector<Curve>& curves) {
    std::printf("%-28s", name);
    for (const std::size_t generation : {1, 2, 11, 20, 30, 50, 100}) {
        if (generation <= curves.front().size()) {
            const Estimate its = estimate(fitness(curves, generation, generation));
            std::printf("  %zu: %.1f (%.1f)", generation, its.mean, its.error);
        }
    }
    std::printf("\n");
}

TEST(Rooy, EatsAsMuchAsThePublishedProgram) {
    const std::vector<Curve> curves = run(experiment("rooy"), 50, 10);
    print("rooy", curves);
    struct Known {
        std::size_t first, last;
        double mean, deviation; // deviation: between the ten runs
    };
    for (const Known& known : {Known{1, 1, 26.0, 6.0}, {2, 2, 56.9, 4.7}, {11, 11, 74.1, 6.5}, {11, 50, 73.1, 3.1}}) {
        const Estimate its = estimate(fitness(curves, known.first, known.last));
        std::printf("generations %zu to %zu: %.1f\n", known.first, known.last, its.mean);
        EXPECT_NEAR(its.mean, known.mean, 4 * std::hypot(its.error, known.deviation / std::sqrt(10.0)))
            << "generations " << known.first << " to " << known.last;
    }
    const Estimate first = estimate(fitness(curves, 1, 1)), late = estimate(fitness(curves, 11, 50));
    EXPECT_TRUE(first.mean >= 20 && first.mean <= 32) << first.mean;
    EXPECT_NEAR(late.mean, 73.1, 4);
}

TEST(Brains, EvolveBySelectionAndOutdoTheRules) {
    constexpr std::size_t seeds = 20;
    const parameters::Parameters brains = experiment("brains"), standard;
    parameters::Parameters random = brains, rules = brains;
    random.selection = evolution::SelectionMethod::Random;
    rules.controller = evolution::Controller::Rules;
    EXPECT_EQ(brains.food_count, standard.food_count);
    EXPECT_EQ(brains.poison_count, standard.poison_count);

    const std::vector<Curve> curves = run(brains, 100, seeds), drift = run(random, 100, seeds);
    const std::vector<Curve> known = run(standard, 30, seeds), in_water = run(rules, 100, seeds);
    print("brains", curves);
    print("random selection", drift);
    print("rules, the default world", known);
    print("rules, the world of brains", in_water);

    // Generation 100 against random selection with the same seeds: one-sided paired t-test.
    std::vector<double> gain = fitness(curves, 100, 100);
    for (std::size_t i = 0; i < seeds; ++i) {
        gain[i] -= fitness(drift, 100, 100)[i];
    }
    const Estimate its = estimate(gain);
    const boost::math::students_t law(static_cast<double>(seeds - 1));
    EXPECT_LT(boost::math::cdf(boost::math::complement(law, its.mean / its.error)), 0.001);
    const double end = estimate(fitness(curves, 100, 100)).mean;
    EXPECT_GT(end, estimate(fitness(known, 30, 30)).mean);
    EXPECT_GT(end, estimate(fitness(in_water, 100, 100)).mean);
}

} // namespace
} // namespace evod::simulation
