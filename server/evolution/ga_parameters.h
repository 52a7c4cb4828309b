// The parameters of the genetic algorithm, one line each. Macros generate the struct and the registry from these lines.
//
// A line contains: name, default, minimum, maximum, unit, when a change takes effect, one sentence of help. A TOPIC is the
// heading under which people see the parameters that follow it. EVOD_FITNESS_PARAMETERS is the beginning of the topic of
// parameters/model_parameters.h; it is here because the genes of a world depend on it (gene_layout.h).
#pragma once

#include "server/base/parameter.h"
#include "server/evolution/free_genes.h"

namespace evod::evolution {

enum class FitnessFunction { Life, GeneSum, Rastrigin, External };
enum class PopulationModel { Hybrid, Generational, SteadyState, Nsga2 };
enum class FitnessScaling { None, Windowing, LinearRanking, ExponentialRanking };
enum class SelectionMethod { Roulette, StochasticUniversal, Tournament, Random, Truncation };
enum class CrossoverMethod { Uniform, SinglePoint, MultiPoint, Blend, None, SimulatedBinary };
enum class OrderMutationMethod { None, Swap, Scramble, Inversion };
enum class Creep { Uniform, Gaussian, Polynomial };
enum class OutOfBounds { Clamp, Reflect, Redraw };
enum class GeneGroup { All, Body, Brain, Free };
enum class Topology { None, Ring, FullyConnected, Random };
enum class Emigrants { Best, Random };
enum class Replaced { Worst, Random };
enum class Controller { Rules, Network };
enum class FreeGeneStart { Uniform, LatinHypercube };
enum class Locomotion { Newtonian, Kinematic };

} // namespace evod::evolution

EVOD_CHOICE_NAMES(evod::evolution::FitnessFunction, "life", "gene_sum", "rastrigin", "external")
EVOD_CHOICE_NAMES(evod::evolution::PopulationModel, "hybrid", "generational", "steady_state", "nsga2")
EVOD_CHOICE_NAMES(evod::evolution::FitnessScaling, "none", "windowing", "linear_ranking", "exponential_ranking")
EVOD_CHOICE_NAMES(evod::evolution::SelectionMethod, "roulette", "stochastic_universal", "tournament", "random",
                  "truncation")
EVOD_CHOICE_NAMES(evod::evolution::CrossoverMethod, "uniform", "single_point", "multi_point", "blend", "none",
                  "simulated_binary")
EVOD_CHOICE_NAMES(evod::evolution::OrderMutationMethod, "none", "swap", "scramble", "inversion")
EVOD_CHOICE_NAMES(evod::evolution::Creep, "uniform", "gaussian", "polynomial")
EVOD_CHOICE_NAMES(evod::evolution::OutOfBounds, "clamp", "reflect", "redraw")
EVOD_CHOICE_NAMES(evod::evolution::GeneGroup, "all", "body", "brain", "free")
EVOD_CHOICE_NAMES(evod::evolution::Topology, "none", "ring", "fully_connected", "random")
EVOD_CHOICE_NAMES(evod::evolution::Emigrants, "best", "random")
EVOD_CHOICE_NAMES(evod::evolution::Replaced, "worst", "random")
EVOD_CHOICE_NAMES(evod::evolution::Controller, "rules", "network")
EVOD_CHOICE_NAMES(evod::evolution::FreeGeneStart, "uniform", "latin_hypercube")
EVOD_CHOICE_NAMES(evod::evolution::Locomotion, "newtonian", "kinematic")

// clang-format off
#define EVOD_FITNESS_PARAMETERS(TOPIC, REAL, COUNT, FLAG, CHOICE)                                                      \
    TOPIC("Experiment")                                                                                                \
    CHOICE(fitness, FitnessFunction, Life, Reset, "The fitness function: life is a weighted sum of seconds lived, health at the end, food eaten and poison eaten, by default seconds lived + health at the end; gene_sum and rastrigin are functions of the chromosome alone; external: at the end of each generation the world waits until a client has sent the fitness of every organism (SetFitness).") \
    COUNT(objectives, 1, 1, 16, "numbers", Reset, "Numbers with which a client rates each organism, if fitness is external. With several, organisms are ranked by fronts and crowding (NSGA-II), and the first number is the fitness in statistics, charts and termination criteria.") \
    FLAG(external_bodies, true, Reset, "Whether organisms live on the islands before a client rates them, if fitness is external. Off: there are no bodies, and a generation lasts one tick, as for gene_sum.")

