// Commands: all that can change a laboratory from outside. Applied at a tick boundary by Laboratory::apply.
//
// A world is named by the caller; the edge has already turned an empty name into a real one.
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

/// A run's name for ever: random, drawn by the shell for every create and reset; no part of the state.
struct RunId {
    std::uint64_t high = 0, low = 0;
    friend bool operator==(const RunId&, const RunId&) = default;
};

/// 32 lower-case hexadecimal digits.
std::string to_text(const RunId& id);
/// The same 16 bytes, the most significant first.
std::string to_bytes(const RunId& id);

/// Simulated seconds per second, 0.001 to 10,000; nullopt is as fast as the machine can.
using Speed = std::optional<double>;
constexpr double speed_min = 0.001, speed_max = 10'000;

struct CreateWorld {
    std::string name; // 1 to 64 of a-z A-Z 0-9 _ -
    parameters::Parameters parameters;
    base::Seed seed;
    RunId run_id;
    FirstPopulation first_population = {}; // that a world with these parameters can have
    parameters::Schedule schedule = {};    // in which faults_of() finds nothing; begins with the parameters
};
struct DeleteWorld {
    std::string world;
};
struct ResetWorld {
    std::string world;
    std::optional<base::Seed> seed; // nullopt: the same again
    RunId run_id;
};
struct Run {
    std::string world;
    std::optional<std::uint64_t> generations; // >= 1; nullopt: until paused or a termination criterion holds
};
struct RunUntilTick {
    std::string world;
    std::uint64_t tick;
};
struct ReleaseLease {
    std::string world;
    std::optional<std::uint64_t> lease = {}; // only if this one still holds
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
    std::optional<parameters::PlannedMoment> at = std::nullopt; // nothing: at once
    std::string by = {};                                        // who plans it, as others are told
};
/// Takes back what was planned.
struct CancelChange {
    std::string world;
    std::uint64_t id;
};

struct ForkWorld {
    std::string world; // the origin
    std::string name;  // of the new world; as CreateWorld
    // From its first moment; nullopt: from where the origin is. One that is over is not known any more to a laboratory,
    // only to a run file.
    std::optional<std::uint64_t> at_generation;
    RunId run_id;
};

using Command = std::variant<CreateWorld, DeleteWorld, ResetWorld, Run, RunUntilTick, ReleaseLease, Pause, Resume,
                             SetSpeed, SetParameters, CancelChange, ForkWorld>;

} // namespace evod::simulation
