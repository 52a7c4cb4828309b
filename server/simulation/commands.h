// Commands: everything that can change a laboratory from outside. Laboratory::apply applies them between two ticks.
//
// Each command names its world. The protocol layer has already replaced an empty name by the name of a world.
#pragma once

#include "server/base/random.h"
#include "server/parameters/parameters.h"
#include "server/parameters/schedule.h"
#include "server/simulation/first_population.h"

#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace evod::simulation {

/// The permanent identity of a run: a random number, drawn outside the core whenever a world is created, forked or
/// reset. Not part of the state.
struct RunId {
    std::uint64_t high = 0, low = 0;
    friend bool operator==(const RunId&, const RunId&) = default;
};

/// 32 lower-case hexadecimal digits.
std::string to_text(const RunId& id);
/// The id as 16 bytes, most significant first.
std::string to_bytes(const RunId& id);

/// Simulated seconds per second, 0.001 to 10,000; nullopt: as fast as possible.
using Speed = std::optional<double>;
constexpr double speed_min = 0.001, speed_max = 10'000;

struct CreateWorld {
    std::string name; // 1 to 64 of a-z A-Z 0-9 _ -
    parameters::Parameters parameters;
    base::Seed seed;
    RunId run_id;
    FirstPopulation first_population = {}; // valid for these parameters
    parameters::Schedule schedule = {};    // valid: faults_of() returns nothing; generation 1 has the values of
                                           // `parameters`
};
struct DeleteWorld {
    std::string world;
};
struct ResetWorld {
    std::string world;
    std::optional<base::Seed> seed; // nullopt: the same seed as before
    RunId run_id;
};
struct Run {
    std::string world;
    std::optional<std::uint64_t> generations; // >= 1; nullopt: until paused or until a termination criterion holds
};
struct RunUntilTick {
    std::string world;
    std::uint64_t tick;
};
struct ReleaseLease {
    std::string world;
    std::optional<std::uint64_t> lease = {}; // RunControl::lease at the time when the lease was granted or extended;
                                             // refused if it has changed since. nullopt: release any lease
};
struct Pause {
    std::string world;
};
struct Resume {
    std::string world;
};
struct SetSpeed {
    std::string world;
    Speed speed;
};
struct SetParameters {
    std::string world;
    std::vector<parameters::Assignment> assignments;
    bool dry_run = false;
    std::optional<std::uint64_t> expected_revision;
    std::optional<parameters::PlannedMoment> at = std::nullopt; // when to apply the change; nullopt: at once
    std::string by = {};                                        // the author's name as other clients see it
};
/// Cancels a planned change.
struct CancelChange {
    std::string world;
    std::uint64_t id;
};

struct ForkWorld {
    std::string world; // the world to fork
    std::string name;  // name of the new world; as in CreateWorld
    // The new world starts at the first moment of this generation of the original; nullopt: from its present state.
    // Earlier generations exist only in a run file.
    std::optional<std::uint64_t> at_generation;
    RunId run_id;
};

using Command = std::variant<CreateWorld, DeleteWorld, ResetWorld, Run, RunUntilTick, ReleaseLease, Pause, Resume,
                             SetSpeed, SetParameters, CancelChange, ForkWorld>;

} // namespace evod::simulation