#define EVOD_EVOLUTION_PARAMETERS(TOPIC, REAL, COUNT, FLAG, CHOICE)                                                    \
    TOPIC("Population")                                                                                                \
    COUNT(population_size, 50, 1, 4'000'000, "organisms", NextGeneration, "Organisms on each island.")                 \
    CHOICE(population_model, PopulationModel, Hybrid, NextTick, "How a generation replaces the previous one: hybrid keeps the selected organisms and adds their children, generational replaces all organisms except the elite, steady_state replaces only the worst organisms, nsga2 keeps the best organisms and adds children of parents that are selected among them.") \
    REAL(survivors, 0.5, 0, 1, "share", NextTick, "Population models hybrid and nsga2: share of the population that survives and breeds. Other population models with truncation selection: share that may breed. At least one organism.") \
    COUNT(replaced_count, 2, 1, 4'000'000, "organisms", NextTick, "Number of worst organisms that each generation replaces (steady_state).") \
    COUNT(elite_count, 0, 0, 4'000'000, "organisms", NextTick, "Number of best organisms that survive unchanged.")     \
    FLAG(mutate_survivors, false, NextTick, "Whether survivors are mutated too; the elite never are.")                 \
    FLAG(shuffle_fitness, false, NextTick, "Whether fitness values are shuffled among an island's organisms before migration and selection: a control for experiments, in which selection is as strong as before but favours no gene. Statistics and termination criteria use the true fitness.") \
    TOPIC("Selection")                                                                                                 \
    CHOICE(fitness_scaling, FitnessScaling, None, NextTick, "How fitness is scaled before roulette and stochastic_universal selection.") \
    REAL(ranking_pressure, 1.5, 1, 2, "", NextTick, "Expected number of copies of the best organism under linear_ranking; 1 exerts no selection pressure.") \
    REAL(ranking_decay, 0.95, 0.01, 1, "", NextTick, "Weight of each rank relative to the next better one under exponential_ranking.") \
    CHOICE(selection, SelectionMethod, Roulette, NextTick, "How parents are selected.")                                \
    COUNT(tournament_size, 3, 1, 1'000'000, "organisms", NextTick, "Number of contestants per tournament; without tournament_replacement, at most population_size.") \
    COUNT(tournament_winners, 1, 1, 1'000'000, "organisms", NextTick, "Number of winners per tournament; at most tournament_size.") \
    FLAG(tournament_replacement, true, NextTick, "Whether an organism can be drawn more than once into the same tournament.") \
    TOPIC("Crossover")                                                                                                 \
    CHOICE(crossover, CrossoverMethod, Uniform, NextTick, "How the genes of two parents are mixed: uniform, single_point and multi_point give each gene of one parent to one child and that of the other parent to the other child; blend gives the children complementary weighted means of the parents; simulated_binary gives them values on both sides of the parents', mostly near them.")                   \
    REAL(crossover_chance, 1, 0, 1, "chance", NextTick, "Chance that the genes of a pair are mixed; otherwise the children are copies of the parents.") \
    COUNT(crossover_cuts, 2, 1, 5, "cuts", NextTick, "Number of cut points of multi_point crossover; at most one fewer than there are genes.")                                     \
    REAL(crossover_spread_index, 15, 0, 1000, "", NextTick, "Index of the distribution of simulated_binary crossover: the larger it is, the nearer children are to their parents.") \
    CHOICE(mutate_group, GeneGroup, All, NextTick, "Which genes mutate: all, those of the body, the weights of the brain, or the free genes. Crossover mixes all genes.") \
    TOPIC("Mutation")                                                                                                  \
    CHOICE(rearranging, OrderMutationMethod, None, NextTick, "Order mutation: how the values of genes are exchanged within a chromosome.") \
    REAL(rearrange_chance, 0.1, 0, 1, "chance", NextTick, "Chance per chromosome of an order mutation.")               \
    CHOICE(creep, Creep, Uniform, NextTick, "Distribution of the step that a creep mutation adds to a gene: uniform within ± the step, gaussian with the step as standard deviation, or polynomial, which depends on mutation_spread_index and the gene's bounds instead of a step. The step of a gene of the body is mutation_step, that of a weight of the brain is brain_mutation_step, and that of a free gene is free_mutation_step.") \
    REAL(mutation_chance, 0.15, 0, 1, "chance", NextTick, "Chance per gene of a creep mutation.")                      \
    REAL(mutation_step, 15, 0, 1000, "gene units", NextTick, "Size of a creep mutation of a gene of the body: its largest step if creep is uniform, its standard deviation if creep is gaussian.") \
    REAL(brain_mutation_step, 0.5, 0, 1000, "gene units", NextTick, "Size of a creep mutation of a weight of the brain, as for mutation_step.") \
    REAL(free_mutation_step, 0.1, 0, 1e6, "gene units", NextTick, "Size of a creep mutation of a free gene, as for mutation_step; of a gene of a list, as a share of its range.") \
    REAL(mutation_spread_index, 20, 0, 1000, "", NextTick, "Index of the distribution of polynomial creep: the larger it is, the smaller the steps.") \
    REAL(reset_chance, 0, 0, 1, "chance", NextTick, "Chance per gene of a reset to a uniform random value within the gene's bounds; 0 means off.") \
    REAL(scale_chance, 0, 0, 1, "chance", NextTick, "Chance per chromosome that one random gene is multiplied by a random factor; 0 means off.") \
    REAL(scale_range, 0.1, 0, 1, "", NextTick, "Range of the factor of a scale mutation: uniform between 1 − scale_range and 1 + scale_range.") \
    REAL(bit_flip_chance, 0, 0, 1, "chance", NextTick, "Chance per bit of a flip in a gene's fixed-point binary code; 0 means off.") \
    COUNT(bit_flip_bits, 16, 1, 24, "bits", NextTick, "Number of bits of a gene's binary code, whose values are evenly spaced between the gene's bounds.") \
    CHOICE(out_of_bounds, OutOfBounds, Clamp, NextTick, "What happens to a gene that a mutation moves out of its bounds: clamp sets it to the nearer bound, reflect mirrors it at the bound, redraw replaces it by a uniform random value within the bounds.") \
    TOPIC("Bounds of genes")                                                                                           \
    REAL(initial_gene_min, 80, 0, 10'000, "gene units", Reset, "Lowest value of a gene of the body in the first generation.") \
    REAL(initial_gene_max, 120, 0, 10'000, "gene units", Reset, "Highest value of a gene of the body in the first generation.") \
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
    COUNT(free_genes, 0, 0, 1000, "genes", Reset, "Genes beyond those of the body, which the simulation does not read; for a fitness function outside evod. Their names are free0, free1, and so on, unless a list describes them.") \
    REAL(free_gene_min, 0, -1e6, 1e6, "gene units", NextTick, "Lower bound of every free gene without a list. In the first generation, free genes are uniform between their bounds.") \
    REAL(free_gene_max, 1, -1e6, 1e6, "gene units", NextTick, "Upper bound of every free gene without a list.") \
    CHOICE(free_gene_start, FreeGeneStart, Uniform, Reset, "Values of free genes in the first generation: uniform, every value is equally likely; latin_hypercube, the values of each gene are spread evenly over the organisms of an island.") \
    CHOICE(controller, Controller, Rules, Reset, "What steers organisms: rules, the fixed rules of behaviour; network, a neural network whose weights are genes.") \
    FLAG(sense_food, true, Reset, "Whether networks have inputs for the nearest food that is seen: its bearing (the angle from the heading, −1 to 1 for half a turn) and its proximity (1 − distance / food_radius; 0 if none is seen).") \
    FLAG(sense_poison, true, Reset, "Whether networks have inputs for the nearest poison that is seen, as for sense_food.") \
    FLAG(sense_bearing_only, false, Reset, "Whether networks have no inputs for the proximity of food and poison.")      \
    FLAG(sense_speed, false, Reset, "Whether networks have an input for the organism's own speed / max_speed_px_s.")   \
    FLAG(sense_health, false, Reset, "Whether networks have an input for health / base_health, limited to 0 to 1.")    \
    FLAG(sense_wall, false, Reset, "Whether networks have an input for the proximity of the wall ahead: 1 − distance / food_radius; 0 beyond food_radius.") \
    FLAG(brain_bias, true, Reset, "Whether every neuron of a network has a bias weight.")                              \
    COUNT(brain_hidden, 5, 1, 32, "neurons", Reset, "Neurons in the hidden layer of a network.")                       \
    REAL(brain_weight_limit, 4, 0.001, 1000, "", NextTick, "Weights of a network stay within ± this value.")           \
    REAL(brain_weight_initial, 1, 0, 1000, "", Reset, "Weights of the first generation are uniform within ± this value.") \
    CHOICE(locomotion, Locomotion, Newtonian, Reset, "What the outputs of a network do: newtonian, a force along the heading and a turn rate; bodies have mass and collide; kinematic, a change of speed and a turn rate; bodies have no mass and pass through each other.") \
    TOPIC("End of the run")                                                                                            \
    COUNT(generation_limit, 0, 0, count_max, "generations", NextTick, "The run ends after this many generations; 0 means no limit.") \
    FLAG(stop_at_target_fitness, false, NextTick, "Whether the run ends when an organism reaches target_fitness.")     \
    REAL(target_fitness, 500, -1e12, 1e12, "fitness", NextTick, "Fitness at which the run ends if stop_at_target_fitness is on.") \
    COUNT(stagnation_limit, 0, 0, count_max, "generations", NextTick, "The run ends after this many generations without a new best fitness; 0 means never.") \
    FLAG(stop_at_extinction, false, NextTick, "Whether the run ends with a generation in which every organism died. With births, it always ends with an interval after which no prey lives; and if this is on, also with one after which no predator lives.")  \
    TOPIC("Migration")                                                                                                 \
    CHOICE(migration, Topology, None, NextTick, "Which islands exchange migrants.")                                    \
    COUNT(migration_epoch, 10, 1, count_max, "generations", NextTick, "Number of generations from one migration to the next.")               \
    COUNT(migrant_count, 1, 1, 4'000'000, "organisms", NextTick, "Number of organisms that an island copies to each destination island; if more arrive than an island has organisms, its places are shared evenly among the sending islands.") \
    CHOICE(emigrants, Emigrants, Best, NextTick, "Which organisms are copied to other islands.")                       \
    CHOICE(immigrants_replace, Replaced, Worst, NextTick, "Which organisms of the destination island the migrants replace.")
