#include "client/viewer/world/experiment.h"

#include "client/viewer/text/numbers.h"
#include "client/viewer/world/parameter_edits.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <span>
#include <utility>

namespace evod::viewer {

namespace {

/// Returns a sentence about how the selection method chooses parents.
std::string selection_text(const std::string& selection, bool shuffled) {
    if (shuffled) {
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

/// Returns "is 2 × the time lived plus the health at the end": a sum of the parts whose weight is not 0.
std::string weighted_sum_text(std::span<const std::pair<double, const char*>> parts) {
    std::string text;
    for (const auto& [weight, part] : parts) {
        if (weight == 0) {
            continue;
        }
        const char* sign = text.empty() ? (weight < 0 ? " −" : " ") : weight < 0 ? " minus " : " plus ";
        const double size = std::abs(weight);
        text += sign + (size == 1 ? "" : shown_number(size) + " × ") + part;
    }
    return text.empty() ? "is 0 for all organisms" : "is" + text;
}

} // namespace

std::string experiment_text(const evod::v1::ParameterSet& set) {
    std::map<std::string, evod::v1::ParameterValue> values;
    for (const evod::v1::ParameterState& parameter : set.parameters()) {
        values.emplace(parameter.name(), parameter.value());
    }
    const auto number = [&](const char* name) { return shown_number(number_of(values[name])); };
    const auto choice = [&](const char* name) { return values[name].choice(); };
    const auto weighted = [&](const char* name, const char* part) { return std::pair{number_of(values[name]), part}; };
    const std::string fitness =
        choice("fitness") == "external" ? "comes from a client at the end of each generation"
        : choice("fitness") != "life"
            ? "is computed from the genes alone (" + choice("fitness") + ")"
            : weighted_sum_text(std::array{weighted("fitness_per_second", "the time lived"),
                                           weighted("fitness_per_health", "the health at the end"),
                                           weighted("fitness_per_food", "the food eaten"),
                                           weighted("fitness_per_poison", "the poison eaten")});
    const bool has_gene_costs = std::ranges::any_of(
        values, [](const auto& value) { return value.first.ends_with("_cost") && number_of(value.second) != 0; });
    const bool has_networks = choice("controller") == "network";
    const auto is_zero = [&](const char* name) { return values.contains(name) && number_of(values[name]) == 0; };
    std::string text =
        number("population_size") +
        (has_networks ? " organisms, each steered by an evolving neural network, eat" : " organisms seek") +
        " food (+" + number("food_health") + " health)";
    if (!is_zero("poison_count")) {
        text += std::string{has_networks ? " and poison (−" : " and avoid poison (−"} + number("poison_harm") + ")";
    }
    text += has_networks ? "; a line shows where each heads. " : ". ";
    text += is_zero("health_loss_per_s") && !has_gene_costs
                ? "They lose no health over time."
                : "Each loses " + number("health_loss_per_s") + " health per second" +
                      (has_gene_costs ? ", more or less with its genes," : "") + " and dies at 0.";
    return text + " Fitness " + fitness + ". " + selection_text(choice("selection"), values["shuffle_fitness"].flag());
}

void Experiment::update(ViewedWorld& world, Poll::Clock::time_point now) {
    const RunControl& control = world.feed.control();
    if (!control.known()) {
        return;
    }
    if (control.world() != world_ || control.run_id() != run_id_) {
        world_ = control.world();
        run_id_ = control.run_id();
        text_.clear();
        stale_ = true;
    }
    stale_ = stale_ || connected_count_ != world.server.status().connected_count;
    connected_count_ = world.server.status().connected_count;
    for (const evod::v1::Event& event : world.feed.events()) {
        stale_ =
            stale_ || event.has_parameters_changed() || event.has_generation_finished() || event.has_events_dropped();
    }
    if (!stale_ || !poll_.due(world, now)) {
        return;
    }
    stale_ = false;
    evod::v1::Request request;
    request.mutable_get_parameters()->set_world(world_);
    poll_.send(world, std::move(request), now, [this](const evod::v1::Response* response) {
        if (response != nullptr) {
            text_ = experiment_text(response->parameters());
        } else {
            stale_ = true;
        }
    });
}

} // namespace evod::viewer
