// JSON: converts messages to JSON, for programs that read the output of evoctl.
#pragma once

#include <google/protobuf/message.h>

#include <string>

namespace evod::ctl {

/// Converts a message to JSON with the field names of the .proto files. 64-bit numbers from 2^53 on become strings,
/// because many JSON readers cannot represent them exactly.
///
/// many_lines  false: write everything on one line.
std::string to_json(const google::protobuf::Message& message, bool many_lines = true);

} // namespace evod::ctl