// clang-format on

namespace evod::evolution {

using base::count_max;

#define EVOD_NO_FIELD(topic)
#define EVOD_REAL_FIELD(name, value, least, greatest, unit, effect, help) double name = value;
#define EVOD_COUNT_FIELD(name, value, least, greatest, unit, effect, help) std::uint32_t name = value;
#define EVOD_FLAG_FIELD(name, value, effect, help) bool name = value;
#define EVOD_CHOICE_FIELD(name, Type, value, effect, help) Type name = Type::value;

/// Every parameter of the genetic algorithm. Each is within its range, and no lower bound of a gene is above its upper
/// bound.
struct Parameters {
    EVOD_FITNESS_PARAMETERS(EVOD_NO_FIELD, EVOD_REAL_FIELD, EVOD_COUNT_FIELD, EVOD_FLAG_FIELD, EVOD_CHOICE_FIELD)
    EVOD_EVOLUTION_PARAMETERS(EVOD_NO_FIELD, EVOD_REAL_FIELD, EVOD_COUNT_FIELD, EVOD_FLAG_FIELD, EVOD_CHOICE_FIELD)

    /// The list of the free genes, which is not in the registry; empty, or of `free_genes` genes. It takes effect at a
    /// reset.
    FreeGenes listed_genes{};
};

} // namespace evod::evolution
