// Usage errors: turns the errors of CLI11 into the messages of the programs, "OPTION: got X, allowed Y".
#pragma once

#include <string>

namespace CLI {
class App;
class Option;
class ParseError;
} // namespace CLI

namespace evod::command_line {

/// program  the parser after it has thrown the error.
std::string text_of(const CLI::ParseError& error, const CLI::App& program);

/// The text for an option without a value.
std::string missing(const CLI::Option& option);

/// The parser of the subcommand that the command line names, or the parser of the program itself.
const CLI::App& given_parser(const CLI::App& program);

} // namespace evod::command_line
