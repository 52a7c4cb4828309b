// Converts parameters, schedules and planned changes to messages and back.
#pragma once

#include "evod/v1/commands.pb.h"
#include "evod/v1/world.pb.h"
#include "server/base/result.h"
#include "server/parameters/model_parameters.h"
#include "server/parameters/schedule.h"
#include "server/simulation/changes.h"
#include "server/simulation/class_rules.h"

#include <google/protobuf/repeated_ptr_field.h>

#include <string_view>
#include <vector>

namespace evod::protocol {

v1::ParameterValue to_proto(const parameters::ParameterValue& value);
v1::ParameterDescription to_proto(const parameters::ParameterDescription& description);
/// class_rules  of the class of the world; nullptr: it has none.
v1::ParameterSet to_proto(const parameters::ParameterSet& set, const simulation::ClassRules* class_rules);

/// Adds the warnings about requested parameters to an answer.
void add_warnings(v1::Response& response, const parameters::RequestedParameters& requested);

/// Returns the scheduled values of future generations.
google::protobuf::RepeatedPtrField<v1::ScheduledValue> to_proto(const parameters::Schedule& schedule,
                                                                std::uint64_t after_generation);

v1::PlannedChange to_proto(const parameters::PlannedChange& change);
v1::AppliedChange to_proto(const simulation::Change& change);

/// Returns the current and the pending value of one parameter, and its range in the class of the world.
///
/// class_rules  as above.
v1::ParameterState state_of(const parameters::ParameterDescription& description, const parameters::ParameterSet& set,
                            const simulation::ClassRules* class_rules);

/// Returns the assignments that have a value. Adds a violation for each assignment without a value; in this case it
/// also checks the other assignments. If all have a value, parameters::assign() checks them later, together with the
/// state of the world.
std::vector<parameters::Assignment>
to_assignments(const google::protobuf::RepeatedPtrField<v1::ParameterAssignment>& assignments,
               std::string_view field_prefix, std::vector<base::Violation>& violations);

/// Returns the schedule of a world that begins with these valid parameters. Adds invalid values to `violations`.
parameters::Schedule to_schedule(const google::protobuf::RepeatedPtrField<v1::ScheduledValue>& values,
                                 const parameters::Parameters& parameters, std::string_view field_prefix,
                                 std::vector<base::Violation>& violations);

} // namespace evod::protocol
