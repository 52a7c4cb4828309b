#include "server/protocol/parameters.h"

#include "server/protocol/experiment_summary.h"

#include "server/base/exact_number.h"
#include "server/parameters/choice_help.h"
#include "server/parameters/warnings.h"
#include "server/protocol/actors.h"
#include "server/protocol/refusals.h"

#include <cmath>
#include <set>
#include <utility>

namespace evod::protocol {
namespace {

v1::ParameterEffect to_proto(base::Effect effect) {
    switch (effect) {
    case base::Effect::NextTick:
        return v1::PARAMETER_EFFECT_NEXT_TICK;
    case base::Effect::NextGeneration:
        return v1::PARAMETER_EFFECT_NEXT_GENERATION;
    case base::Effect::Reset:
        return v1::PARAMETER_EFFECT_RESET;
    }
    return v1::PARAMETER_EFFECT_UNSPECIFIED;
}

/// A client may send the value of a count as a real number, as NumPy and JavaScript have it.
parameters::ParameterValue to_value(const std::string& name, const v1::ParameterValue& value) {
    switch (value.kind_case()) {
    case v1::ParameterValue::kReal:
        if (const auto* description = parameters::find_parameter(name);
            description != nullptr && std::holds_alternative<parameters::CountParameter>(description->kind)) {
            if (const auto count = base::whole_number_of(value.real())) {
                return *count;
            }
        }
        return value.real();
    case v1::ParameterValue::kCount:
        return value.count();
    case v1::ParameterValue::kFlag:
        return value.flag();
    case v1::ParameterValue::kChoice:
    case v1::ParameterValue::KIND_NOT_SET:
        break;
    }
    return value.choice();
}

} // namespace

v1::ParameterValue to_proto(const parameters::ParameterValue& value) {
    v1::ParameterValue to;
    if (const auto* real = std::get_if<double>(&value)) {
        to.set_real(*real);
    } else if (const auto* count = std::get_if<std::uint32_t>(&value)) {
        to.set_count(*count);
    } else if (const auto* flag = std::get_if<bool>(&value)) {
        to.set_flag(*flag);
    } else {
        to.set_choice(std::get<std::string>(value));
    }
    return to;
}

v1::ParameterDescription to_proto(const parameters::ParameterDescription& description) {
    v1::ParameterDescription to;
    to.set_name(std::string{description.name});
    to.set_unit(std::string{description.unit});
    to.set_help(std::string{description.help});
    to.set_topic(std::string{description.topic});
    to.set_is_most_used(description.is_most_used);
    to.set_effect(to_proto(description.effect));
    *to.mutable_default_value() = to_proto(description.default_value());
    if (const auto* real = std::get_if<parameters::RealParameter>(&description.kind)) {
        to.set_kind(v1::PARAMETER_KIND_REAL);
        to.set_min(real->range.min);
        to.set_max(real->range.max);
    } else if (const auto* count = std::get_if<parameters::CountParameter>(&description.kind)) {
        to.set_kind(v1::PARAMETER_KIND_COUNT);
        to.set_min(count->range.min);
        to.set_max(count->range.max);
    } else if (const auto* choice = std::get_if<parameters::ChoiceParameter>(&description.kind)) {
        to.set_kind(v1::PARAMETER_KIND_CHOICE);
        for (const std::string_view name : choice->names) {
            to.add_choices(std::string{name});
            to.add_choice_help(std::string{parameters::choice_help(description.name, name)});
        }
    } else {
        to.set_kind(v1::PARAMETER_KIND_FLAG);
    }
    return to;
}

v1::ParameterState state_of(const parameters::ParameterDescription& description, const parameters::ParameterSet& set,
                            const simulation::ClassRules* class_rules) {
    v1::ParameterState to;
    const auto active = description.get(set.active), requested = description.get(set.requested.values);
    to.set_name(std::string{description.name});
    *to.mutable_value() = to_proto(active);
    if (requested != active) {
        *to.mutable_pending() = to_proto(requested);
    }
    if (const base::Effect effect = effect_in(set.active, description); effect != description.effect) {
        to.set_effect(to_proto(effect));
    }
    if (const auto* range = class_rules != nullptr ? class_rules->range_of(description.name) : nullptr) {
        to.set_min(range->min);
        to.set_max(range->max);
    }
    return to;
}

v1::ParameterSet to_proto(const parameters::ParameterSet& set, const simulation::ClassRules* class_rules) {
    v1::ParameterSet to;
    for (const auto& description : parameters::parameter_registry()) {
        *to.add_parameters() = state_of(description, set, class_rules);
    }
    to.set_revision(set.revision);
    to.set_summary(experiment_summary(set.active));
    return to;
}

void add_warnings(v1::Response& response, const parameters::RequestedParameters& requested) {
    for (std::string& warning : parameters::warnings_of(requested.values)) {
        response.add_warnings(std::move(warning));
    }
}

google::protobuf::RepeatedPtrField<v1::ScheduledValue> to_proto(const parameters::Schedule& schedule,
                                                                std::uint64_t after_generation) {
    google::protobuf::RepeatedPtrField<v1::ScheduledValue> values;
    const auto& changes = schedule.changes();
    for (auto change = changes.upper_bound(after_generation); change != changes.end(); ++change) {
        for (const parameters::Assignment& assignment : change->second) {
            v1::ScheduledValue& to = *values.Add();
            to.set_name(assignment.name);
            to.set_generation(change->first);
            *to.mutable_value() = to_proto(assignment.value);
        }
    }
    return values;
}

v1::PlannedChange to_proto(const parameters::PlannedChange& change) {
    v1::PlannedChange to;
    to.set_id(change.id);
    if (change.at.generation) {
        to.set_generation(*change.at.generation);
    } else {
        to.set_tick(*change.at.tick);
    }
    for (const parameters::Assignment& assignment : change.assignments) {
        v1::ParameterAssignment& assigned = *to.add_parameters();
        assigned.set_name(assignment.name);
        *assigned.mutable_value() = to_proto(assignment.value);
    }
    *to.mutable_by() = to_proto(change.by);
    return to;
}

v1::AppliedChange to_proto(const simulation::Change& change) {
    v1::AppliedChange to;
    to.set_generation(change.generation);
    *to.mutable_by() = to_proto(change.by);
    for (const simulation::ChangedValue& value : change.values) {
        v1::ChangedValue& changed = *to.add_values();
        changed.set_name(value.name);
        *changed.mutable_before() = to_proto(value.before);
        *changed.mutable_after() = to_proto(value.after);
    }
    return to;
}

std::vector<parameters::Assignment>
to_assignments(const google::protobuf::RepeatedPtrField<v1::ParameterAssignment>& assignments,
               std::string_view field_prefix, std::vector<base::Violation>& violations) {
    std::vector<parameters::Assignment> converted;
    converted.reserve(static_cast<std::size_t>(assignments.size()));
    bool complete = true;
    for (const v1::ParameterAssignment& assignment : assignments) {
        if (assignment.value().kind_case() == v1::ParameterValue::KIND_NOT_SET) {
            const auto* description = parameters::find_parameter(assignment.name());
            violations.push_back({std::string{field_prefix} + assignment.name(),
                                  description ? description->allowed() : "the name of a parameter and a value",
                                  "no value"});
            complete = false;
        } else {
            converted.push_back({assignment.name(), to_value(assignment.name(), assignment.value())});
        }
    }
    if (!complete) {
        // The request will be refused. The other assignments are checked, too, so that the refusal lists all errors
        // that do not depend on the state of the world.
        for (const parameters::Assignment& assignment : converted) {
            if (auto fault = parameters::fault_of(assignment, field_prefix)) {
                violations.push_back(*std::move(fault));
            }
        }
    }
    return converted;
}

parameters::Schedule to_schedule(const google::protobuf::RepeatedPtrField<v1::ScheduledValue>& values,
                                 const parameters::Parameters& parameters, std::string_view field_prefix,
                                 std::vector<base::Violation>& violations) {
    parameters::Schedule schedule;
    constexpr std::size_t most = parameters::Schedule::values_max;
    if (static_cast<std::size_t>(values.size()) > most) {
        violations.push_back({std::string{field_prefix} + "schedule", "at most " + std::to_string(most) + " values",
                              std::to_string(values.size())});
        return schedule;
    }
    const auto field = [&](const std::string& name, std::uint64_t generation) {
        return std::string{field_prefix} + name + " at generation " + std::to_string(generation);
    };
    const auto fault_of = [&](const v1::ScheduledValue& value) -> std::optional<base::Violation> {
        const auto* description = parameters::find_parameter(value.name());
        if (description == nullptr) {
            return parameters::fault_of({value.name(), parameters::ParameterValue{0u}});
        }
        if (!can_be_scheduled(*description)) {
            return base::Violation{
                {}, "without scheduled values, because it changes only at a reset", "a scheduled value"};
        }
        if (value.generation() < 2) {
            return base::Violation{{}, "a generation from 2", std::to_string(value.generation())};
        }
        if (value.value().kind_case() == v1::ParameterValue::KIND_NOT_SET) {
            return base::Violation{{}, description->allowed(), "no value"};
        }
        return parameters::fault_of({value.name(), to_value(value.name(), value.value())});
    };
    std::set<std::pair<std::uint64_t, std::string_view>> seen;
    const std::size_t before = violations.size();
    for (const v1::ScheduledValue& value : values) {
        auto fault = fault_of(value);
        if (!fault && !seen.emplace(value.generation(), value.name()).second) {
            fault = base::Violation{{}, "given once", "given twice"};
        }
        if (fault) {
            fault->field = field(value.name(), value.generation());
            violations.push_back(*std::move(fault));
        } else {
            schedule.add(value.generation(), {value.name(), to_value(value.name(), value.value())});
        }
    }
    if (violations.size() > before) {
        return schedule;
    }
    schedule.begin_with(parameters);
    for (parameters::ScheduleFault& wrong : faults_of(schedule, parameters)) {
        wrong.violation.field = field(wrong.violation.field, wrong.generation);
        violations.push_back(std::move(wrong.violation));
    }
    return schedule;
}

} // namespace evod::protocol
