// Controls: variants of a world. Each control removes one possible cause of the rise in fitness.
//
// A control is an ordinary set of parameters, so it can be run, recorded, replayed and verified like any world.
//
// Threads  none.
#pragma once

#include "server/parameters/model_parameters.h"
#include "server/parameters/schedule.h"

#include <string>
#include <vector>

namespace evod::experiments {

enum class ControlKind {
    RandomSelection,   // parents, survivors and migrants are drawn at random
    MutationOff,       // no gene gets a new value; selection acts only on the genes of the first generation
    HarmlessPoison,    // poison reduces neither health nor fitness
    ShuffledFitness,   // the same selection pressure, but each organism gets the fitness of another one
    UnselectedParents, // with births: children get the genes of parents that are drawn among the latest births
};
/// The controls of a world whose generations are bred.
constexpr ControlKind all_controls[] = {ControlKind::RandomSelection, ControlKind::MutationOff,
                                        ControlKind::HarmlessPoison, ControlKind::ShuffledFitness};
/// The controls of a world with births.
constexpr ControlKind controls_of_births[] = {ControlKind::MutationOff, ControlKind::UnselectedParents};

struct Control {
    ControlKind kind;
    std::string name; // "random_selection"
    parameters::Parameters parameters;
    std::string cannot_differ; // reason why the control equals the world; empty: it can differ
};

/// Returns the control of this kind for a world with valid parameters.
Control control_of(const parameters::Parameters& world, ControlKind kind);

/// The schedule of the control: the schedule of the world without the parameters that the control sets for all
/// generations.
parameters::Schedule schedule_of(parameters::Schedule world, ControlKind kind);
/// Whether the schedule changes a parameter that determines whether the control can differ from the world.
bool schedule_affects(const parameters::Schedule& world, ControlKind kind);

/// Makes generation_limit the only termination criterion of the world. Any other criterion would end the compared
/// worlds after different numbers of generations. An extinct population breeds like any other, according to the
/// fitness that its organisms reached. Only a world with births ends without prey.
parameters::Parameters of_fixed_length(parameters::Parameters world, std::uint32_t generations);

/// Removes the termination criteria from the schedule.
parameters::Schedule of_fixed_length(parameters::Schedule world);

/// Returns the parameters that differ, with the values of `other`: "selection=random elite_count=0". Empty if none
/// differs.
std::string changes_between(const parameters::Parameters& world, const parameters::Parameters& other);

} // namespace evod::experiments
