// Parameters to and from messages.
#pragma once

#include "evod/v1/commands.pb.h"
#include "evod/v1/world.pb.h"
#include "server/base/result.h"
#include "server/simulation/parameters.h"
#include "server/simulation/schedule.h"

#include <google/protobuf/repeated_ptr_field.h>

#include <string_view>
#include <vector>

namespace evod::protocol {

v1::ParameterValue to_proto(const simulation::ParameterValue& value);
v1::ParameterDescription to_proto(const simulation::ParameterDescription& description);
v1::ParameterSet to_proto(const simulation::ParameterSet& set);

/// What is planned for the generations after that one.
google::protobuf::RepeatedPtrField<v1::ScheduledValue> to_proto(const simulation::Schedule& schedule,
                                                                std::uint64_t after_generation);

v1::PlannedChange to_proto(const simulation::PlannedChange& change);

/// What holds, and what is waiting, of one parameter.
v1::ParameterState state_of(const simulation::ParameterDescription& description, const simulation::ParameterSet& set);

/// Assignments that have a value each. Those without are added to `violations`, and then so is whatever is wrong with
/// the others on their own; what is wrong with them otherwise is found by simulation::assign, which knows the world.
std::vector<simulation::Assignment>
to_assignments(const google::protobuf::RepeatedPtrField<v1::ParameterAssignment>& assignments,
               std::string_view field_prefix, std::vector<base::Violation>& violations);

/// The schedule of a world that begins with these parameters, which are valid; what is wrong is added to `violations`.
simulation::Schedule to_schedule(const google::protobuf::RepeatedPtrField<v1::ScheduledValue>& values,
                                 const simulation::Parameters& parameters, std::string_view field_prefix,
                                 std::vector<base::Violation>& violations);

} // namespace evod::protocol
