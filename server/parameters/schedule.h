// Schedules: values of parameters for given generations, as experiment files list them.
//
// A value holds from the first tick of its generation. A breeding parameter set for generation N therefore first
// affects the breeding of generation N + 1. The population size and the contents of the islands already apply to
// generation N.
//
// Determinism  World applies the changes; they depend only on its schedule, its parameters and its moment.
#pragma once

#include "server/base/actor.h"
#include "server/base/result.h"
#include "server/parameters/model_parameters.h"

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace evod::parameters {

/// The scheduled values of parameters, generation by generation.
class Schedule {
  public:
    /// The maximum number of values after generation 1, over all parameters.
    static constexpr std::size_t values_max = 4096;

    bool empty() const { return changes_.empty(); }
    /// Returns the values of a generation, in the order of the registry. Generation 1 has a value of every scheduled
    /// parameter.
    std::span<const Assignment> at(std::uint64_t generation) const;
    /// All values, by generation.
    const std::map<std::uint64_t, std::vector<Assignment>>& changes() const { return changes_; }
    bool holds(std::string_view name) const;
    /// The number of values after generation 1.
    std::size_t value_count() const;

    /// Adds a value. The assignment must be valid (fault_of()). Its parameter must allow a schedule
    /// (can_be_scheduled()) and must not have a value in that generation yet.
    void add(std::uint64_t generation, const Assignment& assignment);
    /// Removes all values of a parameter.
    void remove(std::string_view name);
    /// Sets the value of generation 1 of every scheduled parameter to its value in `parameters`, with which a run
    /// begins.
    void begin_with(const Parameters& parameters);

    friend bool operator==(const Schedule&, const Schedule&) = default;

  private:
    std::map<std::uint64_t, std::vector<Assignment>> changes_;
};

/// A future moment of a run. Exactly one of the two members is set.
struct PlannedMoment {
    std::optional<std::uint64_t> generation; // from the first tick of this generation on, like a value of a schedule
    std::optional<std::uint64_t> tick;       // directly after this tick of the run, like a command that arrives then

    friend bool operator==(const PlannedMoment&, const PlannedMoment&) = default;
};
/// A change planned for a future moment; it is applied completely or not at all. It is validated again when it is due.
struct PlannedChange {
    std::uint64_t id = 0; // 1 for the first planned change of the run
    PlannedMoment at;
    std::vector<Assignment> assignments;
    base::Actor by; // the author

    friend bool operator==(const PlannedChange&, const PlannedChange&) = default;
};
/// The maximum number of planned changes of a world.
constexpr std::size_t planned_changes_max = 100;

/// Returns whether the parameter can change while a world runs.
inline bool can_be_scheduled(const ParameterDescription& description) {
    return description.effect != base::Effect::Reset;
}

/// Returns the requested parameters after assignments that are made while a world runs. Refuses them if the result is
/// not valid, or if the parameters in effect would not be valid together: from the next tick on, while others wait for
/// the next generation, or from the next generation on, while others wait for a reset.
base::Result<RequestedParameters> request_of(const ParameterSet& set, std::span<const Assignment> assignments,
                                             std::string_view field_prefix = "");
/// Like request_of(), for assignments that are made at the beginning of a generation. That generation is bred with the
/// old values of breeding parameters, but has the new population size.
base::Result<RequestedParameters> request_at_generation(const ParameterSet& set,
                                                        std::span<const Assignment> assignments,
                                                        std::string_view field_prefix = "");

/// Returns the parameters for breeding the next generation: `active`, with the requested values of the parameters that
/// take effect at a generation. Parameters that take effect at a tick keep their active values while the generation is
/// bred.
Parameters breeding_with(const Parameters& active, const RequestedParameters& requested);

struct ScheduleFault {
    std::uint64_t generation;
    base::Violation violation; // names the parameter
};
/// Returns the violations that the schedule causes in a run that begins with these parameters and has no other changes.
/// Stops at the first generation that has violations, and returns all violations of that generation.
///
/// parameters  the parameters in generation 1; must be valid.
std::vector<ScheduleFault> faults_of(const Schedule& schedule, const Parameters& parameters);

} // namespace evod::parameters
