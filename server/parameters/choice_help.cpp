#include "server/parameters/choice_help.h"

#include <algorithm>
#include <iterator>

namespace evod::parameters {

namespace {

struct Sentence {
    std::string_view parameter, choice, help;
};

constexpr Sentence sentences[] = {
    {"fitness", "life", "Seconds lived plus the health at the end of the generation."},
    {"fitness", "gene_sum", "The sum of the genes of the body."},
    {"fitness", "rastrigin", "The Rastrigin function of the genes of the body, a test problem with many local optima."},
    {"fitness", "external", "Numbers that a client sends at the end of each generation, for any function."},
    {"flee_rule", "nearer", "An organism flees only if the poison is nearer than all food that it sees."},
    {"flee_rule", "always", "An organism flees from poison that it sees, regardless of food."},
    {"integrator", "symplectic_euler", "Positions use the new velocities; the energy of a spring stays bounded."},
    {"integrator", "explicit_euler", "Positions use the old velocities; the energy of a spring grows."},
    {"integrator", "backward_euler", "Damping uses the new velocities; it is stable for any tick length."},
    {"reproduction", "generations", "Each generation is bred from the previous one, whose organisms then end."},
    {"reproduction", "births", "Organisms with enough health have children while they live; nothing selects but life."},
    {"births", "sexual", "A child has two parents, which are near each other, and mixes their genes."},
    {"births", "asexual", "A child has one parent, and its genes with mutations."},
    {"population_model", "hybrid", "The selected organisms stay, and their children fill the other places."},
    {"population_model", "generational", "Children replace all organisms except the elite."},
    {"population_model", "steady_state", "Children replace only the worst organisms."},
    {"population_model", "nsga2",
     "The best organisms stay, and their children fill the other places; with several objectives this is NSGA-II."},
    {"fitness_scaling", "none",
     "The fitness itself is the weight of an organism. If any is negative, the lowest is first subtracted from all."},
    {"fitness_scaling", "windowing", "The lowest fitness of the generation is subtracted from every fitness."},
    {"fitness_scaling", "linear_ranking", "The weight falls by the same amount from rank to rank."},
    {"fitness_scaling", "exponential_ranking", "The weight falls by the same factor from rank to rank."},
    {"selection", "roulette", "Each parent is drawn with a chance proportional to its scaled fitness."},
    {"selection", "stochastic_universal", "As roulette, but one spin chooses all parents, so the copies vary less."},
    {"selection", "tournament", "A few organisms are drawn at random, and the fittest of them become parents."},
    {"selection", "random", "Every organism has the same chance: there is no selection pressure."},
    {"selection", "truncation", "Only the fittest organisms become parents, all with the same chance."},
    {"crossover", "uniform", "Each gene comes from either parent with the same chance."},
    {"crossover", "single_point", "The chromosomes of both parents are cut at one place and joined crosswise."},
    {"crossover", "multi_point", "The chromosomes of both parents are cut at several places and joined alternately."},
    {"crossover", "blend", "Each gene is a weighted mean of both parents' genes, with one random weight per pair."},
    {"crossover", "simulated_binary",
     "Each gene of a child is near that of one parent, at a random distance in proportion to the parents' difference."},
    {"crossover", "none", "The children are copies of their parents."},
    {"rearranging", "none", "Values of genes are not exchanged."},
    {"rearranging", "swap", "Two genes exchange their values."},
    {"rearranging", "scramble", "The values of neighbouring genes are shuffled."},
    {"rearranging", "inversion", "The order of the values of neighbouring genes is reversed."},
    {"mutate_group", "all", "Every gene can mutate."},
    {"mutate_group", "body", "Only the six genes of the body mutate."},
    {"mutate_group", "brain", "Only the weights of the neural network mutate."},
    {"mutate_group", "free", "Only the genes that the simulation does not read mutate."},
    {"creep", "uniform", "Every step up to the step's limit is equally likely."},
    {"creep", "gaussian", "Small steps are more likely than large steps."},
    {"creep", "polynomial", "Small steps are more likely than large steps, and no step leads out of the bounds."},
    {"out_of_bounds", "clamp", "The gene gets the value of the nearer bound, so values gather at the bounds."},
    {"out_of_bounds", "reflect", "The gene goes back from the bound as far as it would have gone beyond."},
    {"out_of_bounds", "redraw", "The gene gets a uniform random value within its bounds."},
    {"free_gene_start", "uniform", "Every value of a gene is equally likely."},
    {"free_gene_start", "latin_hypercube", "Each equal part of a gene's range has one organism."},
    {"migration", "none", "The islands are independent."},
    {"migration", "ring", "Each island sends to the next one, the last to the first."},
    {"migration", "fully_connected", "Each island sends to every other island."},
    {"migration", "random", "Each island sends to one other island, which is drawn each time."},
    {"emigrants", "best", "The fittest organisms are copied."},
    {"emigrants", "random", "The copied organisms are drawn at random."},
    {"immigrants_replace", "worst", "Migrants replace the least fit organisms."},
    {"immigrants_replace", "random", "Migrants replace organisms drawn at random."},
    {"controller", "rules", "Organisms flee, seek and wander by fixed rules."},
    {"controller", "network", "A neural network steers each organism; its weights are genes."},
    {"locomotion", "newtonian", "The network sets a force along the heading and a turn rate; bodies collide."},
    {"locomotion", "kinematic", "The network changes the speed and the heading; bodies pass through each other."},
};

} // namespace

std::string_view choice_help(std::string_view parameter, std::string_view choice) {
    constexpr std::string_view of_predators = "predator_"; // predator_selection has the choices of selection
    if (parameter.starts_with(of_predators)) {
        parameter.remove_prefix(of_predators.size());
    }
    const auto* found = std::ranges::find_if(sentences, [&](const Sentence& sentence) {
        return sentence.parameter == parameter && sentence.choice == choice;
    });
    return found == std::end(sentences) ? "" : found->help;
}

} // namespace evod::parameters
