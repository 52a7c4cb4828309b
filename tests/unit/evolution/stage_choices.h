// Parameters for every choice of every stage of the genetic algorithm, with the other stages at their defaults, and one
// set that combines the slowest choices.
#pragma once

#include "server/evolution/ga_parameters.h"

#include <ostream>
#include <string>
#include <vector>

namespace evod::evolution {

struct StageChoice : Parameters {
    std::string name; // "selection=tournament"
    friend void PrintTo(const StageChoice& choice, std::ostream* out) { *out << choice.name; }
};

inline StageChoice slowest_choices() {
    StageChoice choice;
    choice.name = "slowest choices together";
    choice.population_model = PopulationModel::Generational;
    choice.fitness_scaling = FitnessScaling::ExponentialRanking;
    choice.selection = SelectionMethod::Tournament;
    choice.tournament_replacement = false;
    choice.tournament_size = 7;
    choice.crossover = CrossoverMethod::MultiPoint;
    choice.rearranging = OrderMutationMethod::Scramble;
    choice.rearrange_chance = 1;
    choice.creep = Creep::Gaussian;
    choice.mutation_chance = 1;
    choice.reset_chance = 0.1;
    choice.bit_flip_chance = 0.1;
    choice.bit_flip_bits = 24;
    choice.mutate_survivors = true;
    choice.elite_count = 100;
    return choice;
}

inline std::vector<StageChoice> stage_choices() {
    std::vector<StageChoice> choices;
    const auto add = [&](std::string name, auto change) {
        StageChoice choice;
        choice.name = std::move(name);
        change(choice);
        choices.push_back(std::move(choice));
    };
    const auto add_each = [&]<class Choice>(const std::string& stage, Choice Parameters::*member) {
        for (std::size_t i = 0; i < std::size(base::ChoiceNames<Choice>::names); ++i) {
            add(stage + "=" + std::string{base::ChoiceNames<Choice>::names[i]},
                [&](Parameters& parameters) { parameters.*member = static_cast<Choice>(i); });
        }
    };
    add_each("population_model", &Parameters::population_model);
    for (const SelectionMethod method : {SelectionMethod::StochasticUniversal, SelectionMethod::Tournament,
                                         SelectionMethod::Random, SelectionMethod::Truncation}) {
        add("population_model=nsga2,selection=" +
                std::string{base::ChoiceNames<SelectionMethod>::names[static_cast<std::size_t>(method)]},
            [&](Parameters& parameters) {
                parameters.population_model = PopulationModel::Nsga2;
                parameters.selection = method;
            });
    }
    for (std::size_t i = 1; i < std::size(base::ChoiceNames<FitnessScaling>::names); ++i) {
        for (const SelectionMethod method : {SelectionMethod::Roulette, SelectionMethod::StochasticUniversal}) {
            add("fitness_scaling=" + std::string{base::ChoiceNames<FitnessScaling>::names[i]} +
                    (method == SelectionMethod::Roulette ? "" : ",selection=stochastic_universal"),
                [&](Parameters& parameters) {
                    parameters.fitness_scaling = static_cast<FitnessScaling>(i);
                    parameters.selection = method;
                });
        }
    }
    add_each("selection", &Parameters::selection);
    for (const bool replacement : {true, false}) {
        for (const std::uint32_t size : {20u, 200u}) {
            for (const std::uint32_t winners : {1u, 3u}) {
                add("tournament size=" + std::to_string(size) + ",winners=" + std::to_string(winners) +
                        (replacement ? "" : ",without replacement"),
                    [&](Parameters& parameters) {
                        parameters.selection = SelectionMethod::Tournament;
                        parameters.tournament_size = size;
                        parameters.tournament_winners = winners;
                        parameters.tournament_replacement = replacement;
                    });
            }
        }
    }
    add_each("crossover", &Parameters::crossover);
    add("crossover_chance=0.5", [](Parameters& parameters) { parameters.crossover_chance = 0.5; });
    for (std::size_t i = 1; i < std::size(base::ChoiceNames<OrderMutationMethod>::names); ++i) {
        add("rearranging=" + std::string{base::ChoiceNames<OrderMutationMethod>::names[i]},
            [&](Parameters& parameters) {
                parameters.rearranging = static_cast<OrderMutationMethod>(i);
                parameters.rearrange_chance = 1;
            });
    }
    add_each("creep", &Parameters::creep);
    add("reset_chance=0.15", [](Parameters& parameters) { parameters.reset_chance = 0.15; });
    add("bit_flip_chance=0.01", [](Parameters& parameters) { parameters.bit_flip_chance = 0.01; });
    add("mutate_survivors", [](Parameters& parameters) { parameters.mutate_survivors = true; });
    add("elite_count=10", [](Parameters& parameters) { parameters.elite_count = 10; });
    add("survivors=0.001", [](Parameters& parameters) { parameters.survivors = 0.001; });
    choices.push_back(slowest_choices());
    add("scale_chance=0.5", [](Parameters& parameters) { parameters.scale_chance = 0.5; });
    for (const OutOfBounds way : {OutOfBounds::Reflect, OutOfBounds::Redraw}) {
        add(way == OutOfBounds::Reflect ? "out_of_bounds=reflect" : "out_of_bounds=redraw",
            [&](Parameters& parameters) {
                parameters.out_of_bounds = way;
                parameters.mutation_step = 200;
            });
    }
    return choices;
}

} // namespace evod::evolution
