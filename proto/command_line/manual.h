// Manual: the man page of a program, generated from its tables of options and subcommands.
#pragma once

#include <string>

namespace evod::command_line {

class Command;

/// Returns the page in the language of man(7). It contains every option, subcommand and environment variable.
std::string manual(const Command& program);

} // namespace evod::command_line
