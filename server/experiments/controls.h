// Controls: variants of a world that each lack one possible cause of its rise in fitness.
//
// A control is a plain set of parameters, so it can be run, recorded, replayed and verified like any world.
//
// Threads  none.
#pragma once

#include "server/parameters/parameters.h"
#include "server/parameters/schedule.h"

#include <string>
#include <vector>

namespace evod::experiments {

enum class ControlKind {
    RandomSelection, // parents, survivors and migrants are drawn at random
    MutationOff,     // no gene gets a new value: selection among the genes of the first generation only
    HarmlessPoison,  // poison does not reduce health
    ShuffledFitness, // as much selection pressure, by the fitness of another organism
};
constexpr ControlKind all_controls[] = {ControlKind::RandomSelection, ControlKind::MutationOff,
                                        ControlKind::HarmlessPoison, ControlKind::ShuffledFitness};

struct Control {
    ControlKind kind;
    std::string name; // "random_selection"
    parameters::Parameters parameters;
    std::string cannot_differ; // why the control equals the world; empty: it can differ
};

/// world  valid.
Control control_of(const parameters::Parameters& world, ControlKind kind);

/// The schedule of the control: that of the world without the parameters that the control sets for all generations.
parameters::Schedule schedule_of(parameters::Schedule world, ControlKind kind);
/// Whether the schedule changes a parameter that decides whether the control can differ from the world.
bool schedule_affects(const parameters::Schedule& world, ControlKind kind);

/// The world with a generation_limit as its only termination criterion. Any other criterion would end the compared
/// worlds after different numbers of generations. An extinct population breeds by the fitness it reached, as always.
parameters::Parameters of_fixed_length(parameters::Parameters world, std::uint32_t generations);

/// The schedule without the termination criteria.
parameters::Schedule of_fixed_length(parameters::Schedule world);

/// "selection=random elite_count=0": the parameters that differ, with the values of `other`; empty if none does.
std::string changes_between(const parameters::Parameters& world, const parameters::Parameters& other);

} // namespace evod::experiments
