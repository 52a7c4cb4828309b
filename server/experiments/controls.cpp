#include "server/experiments/controls.h"

#include "server/evolution/gene_layout.h"

#include <algorithm>
#include <span>
#include <string_view>
#include <utility>

namespace evod::experiments {
namespace {

using namespace evolution; // enumerations of the evolution parameters
using parameters::Parameters;

/// Removes every influence of fitness on breeding.
Parameters with_random_selection(Parameters p) {
    p.selection = SelectionMethod::Random;
    p.elite_count = 0;
    if (p.predator_count > 0) {
        p.predator_selection = SelectionMethod::Random;
        p.predator_elite_count = 0;
    }
    if (p.population_model == PopulationModel::SteadyState) {
        // Steady state keeps the fittest organisms. The hybrid model keeps the same number of organisms, drawn at
        // random.
        p.population_model =
            p.replaced_count < p.population_size ? PopulationModel::Hybrid : PopulationModel::Generational;
        if (p.population_model == PopulationModel::Hybrid) {
            p.survivors = static_cast<double>(p.population_size - p.replaced_count) / p.population_size;
        }
    }
    if (p.population_model == PopulationModel::Nsga2) {
        p.population_model = PopulationModel::Hybrid; // the same number of survivors, drawn at random
    }
    if (p.migration != Topology::None && p.island_count > 1) {
        p.emigrants = Emigrants::Random;
        p.immigrants_replace = Replaced::Random;
    }
    return p;
}

/// Whether a creep mutation can change a gene: a group that mutates has genes, and a step.
bool has_creep_step(const Parameters& p) {
    const auto can_creep = [&](GeneGroup group, double step) {
        return step > 0 && (p.mutate_group == GeneGroup::All || p.mutate_group == group) &&
               evolution::genes_of(group, p).count > 0;
    };
    return can_creep(GeneGroup::Body, p.mutation_step) || can_creep(GeneGroup::Brain, p.brain_mutation_step) ||
           can_creep(GeneGroup::Free, p.free_mutation_step);
}

bool mutates_one_species(const Parameters& p) {
    return (p.mutation_chance > 0 && has_creep_step(p)) || p.reset_chance > 0 ||
           (p.scale_chance > 0 && p.scale_range > 0) || p.bit_flip_chance > 0 ||
           (p.rearranging != OrderMutationMethod::None && p.rearrange_chance > 0 &&
            evolution::genes_of(p.mutate_group, p).count > 1);
}

bool mutates(const Parameters& p) {
    return mutates_one_species(p) || (p.predator_count > 0 && mutates_one_species(parameters::of_predators(p)));
}

Parameters without_mutation(Parameters p) {
    p.mutation_chance = 0;
    if (p.predator_count > 0) {
        p.predator_mutation_chance = 0;
    }
    p.reset_chance = 0;
    p.scale_chance = 0;
    p.bit_flip_chance = 0;
    p.rearranging = OrderMutationMethod::None;
    return p;
}

std::string why_poison_has_no_effect(const Parameters& p) {
    if (!parameters::has_bodies(p)) {
        return "the fitness is a function of the chromosome, and organisms do not eat";
    }
    if (parameters::island_plan(p).poison_count == 0) {
        return "there is no poison";
    }
    return p.poison_harm == 0 && p.fitness_per_poison == 0 ? "poison_harm is already 0" : "";
}

std::string why_nothing_is_selected(const Parameters& p) {
    return with_random_selection(p) == p ? "parents are already drawn at random" : "";
}

using Names = std::span<const std::string_view>;

constexpr std::string_view random_selection[] = {"selection",          "elite_count",        "population_model",
                                                 "survivors",          "replaced_count",     "emigrants",
                                                 "immigrants_replace", "predator_selection", "predator_elite_count"};
constexpr std::string_view mutation_off[] = {"mutation_chance", "reset_chance", "scale_chance",
                                             "bit_flip_chance", "rearranging",  "predator_mutation_chance"};
constexpr std::string_view harmless_poison[] = {"poison_harm", "fitness_per_poison"};
constexpr std::string_view shuffled_fitness[] = {"shuffle_fitness"};
constexpr std::string_view unselected_parents[] = {"shuffle_births"};
constexpr std::string_view mutation_conditions[] = {
    "mutation_step", "brain_mutation_step", "free_mutation_step",    "mutate_group",
    "scale_range",   "rearrange_chance",    "predator_mutation_step"};
constexpr std::string_view poison_conditions[] = {"poison_count", "population_size", "scale_with_population"};

struct NamesOfControl {
    Names sets;       // parameters that the control sets
    Names depends_on; // other parameters that determine whether the control can differ
};
NamesOfControl names_of(ControlKind kind) {
    switch (kind) {
    case ControlKind::RandomSelection:
        return {random_selection, {}};
    case ControlKind::MutationOff:
        return {mutation_off, mutation_conditions};
    case ControlKind::HarmlessPoison:
        return {harmless_poison, poison_conditions};
    case ControlKind::UnselectedParents:
        return {unselected_parents, {}};
    case ControlKind::ShuffledFitness:
        break;
    }
    return {shuffled_fitness, random_selection};
}

} // namespace

parameters::Schedule schedule_of(parameters::Schedule world, ControlKind kind) {
    for (const std::string_view name : names_of(kind).sets) {
        world.remove(name);
    }
    return world;
}

bool schedule_affects(const parameters::Schedule& world, ControlKind kind) {
    const auto is_scheduled = [&](std::string_view name) { return world.holds(name); };
    const auto [sets, depends_on] = names_of(kind);
    return std::ranges::any_of(sets, is_scheduled) || std::ranges::any_of(depends_on, is_scheduled);
}

Control control_of(const Parameters& world, ControlKind kind) {
    Control control{kind, {}, world, {}};
    switch (kind) {
    case ControlKind::RandomSelection:
        control.name = "random_selection";
        control.parameters = with_random_selection(world);
        control.cannot_differ = why_nothing_is_selected(world);
        break;
    case ControlKind::MutationOff:
        control.name = "mutation_off";
        control.parameters = without_mutation(world);
        control.cannot_differ = mutates(world) ? "" : "there is no mutation";
        break;
    case ControlKind::HarmlessPoison:
        control.name = "harmless_poison";
        control.parameters.poison_harm = 0;
        control.parameters.fitness_per_poison = 0;
        control.cannot_differ = why_poison_has_no_effect(world);
        break;
    case ControlKind::ShuffledFitness:
        control.name = "shuffled_fitness";
        control.parameters.shuffle_fitness = true;
        control.cannot_differ =
            world.shuffle_fitness ? "shuffle_fitness is already true" : why_nothing_is_selected(world);
        break;
    case ControlKind::UnselectedParents:
        control.name = "unselected_parents";
        control.parameters.shuffle_births = true;
        control.cannot_differ = world.shuffle_births ? "shuffle_births is already true" : "";
        break;
    }
    return control;
}

Parameters of_fixed_length(Parameters world, std::uint32_t generations) {
    world.generation_limit = generations;
    world.stop_at_target_fitness = false;
    world.stagnation_limit = 0;
    world.stop_at_extinction = false;
    return world;
}

parameters::Schedule of_fixed_length(parameters::Schedule world) {
    for (const char* name : {"generation_limit", "stop_at_target_fitness", "stagnation_limit", "stop_at_extinction"}) {
        world.remove(name);
    }
    return world;
}

std::string changes_between(const Parameters& world, const Parameters& other) {
    std::string text;
    for (const parameters::ParameterDescription* description : parameters::parameters_that_differ(world, other)) {
        text += (text.empty() ? "" : " ") + std::string{description->name} + "=" +
                parameters::to_text(description->get(other));
    }
    return text;
}

} // namespace evod::experiments
