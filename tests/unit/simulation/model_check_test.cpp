// Checks that the default world behaves and evolves as in the independent program by which its parameters were chosen.
//
// Worlds of 24 seeds run in parallel, each on one thread. The reference figures and their standard errors are the other
// program's. Fitness at generations 1, 10, 30 and 60: 79, 106, 161, 203 with roulette; 79, 121, 191, 248 with
// truncation; constant with random selection. In generation 1, a share of 0.48 survives, and a living organism eats
// 0.217 food and 0.028 poison per second. Every comparison allows 4 standard errors of the difference (6e-5 each,
// two-sided).

#include "server/base/inline_executor.h"
#include "server/simulation/world.h"

#include <boost/math/distributions/students_t.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <string>
#include <thread>
#include <vector>

namespace evod::simulation {
namespace {

using evolution::SelectionMethod;

constexpr std::size_t seed_count = 24;
constexpr std::size_t generations_max = 60;

struct Generation {
    double fitness_mean = 0, fitness_best = 0, survival = 0, food_per_s = 0, poison_per_s = 0;
};
using History = std::vector<Generation>; // of one world

struct Series {
    SelectionMethod selection;
    const char* name;
    std::size_t generations;
    std::array<History, seed_count> worlds;
};

History history_of(SelectionMethod selection, std::size_t generations, base::Seed seed) {
    parameters::Parameters parameters;
    parameters.selection = selection;
    World world{parameters, seed};
    base::InlineExecutor executor;
    History history;
    while (history.size() < generations) {
        world.advance_tick(executor);
        world.take_events();
        if (!world.generation_over()) {
            continue;
        }
        const GenerationStatistics& s = world.history().back().front();
        double lived_s = 0;
        for (const std::uint32_t ticks : world.island(0).life_records().lived_ticks) {
            lived_s += (ticks == 0 ? static_cast<double>(world.moment().generation_tick) : ticks) * parameters.tick_s;
        }
        history.push_back({.fitness_mean = s.fitness_mean,
                           .fitness_best = s.fitness_best,
                           .survival = static_cast<double>(s.alive_count) / s.organism_count,
                           .food_per_s = static_cast<double>(s.food_eaten) / lived_s,
                           .poison_per_s = static_cast<double>(s.poison_eaten) / lived_s});
    }
    return history;
}

struct Estimate {
    double mean, error; // standard error of the mean
};

Estimate estimate(const std::array<double, seed_count>& values) {
    double sum = 0, squares = 0;
    for (const double value : values) {
        sum += value;
    }
    const double mean = sum / seed_count;
    for (const double value : values) {
        squares += (value - mean) * (value - mean);
    }
    return {mean, std::sqrt(squares / (seed_count - 1) / seed_count)};
}

/// generation  1 for the first.
Estimate across_seeds(const Series& series, std::size_t generation, double Generation::*figure) {
    std::array<double, seed_count> values;
    for (std::size_t seed = 0; seed < seed_count; ++seed) {
        values[seed] = series.worlds[seed].at(generation - 1).*figure;
    }
    return estimate(values);
}

std::array<double, seed_count> mean_fitness_of_generations_21_to_30(const Series& series) {
    std::array<double, seed_count> means{};
    for (std::size_t seed = 0; seed < seed_count; ++seed) {
        for (std::size_t generation = 21; generation <= 30; ++generation) {
            means[seed] += series.worlds[seed][generation - 1].fitness_mean / 10;
        }
    }
    return means;
}

void run_on_all_cores(std::vector<Series>& all) {
    struct Task {
        Series* series;
        std::size_t seed;
    };
    std::vector<Task> tasks;
    for (Series& series : all) { // longest first
        for (std::size_t seed = 0; seed < seed_count; ++seed) {
            tasks.push_back({&series, seed});
        }
    }
    std::atomic<std::size_t> next = 0;
    std::vector<std::thread> threads;
    for (unsigned i = 0; i < std::max(std::thread::hardware_concurrency(), 1u); ++i) {
        threads.emplace_back([&] {
            for (std::size_t t = next++; t < tasks.size(); t = next++) {
                tasks[t].series->worlds[tasks[t].seed] = history_of(
                    tasks[t].series->selection, tasks[t].series->generations, base::Seed{1000 + tasks[t].seed});
            }
        });
    }
    for (std::thread& thread : threads) {
        thread.join();
    }
}

void print(const Series& series) {
    std::printf("%-20s fitness", series.name);
    for (const std::size_t generation : {1, 10, 20, 30, 60}) {
        if (generation <= series.generations) {
            const Estimate fitness = across_seeds(series, generation, &Generation::fitness_mean);
            std::printf(" %6.1f (%.1f)", fitness.mean, fitness.error);
        }
    }
    for (const std::size_t generation : {std::size_t{1}, std::size_t{30}, series.generations}) {
        std::printf(" | g%zu alive %.2f food/s %.3f poison/s %.4f best %.0f", generation,
                    across_seeds(series, generation, &Generation::survival).mean,
                    across_seeds(series, generation, &Generation::food_per_s).mean,
                    across_seeds(series, generation, &Generation::poison_per_s).mean,
                    across_seeds(series, generation, &Generation::fitness_best).mean);
    }
    std::printf("\n");
}

void expect_near(const Estimate& measured, double known, double known_error, const std::string& what) {
    const double allowed = 4 * std::sqrt(known_error * known_error + measured.error * measured.error);
    EXPECT_NEAR(measured.mean, known, allowed) << what;
}

TEST(TheDefaultWorld, BehavesAndEvolvesAsMeasured) {
    std::vector<Series> all(5);
    all[0] = {SelectionMethod::Roulette, "roulette", generations_max, {}};
    all[1] = {SelectionMethod::Truncation, "truncation", generations_max, {}};
    all[2] = {SelectionMethod::StochasticUniversal, "stochastic_universal", 30, {}};
    all[3] = {SelectionMethod::Tournament, "tournament", 30, {}};
    all[4] = {SelectionMethod::Random, "random", 30, {}};
    run_on_all_cores(all);
    std::printf("%zu seeds; fitness: mean over the seeds (standard error) at generations 1, 10, 20, 30, 60\n",
                seed_count);
    for (const Series& series : all) {
        print(series);
    }

    // Generations 21 to 30 against random selection with the same seeds: one-sided paired t-test.
    const Series& random = all[4];
    for (std::size_t i = 0; i < 4; ++i) {
        std::array<double, seed_count> gain = mean_fitness_of_generations_21_to_30(all[i]);
        for (std::size_t seed = 0; seed < seed_count; ++seed) {
            gain[seed] -= mean_fitness_of_generations_21_to_30(random)[seed];
        }
        const Estimate mean_gain = estimate(gain);
        const double t = mean_gain.mean / mean_gain.error;
        const double p = boost::math::cdf(boost::math::complement(boost::math::students_t(seed_count - 1), t));
        std::printf("%-20s %+.1f above random selection in generations 21 to 30, t = %.1f, p = %.1e\n", all[i].name,
                    mean_gain.mean, t, p);
        EXPECT_LT(p, 0.001) << all[i].name;
    }

    struct Known {
        std::size_t generation;
        double roulette, truncation, error;
    };
    for (const Known& known : {Known{1, 79, 79, 2}, {10, 106, 121, 3.5}, {30, 161, 191, 5}, {60, 203, 248, 6}}) {
        const std::string when = " at generation " + std::to_string(known.generation);
        expect_near(across_seeds(all[0], known.generation, &Generation::fitness_mean), known.roulette, known.error,
                    "roulette" + when);
        expect_near(across_seeds(all[1], known.generation, &Generation::fitness_mean), known.truncation, known.error,
                    "truncation" + when);
        if (known.generation <= 30) {
            expect_near(across_seeds(random, known.generation, &Generation::fitness_mean), 79, known.error,
                        "random" + when);
        }
    }

    // The first generation is the same whatever the selection; the other program's errors are taken to be ours.
    const auto expect_first = [&](double Generation::*figure, double known, const char* what) {
        const Estimate measured = across_seeds(all[0], 1, figure);
        expect_near(measured, known, measured.error, what);
    };
    expect_first(&Generation::survival, 0.48, "survival");
    expect_first(&Generation::food_per_s, 0.217, "food per living organism-second");
    expect_first(&Generation::poison_per_s, 0.028, "poison per living organism-second");
}

} // namespace
} // namespace evod::simulation
