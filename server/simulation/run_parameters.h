// Run parameters: the parameters of a world over the course of its run: those that are active and requested, the
// schedule, the planned changes, and the changes so far.
//
// Owner        World.
// Determinism  the sets depend only on the schedule, the requests and the moments at which the world applies them.
#pragma once

#include "server/base/result.h"
#include "server/parameters/model_parameters.h"
#include "server/parameters/schedule.h"
#include "server/simulation/changes.h"
#include "server/simulation/events.h"
#include "server/simulation/world_state.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace evod::simulation {

/// Whether a planned moment comes after `now`.
bool is_after(const parameters::PlannedMoment& planned, const Moment& now);

class RunParameters {
  public:
    /// schedule  of the run.
    RunParameters(const parameters::ParameterSet& set, parameters::Schedule schedule)
        : set_{set}, schedule_{std::move(schedule)} {}

    const parameters::ParameterSet& set() const { return set_; }
    const parameters::Parameters& active() const { return set_.active; }
    const parameters::Schedule& schedule() const { return schedule_; }
    const std::vector<parameters::PlannedChange>& planned() const { return planned_; }
    const Changes& changes() const { return changes_; }

    /// Replaces the set by that of a stored state.
    void restore(const parameters::ParameterSet& set) { set_ = set; }
    void set_past_changes(Changes changes) { changes_ = std::move(changes); }
    /// Drops the planned changes and the changes so far.
    void become_fork();

    /// Sets the requested parameters.
    ///
    /// generation  in which the change is counted.
    void request(const parameters::RequestedParameters& requested, std::uint64_t generation, const base::Actor& by);
    /// Makes the requested values active that take effect at a tick.
    void begin_tick() { set_.active = parameters::taking_effect(set_.active, set_.requested, base::Effect::NextTick); }
    /// Returns the parameters that will be active in the tick after `now`.
    parameters::Parameters active_in_next_tick(const Moment& now) const;

    /// Adds a planned change under a new id and returns the id.
    std::uint64_t plan(parameters::PlannedChange change);
    /// Removes a planned change and returns it; nullopt if there is none with that id.
    std::optional<parameters::PlannedChange> cancel(std::uint64_t id);
    /// Removes the planned changes whose moment is not after `now`.
    void drop_due(const Moment& now);
    /// Returns `tick`, or the tick of an earlier planned change.
    std::uint64_t next_stop(std::uint64_t tick) const;

    /// Applies the values of the schedule and the changes planned for the generation that is about to be bred, and
    /// makes the requested values active that take effect at a generation. Adds what happened to `events`.
    void begin_breeding(std::uint64_t generation, std::vector<EventKind>& events);
    /// Applies the changes planned for the tick that has just ended.
    ///
    /// generation  in which the changes are counted.
    void end_tick(std::uint64_t tick, std::uint64_t generation, std::vector<EventKind>& events) {
        if (!planned_.empty()) {
            apply_due(tick, generation, events);
        }
    }

  private:
    void apply_due(std::uint64_t tick, std::uint64_t generation, std::vector<EventKind>& events);
    /// Requests the parameters in `requested`, which contain the assignments of `change`. If `requested` is a refusal,
    /// drops the change and reports why.
    void apply(const parameters::PlannedChange& change, const base::Result<parameters::RequestedParameters>& requested,
               std::uint64_t generation, std::vector<EventKind>& events);

    parameters::ParameterSet set_;
    parameters::Schedule schedule_;
    std::vector<parameters::PlannedChange> planned_; // sorted by id
    std::uint64_t planned_count_ = 0;                // number of changes planned in this run so far
    Changes changes_;
};

} // namespace evod::simulation
