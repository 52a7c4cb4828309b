// Schedules: parameters that change by generation, as experiment files plan them.
//
// A value holds from the first tick of its generation. What breeding goes by therefore acts first in the breeding that
// makes the generation after it; how many are born, and what there is on their islands, is so in the generation itself.
//
// Determinism  World makes the changes, from its schedule, its parameters and its moment alone.
#pragma once

#include "server/base/result.h"
#include "server/parameters/parameters.h"

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace evod::parameters {

/// What is planned, generation by generation.
class Schedule {
  public:
    /// Values after generation 1, of all parameters together.
    static constexpr std::size_t values_max = 4096;

    bool empty() const { return changes_.empty(); }
    /// Of a generation, in the order of the registry; of generation 1: all that is scheduled, as runs begin with it.
    std::span<const Assignment> at(std::uint64_t generation) const;
    /// Generation by generation.
    const std::map<std::uint64_t, std::vector<Assignment>>& changes() const { return changes_; }
    bool holds(std::string_view name) const;
    /// How many there are after generation 1.
    std::size_t value_count() const;

    /// assignment  that fault_of() finds nothing wrong with, of a parameter that can_be_scheduled(); the first of its
    ///             name in that generation.
    void add(std::uint64_t generation, const Assignment& assignment);
    /// What is planned for a parameter is so no more.
    void remove(std::string_view name);
    /// The values of generation 1, of all that is scheduled, from what a run begins with.
    void begin_with(const Parameters& parameters);

    friend bool operator==(const Schedule&, const Schedule&) = default;

  private:
    std::map<std::uint64_t, std::vector<Assignment>> changes_;
};

/// A moment of a run that is to come: one of the two.
struct PlannedMoment {
    std::optional<std::uint64_t> generation; // its first tick, as in a schedule
    std::optional<std::uint64_t> tick;       // right after it, since the run began: as a command that comes there

    friend bool operator==(const PlannedMoment&, const PlannedMoment&) = default;
};
/// What somebody wants to change then, all of it or nothing. It is looked at anew when it is due.
struct PlannedChange {
    std::uint64_t id = 0; // 1 for the first that was planned in the run
    PlannedMoment at;
    std::vector<Assignment> assignments;
    std::string by; // as others are told

    friend bool operator==(const PlannedChange&, const PlannedChange&) = default;
};
/// That wait in a world.
constexpr std::size_t planned_changes_max = 100;

/// Whether it can change while a world runs.
inline bool can_be_scheduled(const ParameterDescription& description) {
    return description.effect != base::Effect::Reset;
}

/// What is asked for all in all once the assignments are made while a world runs; refused if that cannot be, or what
/// does not wait for a reset cannot be without the rest.
base::Result<Parameters> request_of(const ParameterSet& set, std::span<const Assignment> assignments,
                                    std::string_view field_prefix = "");
/// The same for a change that comes as a generation begins: this one is bred by what holds before, and so many as hold
/// after it.
base::Result<Parameters> request_at_generation(const ParameterSet& set, std::span<const Assignment> assignments,
                                               std::string_view field_prefix = "");

/// `active` with what holds from the first tick of a generation that is bred now: breeding still goes by the rest.
Parameters breeding_with(const Parameters& active, const Parameters& requested);

struct ScheduleFault {
    std::uint64_t generation;
    base::Violation violation; // of a parameter, by its name
};
/// What cannot hold in a run that begins with these parameters if nobody else changes any, of the first generation in
/// which something cannot.
///
/// parameters  valid.
std::vector<ScheduleFault> faults_of(const Schedule& schedule, const Parameters& parameters);

} // namespace evod::parameters
