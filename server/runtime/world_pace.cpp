#include "server/runtime/world_pace.h"

#include <algorithm>

namespace evod::runtime {
namespace {

constexpr std::chrono::milliseconds measuring_time{1000};

Clock::duration period(const simulation::Entry& entry) {
    const std::chrono::duration<double> s{entry.world.parameters().active.tick_s / *entry.control.speed};
    return std::chrono::duration_cast<Clock::duration>(s);
}

} // namespace

bool WorldPace::follow(simulation::Entry& entry, bool runs, Clock::time_point now) {
    const double tick_s = entry.world.parameters().active.tick_s;
    const bool restarts = run_id_ != entry.run_id || speed_ != entry.control.speed || tick_s_ != tick_s;
    const bool stopped = runs_ && !runs;
    if (runs && (restarts || !runs_)) {
        // Start a new time grid for the ticks. The time before the pause, or at another speed, does not count.
        due_ = measured_since_ = now;
        ticks_ = 0;
        lost_ = {};
        entry.slowed = false;
    }
    if (!runs) {
        entry.ticks_per_s = 0;
        entry.slowed = false;
    }
    run_id_ = entry.run_id;
    speed_ = entry.control.speed;
    tick_s_ = tick_s;
    runs_ = runs;
    return stopped;
}

void WorldPace::advanced(const simulation::Entry& entry, std::uint64_t ticks, Clock::duration spent,
                         Clock::time_point now) {
    ticks_ += ticks;
    tick_time_ = spent / ticks;
    if (entry.control.speed) {
        const auto due = due_ + period(entry);
        due_ = std::max(due, now - catch_up_max);
        lost_ += due_ - due;
    }
}

void WorldPace::stop(simulation::Entry& entry) {
    runs_ = false;
    entry.ticks_per_s = 0;
}

bool WorldPace::measure(simulation::Entry& entry, Clock::time_point now) {
    const std::chrono::duration<double> passed = now - measured_since_;
    // The first measurement takes less time, because a user may be waiting for it.
    if (!runs_ || passed < (entry.ticks_per_s == 0 ? measuring_time / 4 : measuring_time)) {
        return false;
    }
    entry.ticks_per_s = static_cast<double>(ticks_) / passed.count();
    const bool slowed = std::chrono::duration<double>{lost_} > slowed_from * passed;
    const bool changed = slowed != entry.slowed;
    entry.slowed = slowed;
    ticks_ = 0;
    lost_ = {};
    measured_since_ = now;
    return changed;
}

} // namespace evod::runtime
