#include "server/protocol/parameters.h"

#include "server/protocol/refusals.h"

#include <cmath>

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

simulation::ParameterValue to_value(const v1::ParameterValue& value) {
    switch (value.value_case()) {
    case v1::ParameterValue::kReal:
        return value.real();
    case v1::ParameterValue::kCount:
        return value.count();
    case v1::ParameterValue::kFlag:
        return value.flag();
    case v1::ParameterValue::kChoice:
    case v1::ParameterValue::VALUE_NOT_SET:
        break;
    }
    return value.choice();
}

} // namespace

v1::ParameterValue to_proto(const simulation::ParameterValue& value) {
    v1::ParameterValue to;
    if (const auto* real = std::get_if<double>(&value))
        to.set_real(*real);
    else if (const auto* count = std::get_if<std::uint32_t>(&value))
        to.set_count(*count);
    else if (const auto* flag = std::get_if<bool>(&value))
        to.set_flag(*flag);
    else
        to.set_choice(std::get<std::string>(value));
    return to;
}

v1::ParameterDescription to_proto(const simulation::ParameterDescription& description) {
    v1::ParameterDescription to;
    to.set_name(std::string{description.name});
    to.set_unit(std::string{description.unit});
    to.set_help(std::string{description.help});
    to.set_effect(to_proto(description.effect));
    *to.mutable_default_value() = to_proto(description.default_value());
    if (const auto* real = std::get_if<simulation::RealParameter>(&description.kind)) {
        to.set_kind(v1::PARAMETER_KIND_REAL);
        to.set_min(real->range.min);
        to.set_max(real->range.max);
    } else if (const auto* count = std::get_if<simulation::CountParameter>(&description.kind)) {
        to.set_kind(v1::PARAMETER_KIND_COUNT);
        to.set_min(count->range.min);
        to.set_max(count->range.max);
    } else if (const auto* choice = std::get_if<simulation::ChoiceParameter>(&description.kind)) {
        to.set_kind(v1::PARAMETER_KIND_CHOICE);
        for (const std::string_view name : choice->names)
            to.add_choices(std::string{name});
    } else {
        to.set_kind(v1::PARAMETER_KIND_FLAG);
    }
    return to;
}

v1::ParameterState state_of(const simulation::ParameterDescription& description, const simulation::ParameterSet& set) {
    v1::ParameterState to;
    const auto active = description.get(set.active), requested = description.get(set.requested);
    to.set_name(std::string{description.name});
    *to.mutable_value() = to_proto(active);
    if (requested != active)
        *to.mutable_pending() = to_proto(requested);
    return to;
}

v1::ParameterSet to_proto(const simulation::ParameterSet& set) {
    v1::ParameterSet to;
    for (const auto& description : simulation::parameter_registry())
        *to.add_parameters() = state_of(description, set);
    to.set_revision(set.revision);
    return to;
}

std::vector<simulation::Assignment>
to_assignments(const google::protobuf::RepeatedPtrField<v1::ParameterAssignment>& assignments,
               std::string_view field_prefix, std::vector<base::Violation>& violations) {
    std::vector<simulation::Assignment> made;
    made.reserve(static_cast<std::size_t>(assignments.size()));
    bool complete = true;
    for (const v1::ParameterAssignment& assignment : assignments) {
        if (assignment.value().value_case() == v1::ParameterValue::VALUE_NOT_SET) {
            const auto* description = simulation::find_parameter(assignment.name());
            violations.push_back({std::string{field_prefix} + assignment.name(),
                                  description ? description->allowed() : "the name of a parameter, and a value",
                                  "no value"});
            complete = false;
        } else {
            made.push_back({assignment.name(), to_value(assignment.value())});
        }
    }
    if (!complete) {
        // The request is refused whatever the world says, so the rest is judged on its own.
        for (const simulation::Assignment& assignment : made)
            if (auto fault = simulation::fault_of(assignment, field_prefix))
                violations.push_back(*std::move(fault));
    }
    return made;
}

} // namespace evod::protocol
