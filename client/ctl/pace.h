// Pace: how long a world needs, in sentences for a person who waits for it.
#pragma once

#include "evod/v1/world.pb.h"

#include <cstdint>
#include <optional>
#include <string>

namespace evod::ctl {

/// Durations that the parameters of a world determine.
struct Durations {
    double generation_s; // simulated seconds of a generation
    double tick_s;       // simulated seconds of a tick
};

/// The simulated seconds until a world that runs `generations` more has run them, at most.
double simulated_s_left(const v1::WorldInfo& world, const Durations& durations, std::uint64_t generations);

/// Returns how fast a world runs, what that means, and how long it needs: "at 1×, a generation of 40.0 s takes 40.0 s:
/// 30 generations take about 20:00 min; evoctl speed max is faster".
///
/// generations  nullopt: without an end.
std::string plan_text(const v1::WorldInfo& world, const Durations& durations, std::optional<std::uint64_t> generations);

/// Real seconds that a world needs for `simulated_s` at its measured speed, or, if none was measured, at its set speed;
/// nullopt if neither is known.
std::optional<double> real_s(const v1::WorldInfo& world, const Durations& durations, double simulated_s);

/// Returns "[######    ] 60 %, 8:10 min left" with block characters. share: 0 to 1.
std::string progress_text(double share, std::optional<double> left_s);

} // namespace evod::ctl
