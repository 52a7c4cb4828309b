#include "server/protocol/experiment_summary.h"

#include "proto/text/number_text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <span>
#include <string_view>
#include <utility>
#include <variant>

namespace evod::protocol {
namespace {

using parameters::Parameters;

/// "2.5", "−3", "10,000".
std::string shown(double number) {
    const double size = std::abs(number);
    const bool is_whole = size == std::floor(size) && size < 1e15;
    return (number < 0 ? "−" : "") + (is_whole ? text::with_separators(static_cast<std::uint64_t>(size))
                                               : text::number_text(size, text::Exponent::IfLong));
}

/// A sentence about how the selection method chooses parents.
std::string about_selection(const Parameters& parameters, const std::string& selection) {
    if (parameters.shuffle_fitness) {
        return "Fitness is shuffled among the organisms before the selection, so fitter organisms have no more "
               "offspring than others.";
    }
    if (selection == "random") {
        return "Parents are chosen at random, whatever their fitness.";
    }
    if (selection == "truncation") {
        return "Only the fittest have offspring.";
    }
    return "On average, fitter organisms have more offspring (" +
           (selection == "stochastic_universal" ? std::string{"stochastic universal"} : selection) + " selection).";
}

/// "is 2 × the time lived plus the health at the end": a sum of the parts whose weight is not 0.
std::string about_weights(std::span<const std::pair<double, const char*>> parts) {
    std::string sum;
    for (const auto& [weight, part] : parts) {
        if (weight == 0) {
            continue;
        }
        const char* sign = sum.empty() ? (weight < 0 ? " −" : " ") : weight < 0 ? " minus " : " plus ";
        const double size = std::abs(weight);
        sum += sign + (size == 1 ? "" : shown(size) + " × ") + part;
    }
    return sum.empty() ? "is 0 for all organisms" : "is" + sum;
}

/// The present choice of a parameter: "tournament".
std::string choice_of(std::string_view name, const Parameters& parameters) {
    const auto found =
        std::ranges::find(parameters::parameter_registry(), name, &parameters::ParameterDescription::name);
    return std::get<std::string>(found->get(parameters));
}

std::string about_fitness(const Parameters& p) {
    if (parameters::has_births(p)) {
        return "is the number of children";
    }
    const std::string fitness = choice_of("fitness", p);
    if (fitness == "external") {
        return "comes from a client at the end of each generation";
    }
    if (fitness != "life") {
        return "is computed from the genes alone (" + fitness + ")";
    }
    return about_weights(std::array{
        std::pair{p.fitness_per_second, "the time lived"}, std::pair{p.fitness_per_health, "the health at the end"},
        std::pair{p.fitness_per_food, "the food eaten"}, std::pair{p.fitness_per_poison, "the poison eaten"}});
}

bool has_gene_costs(const Parameters& parameters) {
    return std::ranges::any_of(parameters::parameter_registry(), [&](const auto& description) {
        const auto value = description.get(parameters);
        const auto* cost = std::get_if<double>(&value);
        const bool is_of_gene = description.name.ends_with("_cost") && !description.name.ends_with("birth_cost");
        return is_of_gene && cost != nullptr && *cost != 0;
    });
}

/// "8 organisms", "1 organism".
std::string counted(std::uint32_t count, const std::string& one, const std::string& many) {
    return shown(count) + " " + (count == 1 ? one : many);
}

/// What the organisms do: "50 organisms seek food (+25 health) and avoid poison (−40)", without the full stop.
std::string about_meals(const Parameters& p) {
    const bool has_networks = p.controller == evolution::Controller::Network;
    std::string text = counted(p.population_size, "organism", "organisms") +
                       (has_networks ? ", each steered by an evolving neural network, gain health from" : " seek") +
                       " food (+" + shown(p.food_health) + (has_networks ? ")" : " health)");
    if (p.poison_count != 0) {
        const bool always = p.flee_rule == parameters::FleeRule::Always;
        text += std::string{has_networks ? " and lose it from poison"
                            : always     ? " and always flee from poison"
                                         : " and avoid poison"} +
                " (−" + shown(p.poison_harm) + ")";
    }
    if (p.obstacle_count > 0 || p.crate_count > 0) {
        text += " among ";
        text += p.obstacle_count > 0 ? counted(p.obstacle_count, "obstacle", "obstacles") : "";
        text += p.obstacle_count > 0 && p.crate_count > 0 ? " and " : "";
        text += p.crate_count > 0 ? counted(p.crate_count, "crate", "crates") : "";
    }
    return text;
}

/// "From interval 10 on, 20 predators hunt them. "; empty if there are none.
std::string about_predators(const Parameters& p) {
    if (p.predator_count == 0) {
        return "";
    }
    const std::string round = parameters::has_births(p) ? "interval " : "generation ";
    const std::string from = p.predator_from > 1 ? "From " + round + shown(p.predator_from) + " on, " : "";
    return from + counted(p.predator_count, "predator hunts", "predators hunt") + " them. ";
}

/// The life of organisms with bodies.
std::string about_life(const Parameters& p) {
    const bool has_networks = p.controller == evolution::Controller::Network, has_costs = has_gene_costs(p);
    std::string text = about_meals(p) + (has_networks ? "; a line shows where each heads. " : ". ");
    if (!has_networks && p.steering_lookahead_s == 0) {
        text += "They orbit their food, because they do not steer ahead. ";
    }
    return text +
           (p.health_loss_per_s == 0 && !has_costs
                ? "They lose no health over time. "
                : "Each loses " + shown(p.health_loss_per_s) + " health per second" +
                      (has_costs ? ", more or less with its genes," : "") + " and dies at 0. ") +
           about_predators(p);
}

/// What islands exchange; empty for one island.
std::string about_migration(const Parameters& p) {
    if (p.island_count == 1) {
        return "";
    }
    if (p.migration == evolution::Topology::None) {
        return "Nothing migrates between the islands. ";
    }
    const std::string which = p.emigrants == evolution::Emigrants::Best ? "best" : "random";
    const std::string what = p.migrant_count != 1 ? "copies of " + shown(p.migrant_count) + " " + which + " organisms"
                             : which == "best"    ? "a copy of its best organism"
                                                  : "a copy of a random organism";
    return (p.migration_epoch == 1 ? std::string{"After each generation"}
                                   : "Every " + shown(p.migration_epoch) + " generations") +
           ", each island sends " + what +
           (p.migration == evolution::Topology::Ring             ? " to the next island. "
            : p.migration == evolution::Topology::FullyConnected ? " to every other island. "
                                                                 : " to a random other island. ");
}

/// How organisms come into a world with births.
std::string about_births(const Parameters& p) {
    return " There are no generations: " +
           std::string{p.births == parameters::Births::Sexual ? "two organisms" : "an organism"} + " with at least " +
           shown(p.birth_health) +
           (p.births == parameters::Births::Sexual ? " health have a child" : " health has a child") + " and pay" +
           (p.births == parameters::Births::Sexual ? "" : "s") + " for it with health." +
           (p.generation_limit == 0 ? "" : " The run ends after interval " + shown(p.generation_limit) + ".");
}

/// How a generation replaces the previous one, where that differs from the default, and when the run ends.
std::string about_generations(const Parameters& p) {
    using evolution::PopulationModel;
    std::string text;
    if (p.population_model == PopulationModel::Generational) {
        text += " Each generation replaces all organisms" +
                (p.elite_count == 0 ? "" : " except the " + shown(p.elite_count) + " best") + ".";
    } else if (p.population_model == PopulationModel::SteadyState) {
        text += " Each generation replaces only the " + shown(p.replaced_count) + " worst organisms.";
    } else if (p.population_model == PopulationModel::Nsga2) {
        text += " The best organisms survive, and parents are selected among them.";
    } else if (p.mutate_survivors) {
        text += " Survivors mutate, too.";
    }
    if (p.generation_limit != 0) {
        text += " The run ends after generation " + shown(p.generation_limit) + ".";
    }
    return text;
}

} // namespace

std::string experiment_summary(const Parameters& p) {
    const bool has_bodies = parameters::has_bodies(p);
    return (p.island_count == 1 ? "" : "On each of " + shown(p.island_count) + " islands: ") +
           (has_bodies ? about_life(p)
                       : counted(p.population_size, "organism has no body", "organisms have no bodies") +
                             "; only their genes count. ") +
           (p.free_genes == 0 ? ""
                              : "Each has " + counted(p.free_genes, "free gene", "free genes") +
                                    (has_bodies ? ", which its body does not use. " : ". ")) +
           about_migration(p) + "Fitness " + about_fitness(p) + "." +
           (parameters::has_births(p) ? about_births(p)
                                      : " " + about_selection(p, choice_of("selection", p)) + about_generations(p));
}

std::string schedule_summary(const parameters::Schedule& schedule, std::uint64_t after_generation) {
    const auto& changes = schedule.changes();
    std::string text;
    for (auto change = changes.upper_bound(after_generation); change != changes.end(); ++change) {
        text += (text.empty()                         ? " Parameters change in generation "
                 : std::next(change) == changes.end() ? " and "
                                                      : ", ") +
                text::with_separators(change->first);
    }
    return text.empty() ? text : text + ".";
}

} // namespace evod::protocol
