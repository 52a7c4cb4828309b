// The parameters of the genetic algorithm: one line each, from which the struct and the registry are made.
//
// A line says: name, default, least, greatest, unit, when a change takes effect, one sentence of help.
#pragma once

#include "server/base/parameter.h"

namespace evod::evolution {

enum class PopulationModel { Hybrid, Generational, SteadyState };
enum class FitnessScaling { None, Windowing, LinearRanking, ExponentialRanking };
enum class SelectionMethod { Roulette, StochasticUniversal, Tournament, Random, Truncation };
enum class CrossoverMethod { Uniform, SinglePoint, MultiPoint, None };
enum class Rearranging { None, Swap, Scramble, Inversion };
enum class Creep { Uniform, Gaussian };
enum class Topology { None, Ring, FullyConnected, Random };
enum class Emigrants { Best, Random };
enum class Replaced { Worst, Random };

} // namespace evod::evolution

EVOD_CHOICE_NAMES(evod::evolution::PopulationModel, "hybrid", "generational", "steady_state")
EVOD_CHOICE_NAMES(evod::evolution::FitnessScaling, "none", "windowing", "linear_ranking", "exponential_ranking")
EVOD_CHOICE_NAMES(evod::evolution::SelectionMethod, "roulette", "stochastic_universal", "tournament", "random",
                  "truncation")
EVOD_CHOICE_NAMES(evod::evolution::CrossoverMethod, "uniform", "single_point", "multi_point", "none")
EVOD_CHOICE_NAMES(evod::evolution::Rearranging, "none", "swap", "scramble", "inversion")
EVOD_CHOICE_NAMES(evod::evolution::Creep, "uniform", "gaussian")
EVOD_CHOICE_NAMES(evod::evolution::Topology, "none", "ring", "fully_connected", "random")
EVOD_CHOICE_NAMES(evod::evolution::Emigrants, "best", "random")
EVOD_CHOICE_NAMES(evod::evolution::Replaced, "worst", "random")

