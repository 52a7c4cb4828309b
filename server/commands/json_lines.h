// JSON lines: what a command prints with --json, for other programs: on stdout one JSON object per line, in place of
// tables and sentences. The last line is the result; lines before it contain the member `progress`, 0 to 1.
//
// Threads  one thread at a time.
#pragma once

#include <boost/json/object.hpp>

namespace evod::command_line {
class Command;
class Option;
} // namespace evod::command_line

namespace evod::commands {

/// Adds --json.
command_line::Option add_json_option(command_line::Command& command, bool& json);

/// Prints an object on a line of its own, immediately.
void print_json(const boost::json::object& object);

} // namespace evod::commands
