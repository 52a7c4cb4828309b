#include "server/protocol/experiment_summary.h"

#include "proto/text/number_text.h"

#include <algorithm>
#include <array>
#include <cmath>
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
        return description.name.ends_with("_cost") && cost != nullptr && *cost != 0;
    });
}

} // namespace

std::string experiment_summary(const Parameters& p) {
    const bool has_networks = choice_of("controller", p) == "network", has_costs = has_gene_costs(p);
    std::string summary =
        shown(static_cast<double>(p.population_size)) +
        (has_networks ? " organisms, each steered by an evolving neural network, eat" : " organisms seek") +
        " food (+" + shown(p.food_health) + " health)";
    if (p.poison_count != 0) {
        summary += (has_networks ? " and poison (−" : " and avoid poison (−") + shown(p.poison_harm) + ")";
    }
    summary += has_networks ? "; a line shows where each heads. " : ". ";
    summary += p.health_loss_per_s == 0 && !has_costs
                   ? "They lose no health over time."
                   : "Each loses " + shown(p.health_loss_per_s) + " health per second" +
                         (has_costs ? ", more or less with its genes," : "") + " and dies at 0.";
    return summary + " Fitness " + about_fitness(p) + ". " + about_selection(p, choice_of("selection", p));
}

} // namespace evod::protocol
