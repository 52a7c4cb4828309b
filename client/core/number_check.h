// Number check: finds numbers in a message of a server that no program can compute with or draw.
//
// Threads      any; no state.
#pragma once

#include <google/protobuf/message.h>

#include <string>

namespace evod::core {

/// Returns the name of the first field that contains NaN, an infinite limit of a parameter or a count above 2^28,
/// because Dear ImGui aborts the program for a slider or table with such a range; an empty text if there is none.
/// Metrics are not checked, because clients only print them.
std::string field_without_number(const google::protobuf::Message& message);

} // namespace evod::core
