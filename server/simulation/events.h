// Events: what a laboratory tells when it happens. Collected by Laboratory, taken by the runtime after every step.
#pragma once

#include "server/evolution/termination.h"
#include "server/simulation/commands.h"
#include "server/simulation/statistics.h"

#include <string>
#include <variant>
#include <vector>

namespace evod::simulation {

struct GenerationFinished {
    std::vector<GenerationStatistics> statistics; // one per island
};
struct MigrationHappened {
    struct Edge {
        std::uint32_t from, to, migrant_count;
    };
    std::uint64_t generation; // that has ended, whose organisms went
    std::vector<Edge> edges;
};
/// Everyone on an island is dead before the generation's time is up.
struct Extinction {
    std::uint32_t island;
    std::uint64_t generation;
};
struct RunTerminated {
    evolution::Outcome outcome;
};
/// What was planned for a moment was done.
struct ParametersChanged {
    std::uint64_t planned = 0;      // PlannedChange::id; 0: the schedule of the experiment
    std::string by;                 // who planned it; empty for the schedule
    std::vector<std::string> names; // of those that were assigned
    std::uint64_t revision;
};
/// What was planned for a moment does not go together with what holds there, and was left out.
struct ChangeDropped {
    std::uint64_t planned = 0;
    std::string by;                 // as above
    std::vector<std::string> names; // of those that were to be assigned
    std::vector<base::Violation> violations;
};
struct GoalReached {}; // told generations or ticks are over: the world waits, or is paused

using EventKind = std::variant<GenerationFinished, MigrationHappened, Extinction, RunTerminated, ParametersChanged,
                               ChangeDropped, GoalReached>;

struct Event {
    std::string world;
    RunId run_id;
    std::uint64_t tick; // ticks since the run began
    EventKind kind;
};

} // namespace evod::simulation
