#include "client/ctl/pace.h"

#include "client/ctl/text.h"

#include <algorithm>

namespace evod::ctl {

double simulated_s_left(const v1::WorldInfo& world, const Durations& durations, std::uint64_t generations) {
    const double elapsed_s = static_cast<double>(world.generation_tick()) * durations.tick_s;
    // A world that waits at the end of a generation has nothing left of it.
    const bool is_over = elapsed_s >= durations.generation_s - durations.tick_s / 2;
    return std::max(0.0, static_cast<double>(generations) * durations.generation_s - (is_over ? 0 : elapsed_s));
}

std::optional<double> real_s(const v1::WorldInfo& world, const Durations& durations, double simulated_s) {
    if (world.ticks_per_s() > 0) {
        return simulated_s / (world.ticks_per_s() * durations.tick_s);
    }
    if (world.speed().real_time_factor() > 0) {
        return simulated_s / world.speed().real_time_factor();
    }
    return std::nullopt;
}

std::string plan_text(const v1::WorldInfo& world, const Durations& durations,
                      std::optional<std::uint64_t> generations) {
    const bool has_speed = world.speed().has_real_time_factor();
    std::string text = has_speed ? "at " + speed_text(world.speed().real_time_factor()) + ", a generation of " +
                                       duration(durations.generation_s) + " takes " +
                                       duration(durations.generation_s / world.speed().real_time_factor())
                                 : "at max, a generation of " + duration(durations.generation_s) +
                                       " takes as long as the server needs";
    if (generations) {
        const auto left_s = real_s(world, durations, simulated_s_left(world, durations, *generations));
        text += left_s ? ": " + std::to_string(*generations) +
                             (*generations == 1 ? " generation takes about " : " generations take about ") +
                             duration(*left_s)
                       : "";
    }
    return text + (has_speed && world.speed().real_time_factor() <= 10 ? "; evoctl speed max is faster" : "");
}

std::string progress_text(double share, std::optional<double> left_s) {
    constexpr std::size_t width = 20;
    share = std::clamp(share, 0.0, 1.0);
    return "[" + bar(share, width) + "] " + fixed(100 * share, 0) + " %" +
           (left_s ? ", " + duration(*left_s) + " left" : "");
}

} // namespace evod::ctl
