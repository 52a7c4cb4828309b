// Events: what happened in a laboratory. The Laboratory collects events until a caller takes them with take_events().
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
/// The last tick of a generation has passed, and the world waits until clients have rated its organisms.
struct FitnessAwaited {
    std::uint64_t generation;
};
struct MigrationHappened {
    struct Edge {
        std::uint32_t from, to, migrant_count;
    };
    std::uint64_t generation; // the ended generation, whose organisms are replaced
    std::vector<Edge> edges;
};
/// The last living organism of an island has died.
struct Extinction {
    std::uint32_t island;
    std::uint64_t generation;
    std::uint64_t tick; // ticks since the run began
};
struct RunTerminated {
    evolution::Outcome outcome;
};
/// A planned or scheduled change was applied.
struct ParametersChanged {
    std::uint64_t planned = 0;      // PlannedChange::id; 0: the schedule of the experiment
    base::Actor by;                 // author of the plan, or the schedule
    std::vector<std::string> names; // names of the assigned parameters
    std::uint64_t revision;
};
/// A planned or scheduled change was dropped, because it is not valid together with the parameters in effect at its
/// moment.
struct ChangeDropped {
    std::uint64_t planned = 0;
    base::Actor by;                 // as in ParametersChanged
    std::vector<std::string> names; // names of the parameters that the change would have set
    std::vector<base::Violation> violations;
};
struct GoalReached {}; // the requested generations or ticks have been simulated: the world now waits or is paused

using EventKind = std::variant<GenerationFinished, FitnessAwaited, MigrationHappened, Extinction, RunTerminated,
                               ParametersChanged, ChangeDropped, GoalReached>;

struct Event {
    std::string world;
    RunId run_id;
    std::uint64_t tick; // ticks since the run began
    EventKind kind;
};

} // namespace evod::simulation
