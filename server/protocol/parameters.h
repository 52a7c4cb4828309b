// Parameters to and from messages.
#pragma once

#include "evod/v1/commands.pb.h"
#include "evod/v1/world.pb.h"
#include "server/base/result.h"
#include "server/parameters/parameters.h"
#include "server/parameters/schedule.h"

#include <google/protobuf/repeated_ptr_field.h>

#include <string_view>
#include <vector>

namespace evod::protocol {

v1::ParameterValue to_proto(const parameters::ParameterValue& value);
v1::ParameterDescription to_proto(const parameters::ParameterDescription& description);
v1::ParameterSet to_proto(const parameters::ParameterSet& set);

/// What is planned for the generations after that one.
google::protobuf::RepeatedPtrField<v1::ScheduledValue> to_proto(const parameters::Schedule& schedule,
                                                                std::uint64_t after_generation);

v1::PlannedChange to_proto(const parameters::PlannedChange& change);

/// What holds, and what is waiting, of one parameter.
v1::ParameterState state_of(const parameters::ParameterDescription& description, const parameters::ParameterSet& set);

/// Assignments that have a value each. Those without are added to `violations`, and then so is whatever is wrong with
/// the others on their own; what is wrong with them otherwise is found by parameters::assign, which knows the world.
std::vector<parameters::Assignment>
to_assignments(const google::protobuf::RepeatedPtrField<v1::ParameterAssignment>& assignments,
               std::string_view field_prefix, std::vector<base::Violation>& violations);

/// The schedule of a world that begins with these parameters, which are valid; what is wrong is added to `violations`.
parameters::Schedule to_schedule(const google::protobuf::RepeatedPtrField<v1::ScheduledValue>& values,
                                 const parameters::Parameters& parameters, std::string_view field_prefix,
                                 std::vector<base::Violation>& violations);

} // namespace evod::protocol
