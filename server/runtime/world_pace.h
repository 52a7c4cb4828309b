// World pace: when the next tick of a world is due, and how fast the world really is.
//
// A world with the speed factor f simulates a tick every tick_s / f. A late world catches up by at most `catch_up_max`;
// beyond that it runs slower.
//
// Owner        a simulation loop, one per world.
// Determinism  the clock decides how many ticks are simulated. It does not influence what happens in them.
#pragma once

#include "server/runtime/clock.h"
#include "server/simulation/laboratory.h"

#include <cstdint>

namespace evod::runtime {

class WorldPace {
  public:
    static constexpr std::chrono::milliseconds catch_up_max{50};
    /// A paced world counts as slowed if it falls behind its speed by more than this fraction of the elapsed time.
    static constexpr double slowed_from = 0.02;

    /// The time at which the next tick of a paced world is due.
    Clock::time_point due() const { return due_; }
    /// The time that one of the last ticks took.
    Clock::duration tick_time() const { return tick_time_; }

    /// Must be called when a command may have changed the world, its run or its speed.
    ///
    /// runs     whether the world wants ticks and may have them.
    /// returns  whether the world has stopped.
    bool follow(simulation::Entry& entry, bool runs, Clock::time_point now);
    /// Must be called after `ticks` >= 1 ticks.
    ///
    /// spent  the time they took, with the work after them.
    void advanced(const simulation::Entry& entry, std::uint64_t ticks, Clock::duration spent, Clock::time_point now);
    /// Must be called when the world has reached a goal.
    void stop(simulation::Entry& entry);
    /// Sets ticks_per_s and `slowed` if they were last measured long enough ago. Returns whether `slowed` has changed.
    bool measure(simulation::Entry& entry, Clock::time_point now);

  private:
    simulation::RunId run_id_;
    simulation::Speed speed_;
    double tick_s_ = 0;
    bool runs_ = false;
    Clock::time_point due_;
    Clock::duration tick_time_ = std::chrono::milliseconds{5};
    // Measurements since the time `measured_since_`.
    Clock::time_point measured_since_;
    std::uint64_t ticks_ = 0;
    Clock::duration lost_{}; // time by which the world fell behind its speed
};

} // namespace evod::runtime
