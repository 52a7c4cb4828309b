#include "server/experiments/controls.h"

#include "server/base/inline_executor.h"
#include "server/simulation/world.h"

#include <gtest/gtest.h>

#include <iterator>

namespace evod::experiments {
namespace {

using parameters::Parameters;

std::string changes(const Parameters& world, ControlKind kind) {
    const Control control = control_of(world, kind);
    EXPECT_EQ(control.cannot_differ, "");
    EXPECT_TRUE(parameters::validate(control.parameters).empty());
    return changes_between(world, control.parameters);
}

TEST(Controls, OfTheDefaultWorldChangeOneParameterEach) {
    EXPECT_EQ(changes({}, ControlKind::RandomSelection), "selection=random");
    EXPECT_EQ(changes({}, ControlKind::MutationOff), "mutation_chance=0");
    EXPECT_EQ(changes({}, ControlKind::HarmlessPoison), "poison_harm=0");
    EXPECT_EQ(changes({}, ControlKind::ShuffledFitness), "shuffle_fitness=true");
}

TEST(Controls, RandomSelectionIgnoresFitness) {
    Parameters world;
    world.elite_count = 3;
    world.migration = evolution::Topology::Ring;
    EXPECT_EQ(changes(world, ControlKind::RandomSelection), "elite_count=0 selection=random");
    world.island_count = 2; // with one island there is no migration
    EXPECT_EQ(changes(world, ControlKind::RandomSelection),
              "elite_count=0 selection=random emigrants=random immigrants_replace=random");
    world = {};
    world.population_model = evolution::PopulationModel::SteadyState; // keeps the fittest
    world.replaced_count = 20;
    EXPECT_EQ(changes(world, ControlKind::RandomSelection), "population_model=hybrid survivors=0.6 selection=random");
    world.replaced_count = 50;
    EXPECT_EQ(changes(world, ControlKind::RandomSelection), "population_model=generational selection=random");
}

TEST(Controls, IncludePredators) {
    Parameters world;
    world.predator_count = 5;
    world.predator_elite_count = 2;
    EXPECT_EQ(changes(world, ControlKind::RandomSelection),
              "predator_selection=random predator_elite_count=0 selection=random");
    EXPECT_EQ(changes(world, ControlKind::MutationOff), "predator_mutation_chance=0 mutation_chance=0");
    world.mutation_chance = 0;
    EXPECT_EQ(changes(world, ControlKind::MutationOff), "predator_mutation_chance=0");
}

TEST(Controls, OfBirthsDrawParentsAmongTheLatestBirths) {
    Parameters world;
    world.reproduction = parameters::Reproduction::Births;
    EXPECT_EQ(changes(world, ControlKind::UnselectedParents), "shuffle_births=true");
    EXPECT_EQ(changes(world, ControlKind::MutationOff), "mutation_chance=0");
    world.shuffle_births = true;
    EXPECT_EQ(control_of(world, ControlKind::UnselectedParents).cannot_differ, "shuffle_births is already true");
}

TEST(Controls, HarmlessPoisonDoesNotAffectFitness) {
    Parameters world;
    world.fitness_per_poison = -10;
    EXPECT_EQ(changes(world, ControlKind::HarmlessPoison), "fitness_per_poison=0 poison_harm=0");
    world.poison_harm = 0;
    EXPECT_EQ(changes(world, ControlKind::HarmlessPoison), "fitness_per_poison=0");
    world.fitness_per_poison = 0;
    EXPECT_EQ(control_of(world, ControlKind::HarmlessPoison).cannot_differ, "poison_harm is already 0");
}

TEST(Controls, KeepTheScheduleOfOtherParameters) {
    parameters::Schedule schedule;
    schedule.add(30, {"mutation_chance", 0.05});
    schedule.add(40, {"food_count", 5u});
    const auto count = [](const parameters::Schedule& s, std::uint64_t generation) { return s.at(generation).size(); };
    EXPECT_EQ(schedule_of(schedule, ControlKind::ShuffledFitness), schedule);
    EXPECT_EQ(count(schedule_of(schedule, ControlKind::MutationOff), 30), 0u);
    EXPECT_EQ(count(schedule_of(schedule, ControlKind::MutationOff), 40), 1u);
    EXPECT_TRUE(schedule_affects(schedule, ControlKind::MutationOff)) << "it may begin without mutation";
    EXPECT_FALSE(schedule_affects(schedule, ControlKind::HarmlessPoison));
    schedule.add(5, {"generation_limit", 7u});
    EXPECT_FALSE(of_fixed_length(schedule).holds("generation_limit"));
    EXPECT_TRUE(of_fixed_length(schedule).holds("food_count"));
}

TEST(Controls, RemoveTheirParametersFromTheSchedule) {
    // A control must remove what it changes from the schedule.
    Parameters world;
    world.population_model = evolution::PopulationModel::SteadyState;
    world.replaced_count = 20;
    world.elite_count = 3;
    world.island_count = 2;
    world.migration = evolution::Topology::Ring;
    world.reset_chance = world.bit_flip_chance = world.scale_chance = world.rearrange_chance = 0.1;
    world.rearranging = evolution::OrderMutationMethod::Swap;
    world.fitness_per_poison = -10;
    for (const ControlKind kind : all_controls) {
        const Control control = control_of(world, kind);
        for (const parameters::ParameterDescription& description : parameters::parameter_registry()) {
            if (description.get(control.parameters) == description.get(world)) {
                continue;
            }
            parameters::Schedule schedule;
            schedule.add(2, {std::string{description.name}, description.get(world)});
            EXPECT_TRUE(schedule_affects(schedule, kind)) << control.name << " changes " << description.name;
            EXPECT_FALSE(schedule_of(schedule, kind).holds(description.name));
        }
    }
}

TEST(Controls, RandomSelectionBreedsTheSameForAnyFitness) {
    // In every population model, shuffling the fitness does not change the children.
    base::InlineExecutor executor;
    for (const auto model : {evolution::PopulationModel::Hybrid, evolution::PopulationModel::Generational,
                             evolution::PopulationModel::SteadyState, evolution::PopulationModel::Nsga2}) {
        Parameters parameters;
        parameters.fitness = parameters::FitnessFunction::GeneSum;
        parameters.population_model = model;
        parameters.replaced_count = 10;
        parameters.elite_count = 4;
        parameters.island_count = 3;
        parameters.migration = evolution::Topology::Ring;
        parameters.migration_epoch = 1;
        Parameters random = control_of(parameters, ControlKind::RandomSelection).parameters;
        for (const bool is_control : {true, false}) {
            Parameters& p = is_control ? random : parameters;
            simulation::World plain{p, base::Seed{3}};
            p.shuffle_fitness = true;
            simulation::World shuffled{p, base::Seed{3}};
            for (int generation = 0; generation < 4; ++generation) {
                plain.advance_tick(executor);
                shuffled.advance_tick(executor);
            }
            EXPECT_EQ(plain.hash() == shuffled.hash() &&
                          (plain.islands()[1].born().genes == shuffled.islands()[1].born().genes).all(),
                      is_control);
        }
    }
}

TEST(Controls, MutationOffTurnsOffAllMutationOperators) {
    Parameters world;
    world.reset_chance = 0.1;
    world.bit_flip_chance = 0.1;
    world.scale_chance = 0.1;
    world.rearranging = evolution::OrderMutationMethod::Swap;
    EXPECT_EQ(changes(world, ControlKind::MutationOff),
              "rearranging=none mutation_chance=0 reset_chance=0 scale_chance=0 bit_flip_chance=0");
}

TEST(Controls, SayWhyTheyCannotDiffer) {
    const auto why = [](const Parameters& world, ControlKind kind) { return control_of(world, kind).cannot_differ; };
    Parameters world;
    world.selection = evolution::SelectionMethod::Random;
    EXPECT_EQ(why(world, ControlKind::RandomSelection), "parents are already drawn at random");
    EXPECT_EQ(why(world, ControlKind::ShuffledFitness), "parents are already drawn at random");
    world.elite_count = 1; // chosen by fitness
    EXPECT_EQ(why(world, ControlKind::RandomSelection), "");
    EXPECT_EQ(why(world, ControlKind::ShuffledFitness), "");
    world.shuffle_fitness = true;
    EXPECT_EQ(why(world, ControlKind::ShuffledFitness), "shuffle_fitness is already true");

    world = {};
    world.mutation_step = 0;
    world.rearrange_chance = 0;
    world.rearranging = evolution::OrderMutationMethod::Swap;
    EXPECT_EQ(why(world, ControlKind::MutationOff), "there is no mutation");
    world.bit_flip_chance = 0.01;
    EXPECT_EQ(why(world, ControlKind::MutationOff), "");

    world = {};
    world.poison_harm = 0;
    EXPECT_EQ(why(world, ControlKind::HarmlessPoison), "poison_harm is already 0");
    world.poison_count = 0;
    EXPECT_EQ(why(world, ControlKind::HarmlessPoison), "there is no poison");
    world.fitness = parameters::FitnessFunction::Rastrigin;
    EXPECT_EQ(why(world, ControlKind::HarmlessPoison),
              "the fitness is a function of the chromosome, and organisms do not eat");
}

TEST(Controls, KnowEveryGroupOfGenesThatMutates) {
    const auto why = [](const Parameters& world) { return control_of(world, ControlKind::MutationOff).cannot_differ; };
    Parameters world;
    world.mutation_step = 0;
    EXPECT_EQ(why(world), "there is no mutation");
    world.controller = evolution::Controller::Network;
    EXPECT_EQ(why(world), "") << "the weights creep by brain_mutation_step";
    world.mutate_group = evolution::GeneGroup::Body;
    EXPECT_EQ(why(world), "there is no mutation");
    world.controller = evolution::Controller::Rules;
    world.mutate_group = evolution::GeneGroup::All;
    world.free_genes = 1;
    EXPECT_EQ(why(world), "") << "the free gene creeps by free_mutation_step";
    world.free_mutation_step = 0;
    world.rearranging = evolution::OrderMutationMethod::Swap;
    world.mutate_group = evolution::GeneGroup::Free;
    EXPECT_EQ(why(world), "there is no mutation") << "one gene alone cannot be rearranged";
}

/// The values of a parameter that a test tries: its extremes, or all of its choices.
std::vector<parameters::ParameterValue> values_of(const parameters::ParameterDescription& description) {
    using namespace parameters;
    if (const auto* real = std::get_if<RealParameter>(&description.kind)) {
        return {real->range.min, real->range.max};
    }
    if (const auto* whole = std::get_if<CountParameter>(&description.kind)) {
        return {whole->range.min, whole->range.max};
    }
    if (std::holds_alternative<FlagParameter>(description.kind)) {
        return {false, true};
    }
    std::vector<ParameterValue> names;
    for (const std::string_view name : std::get<ChoiceParameter>(description.kind).names) {
        names.emplace_back(std::string{name});
    }
    return names;
}

TEST(Controls, KnowEveryParameterThatDecidesWhetherTheyDiffer) {
    Parameters still; // mutates in no way, but one parameter more lets it
    still.controller = evolution::Controller::Network;
    still.free_genes = 2;
    still.mutation_step = still.brain_mutation_step = still.free_mutation_step = 0;
    Parameters chosen;
    chosen.mutate_group = evolution::GeneGroup::Brain;
    chosen.controller = evolution::Controller::Network;
    chosen.brain_mutation_step = 0;
    Parameters harmless;
    harmless.poison_harm = 0;
    for (const Parameters& world : {Parameters{}, still, chosen, harmless}) {
        for (const ControlKind kind : all_controls) {
            const bool differs = control_of(world, kind).cannot_differ.empty();
            for (const parameters::ParameterDescription& description : parameters::parameter_registry()) {
                if (!parameters::can_be_scheduled(description)) {
                    continue;
                }
                parameters::Schedule schedule;
                schedule.add(2, {std::string{description.name}, description.get(world)});
                for (const parameters::ParameterValue& value : values_of(description)) {
                    const auto changed = parameters::assign(
                        world, std::vector{parameters::Assignment{std::string{description.name}, value}});
                    EXPECT_TRUE(!changed || control_of(*changed, kind).cannot_differ.empty() == differs ||
                                schedule_affects(schedule, kind))
                        << control_of(world, kind).name << " depends on " << description.name;
                }
            }
        }
    }
}

TEST(Controls, AWorldOfFixedLengthHasNoOtherCriterion) {
    Parameters world;
    world.stop_at_extinction = true;
    world.stop_at_target_fitness = true;
    world.stagnation_limit = 3;
    const Parameters fixed = of_fixed_length(world, 9);
    EXPECT_EQ(changes_between({}, fixed), "generation_limit=9");
}

} // namespace
} // namespace evod::experiments
