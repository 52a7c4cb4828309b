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
struct GoalReached {}; // told generations or ticks are over: the world waits, or is paused

using EventKind = std::variant<GenerationFinished, MigrationHappened, Extinction, RunTerminated, GoalReached>;

struct Event {
    std::string world;
    RunId run_id;
    std::uint64_t tick; // ticks since the run began
    EventKind kind;
};

} // namespace evod::simulation
