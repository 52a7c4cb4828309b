// JSON of messages, for programs that read what evoctl prints.
#pragma once

#include <google/protobuf/message.h>

#include <string>

namespace evod::ctl {

/// JSON with the names of the .proto files; on one line or many.
/// 64-bit numbers below 2^53 are numbers there, larger ones strings, as not every reader of JSON has them exactly.
std::string to_json(const google::protobuf::Message& message, bool many_lines = true);

} // namespace evod::ctl
