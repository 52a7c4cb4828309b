// Controls: the worlds that an experiment is to be seen beside, to tell whether evolution did what it came to.
//
// Each is a plain set of parameters, so that a control can be run, recorded, replayed and verified like any world.
#pragma once

#include "server/parameters/parameters.h"
#include "server/parameters/schedule.h"

#include <string>
#include <vector>

namespace evod::experiments {

enum class ControlKind {
    RandomSelection, // whoever breeds, stays and migrates is drawn by chance
    MutationOff,     // no gene gets a new value: what the selection makes of the first generation alone
    HarmlessPoison,  // poison takes no health
    ShuffledFitness, // selection as strong as it was, by another organism's fitness
};
constexpr ControlKind all_controls[] = {ControlKind::RandomSelection, ControlKind::MutationOff,
                                        ControlKind::HarmlessPoison, ControlKind::ShuffledFitness};

struct Control {
    ControlKind kind;
    std::string name; // "random_selection"
    parameters::Parameters parameters;
    std::string cannot_differ; // why the world is this control already; empty: it is not
};

/// world  valid.
Control control_of(const parameters::Parameters& world, ControlKind kind);

/// What is scheduled for the world, but for the parameters that make the control, which it has all along.
parameters::Schedule schedule_of(parameters::Schedule world, ControlKind kind);
/// Whether what is scheduled has a say in whether the control can differ from the world.
bool matters(const parameters::Schedule& world, ControlKind kind);

/// The world with no end but that of `generations`: an end that depends on what happens would give the worlds that are
/// compared different lengths. Who has died out breeds by the fitness it came to, as always.
parameters::Parameters of_fixed_length(parameters::Parameters world, std::uint32_t generations);

/// The same of what is scheduled for it.
parameters::Schedule of_fixed_length(parameters::Schedule world);

/// "selection=random elite_count=0": what is to be set to make `other` of `world`; empty if they are the same.
std::string changes_between(const parameters::Parameters& world, const parameters::Parameters& other);

} // namespace evod::experiments