// clang-format off
#define EVOD_EVOLUTION_PARAMETERS(REAL, COUNT, FLAG, CHOICE)                                                           \
    COUNT(population_size, 50, 1, 4'000'000, "organisms", NextGeneration, "Organisms on each island.")                 \
    CHOICE(population_model, PopulationModel, Hybrid, NextTick, "What happens to the old generation: hybrid keeps the selected survivors and fills up with their children, generational replaces everyone, steady_state replaces the worst.") \
    REAL(survivors, 0.5, 0, 1, "share", NextTick, "Share of the population that the selection keeps and lets breed (hybrid), or that truncation lets breed (generational, steady_state); at least one organism.") \
    COUNT(replaced_count, 2, 1, 4'000'000, "organisms", NextTick, "How many of the worst leave each generation (steady_state).") \
    COUNT(elite_count, 0, 0, 4'000'000, "organisms", NextTick, "How many of the best are always kept, unchanged.")      \
    FLAG(mutate_survivors, false, NextTick, "Whether survivors are mutated too; the elite never is.")                  \
    FLAG(shuffle_fitness, false, NextTick, "Whether the fitness is dealt out anew among an island's organisms, by chance, before anyone migrates or is selected: a control for experiments, with the pressure of the selection and nothing to press on. Statistics and criteria keep the true fitness.") \
    CHOICE(fitness_scaling, FitnessScaling, None, NextTick, "What is done to the fitness before the selection sees it.") \
    REAL(ranking_pressure, 1.5, 1, 2, "", NextTick, "Expected copies of the best under linear_ranking; 1 is no pressure.") \
    REAL(ranking_decay, 0.95, 0.01, 1, "", NextTick, "Weight of each rank relative to the next better one under exponential_ranking.") \
    CHOICE(selection, SelectionMethod, Roulette, NextTick, "How those that breed are chosen.")                         \
    COUNT(tournament_size, 3, 1, 1'000'000, "organisms", NextTick, "Contestants in a tournament; without tournament_replacement at most population_size.") \
    COUNT(tournament_winners, 1, 1, 1'000'000, "organisms", NextTick, "How many of a tournament's best win; at most tournament_size.") \
    FLAG(tournament_replacement, true, NextTick, "Whether an organism can be drawn twice into the same tournament.")   \
    CHOICE(crossover, CrossoverMethod, Uniform, NextTick, "How two parents' genes are mixed.")                         \
    REAL(crossover_chance, 1, 0, 1, "chance", NextTick, "Chance that a pair's genes are mixed at all; otherwise its children are copies.") \
    COUNT(crossover_cuts, 2, 1, 5, "cuts", NextTick, "Interior cut points of multi_point.")                            \
    CHOICE(rearranging, Rearranging, None, NextTick, "Mutation that moves genes about inside a chromosome.")           \
    REAL(rearrange_chance, 0.1, 0, 1, "chance", NextTick, "Chance per chromosome of a rearranging mutation.")          \
    CHOICE(creep, Creep, Uniform, NextTick, "Law of the step that creep mutation adds: uniform within ±mutation_step, or gaussian with that standard deviation.") \
    REAL(mutation_chance, 0.15, 0, 1, "chance", NextTick, "Chance per gene of a creep mutation.")                      \
    REAL(mutation_step, 15, 0, 1000, "gene units", NextTick, "Size of a creep mutation.")                              \
    REAL(reset_chance, 0, 0, 1, "chance", NextTick, "Chance per gene of a random reset to anywhere within its bounds; 0 is off.") \
    REAL(bit_flip_chance, 0, 0, 1, "chance", NextTick, "Chance per bit of a flip in the gene's fixed-point binary view; 0 is off.") \
    COUNT(bit_flip_bits, 16, 1, 24, "bits", NextTick, "Bits of the binary view, spread evenly over a gene's bounds.")  \
    REAL(initial_gene_min, 80, 0, 10'000, "gene units", Reset, "Least value of a gene in the first generation.")       \
    REAL(initial_gene_max, 120, 0, 10'000, "gene units", Reset, "Greatest value of a gene in the first generation.")   \
    REAL(normal_speed_min, 20, 0, 10'000, "gene units", NextTick, "Lower bound of the gene normal_speed.")             \
    REAL(normal_speed_max, 250, 0, 10'000, "gene units", NextTick, "Upper bound of the gene normal_speed.")            \
    REAL(impulse_min, 20, 0, 10'000, "gene units", NextTick, "Lower bound of the gene impulse.")                       \
    REAL(impulse_max, 250, 0, 10'000, "gene units", NextTick, "Upper bound of the gene impulse.")                      \
    REAL(body_size_min, 40, 1, 1'000, "gene units", NextTick, "Lower bound of the gene body_size.")                    \
    REAL(body_size_max, 200, 1, 1'000, "gene units", NextTick, "Upper bound of the gene body_size.")                   \
    REAL(base_health_min, 20, 0, 10'000, "gene units", NextTick, "Lower bound of the gene base_health.")               \
    REAL(base_health_max, 200, 0, 10'000, "gene units", NextTick, "Upper bound of the gene base_health.")              \
    REAL(food_radius_min, 20, 0, 10'000, "gene units", NextTick, "Lower bound of the gene food_radius.")               \
    REAL(food_radius_max, 200, 0, 10'000, "gene units", NextTick, "Upper bound of the gene food_radius.")              \
    REAL(poison_radius_min, 20, 0, 10'000, "gene units", NextTick, "Lower bound of the gene poison_radius.")           \
    REAL(poison_radius_max, 200, 0, 10'000, "gene units", NextTick, "Upper bound of the gene poison_radius.")          \
    COUNT(generation_limit, 0, 0, count_max, "generations", NextTick, "The run ends after this many generations; 0 is no limit.") \
    FLAG(stop_at_target_fitness, false, NextTick, "Whether the run ends when an organism reaches target_fitness.")     \
    REAL(target_fitness, 500, -1e12, 1e12, "fitness", NextTick, "The fitness that ends the run if stop_at_target_fitness is on.") \
    COUNT(stagnation_limit, 0, 0, count_max, "generations", NextTick, "The run ends after this many generations without a new best fitness; 0 is never.") \
    FLAG(stop_at_extinction, false, NextTick, "Whether the run ends with a generation in which everyone died.")        \
    CHOICE(migration, Topology, None, NextTick, "Which islands send migrants to which.")                               \
    COUNT(migration_epoch, 10, 1, count_max, "generations", NextTick, "Generations between migrations.")               \
    COUNT(migrant_count, 1, 1, 4'000'000, "organisms", NextTick, "Organisms copied along each edge of the topology; where more arrive than an island holds, its places are shared evenly among the islands that send them.") \
    CHOICE(emigrants, Emigrants, Best, NextTick, "Who is copied out.")                                                 \
    CHOICE(immigrants_replace, Replaced, Worst, NextTick, "Who makes room for those that arrive.")
// clang-format on

namespace evod::evolution {

using base::count_max;

#define EVOD_REAL_FIELD(name, value, least, greatest, unit, effect, help) double name = value;
#define EVOD_COUNT_FIELD(name, value, least, greatest, unit, effect, help) std::uint32_t name = value;
#define EVOD_FLAG_FIELD(name, value, effect, help) bool name = value;
#define EVOD_CHOICE_FIELD(name, Type, value, effect, help) Type name = Type::value;

/// Every parameter of the genetic algorithm; each within its range, and the lower bound of a gene not above its upper.
struct Parameters {
    EVOD_EVOLUTION_PARAMETERS(EVOD_REAL_FIELD, EVOD_COUNT_FIELD, EVOD_FLAG_FIELD, EVOD_CHOICE_FIELD)
};

} // namespace evod::evolution
