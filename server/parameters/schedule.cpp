#include "server/parameters/schedule.h"

#include <algorithm>
#include <set>

namespace evod::parameters {

std::span<const Assignment> Schedule::at(std::uint64_t generation) const {
    const auto found = changes_.find(generation);
    return found == changes_.end() ? std::span<const Assignment>{} : found->second;
}

bool Schedule::holds(std::string_view name) const {
    return std::ranges::any_of(changes_, [&](const auto& change) {
        return std::ranges::find(change.second, name, &Assignment::name) != change.second.end();
    });
}

std::size_t Schedule::value_count() const {
    std::size_t count = 0;
    for (const auto& [generation, assignments] : changes_) {
        count += generation > 1 ? assignments.size() : 0;
    }
    return count;
}

void Schedule::add(std::uint64_t generation, const Assignment& assignment) {
    const ParameterDescription* description = find_parameter(assignment.name);
    Assignment added = assignment;
    if (const auto* whole = std::get_if<std::uint32_t>(&assignment.value);
        whole != nullptr && std::holds_alternative<RealParameter>(description->kind)) {
        added.value = static_cast<double>(*whole);
    }
    auto& there = changes_[generation];
    // Both pointers point into the registry, which is an array, so comparing them sorts assignments in the order of the
    // registry.
    const auto place =
        std::ranges::find_if(there, [&](const Assignment& other) { return find_parameter(other.name) > description; });
    there.insert(place, std::move(added));
}

void Schedule::remove(std::string_view name) {
    for (auto change = changes_.begin(); change != changes_.end();) {
        std::erase_if(change->second, [&](const Assignment& assignment) { return assignment.name == name; });
        change = change->second.empty() ? changes_.erase(change) : std::next(change);
    }
}

void Schedule::begin_with(const Parameters& parameters) {
    std::set<std::string> names;
    for (const auto& [generation, assignments] : changes_) {
        for (const Assignment& assignment : assignments) {
            names.insert(assignment.name);
        }
    }
    changes_.erase(1);
    for (const std::string& name : names) {
        add(1, {name, find_parameter(name)->get(parameters)});
    }
}

Parameters breeding_with(const Parameters& active, const RequestedParameters& requested) {
    Parameters result = active;
    for (const ParameterDescription& description : parameter_registry()) {
        if (effect_in(active, description) == base::Effect::NextGeneration) {
            description.copy(requested.values, result);
        }
    }
    return result;
}

namespace {

base::Refusal refused(std::vector<base::Violation> violations) {
    return {.code = base::RefusalCode::InvalidArgument,
            .message = "invalid parameter values: they do not fit together until all of them have taken effect",
            .violations = std::move(violations)};
}

/// The world may never be reset, so the values must be valid while the parameters that wait for a reset keep their old
/// values.
std::vector<base::Violation> violations_from_next_generation(const ParameterSet& set,
                                                             const RequestedParameters& requested,
                                                             std::string_view field_prefix) {
    return validate(taking_effect(set.active, requested, base::Effect::NextGeneration), field_prefix);
}

} // namespace

base::Result<RequestedParameters> request_of(const ParameterSet& set, std::span<const Assignment> assignments,
                                             std::string_view field_prefix) {
    const base::Result<RequestedParameters> requested = assign(set.requested, assignments, field_prefix);
    if (!requested) {
        return requested;
    }
    if (auto violations = validate(taking_effect(set.active, *requested, base::Effect::NextTick), field_prefix);
        !violations.empty()) {
        return refused(std::move(violations));
    }
    if (auto violations = violations_from_next_generation(set, *requested, field_prefix); !violations.empty()) {
        return refused(std::move(violations));
    }
    return requested;
}

base::Result<RequestedParameters>
request_at_generation(const ParameterSet& set, std::span<const Assignment> assignments, std::string_view field_prefix) {
    const base::Result<RequestedParameters> requested = assign(set.requested, assignments, field_prefix);
    if (!requested) {
        return requested;
    }
    if (auto violations = violations_from_next_generation(set, *requested, field_prefix); !violations.empty()) {
        return refused(std::move(violations));
    }
    if (auto violations = validate(breeding_with(set.active, *requested), field_prefix); !violations.empty()) {
        for (base::Violation& violation : violations) {
            violation.allowed += ", because the generation is bred with the previous values of breeding parameters";
        }
        return refused(std::move(violations));
    }
    return requested;
}

std::vector<ScheduleFault> faults_of(const Schedule& schedule, const Parameters& parameters) {
    auto set = ParameterSet::all_in_effect(parameters);
    std::vector<ScheduleFault> faults;
    for (const auto& [generation, assignments] : schedule.changes()) {
        for (const Assignment& assignment : assignments) {
            if (generation > 1 && effect_in(parameters, *find_parameter(assignment.name)) == base::Effect::Reset) {
                faults.push_back({generation,
                                  {assignment.name, "one value: with births, it can change only at a reset",
                                   to_text(assignment.value)}});
            }
        }
        if (!faults.empty()) {
            return faults;
        }
        const auto requested = request_at_generation(set, assignments);
        if (!requested) {
            for (const base::Violation& violation : requested.error().violations) {
                faults.push_back({generation, violation});
            }
            return faults;
        }
        set = ParameterSet::all_in_effect(requested->values);
    }
    return faults;
}

} // namespace evod::parameters
