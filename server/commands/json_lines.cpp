#include "server/commands/json_lines.h"

#include "proto/command_line/command.h"

#include <boost/json/serialize.hpp>

#include <cstdio>

namespace evod::commands {

command_line::Option add_json_option(command_line::Command& command, bool& json) {
    return command.add_flag(
        "--json", &json,
        "Print the result for programs, as one JSON object on the last line; lines before it state the progress");
}

void print_json(const boost::json::object& object) {
    std::puts(boost::json::serialize(object).c_str());
    std::fflush(stdout);
}

} // namespace evod::commands
