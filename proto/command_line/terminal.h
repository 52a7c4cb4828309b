// Terminal: colours, and error messages in the one format of all programs.
#pragma once

#include <string>
#include <string_view>

namespace evod::command_line {

/// Whether a stream may contain colours: it is a terminal, and the environment variable NO_COLOR is unset or empty
/// (https://no-color.org).
///
/// descriptor  1 for standard output, 2 for standard error.
bool may_color(int descriptor);

enum class Color { Red, Green, Yellow };
/// Returns the text with the escape sequences of a colour.
std::string colored(std::string_view text, Color color);

/// Prints an error to stderr: every line of the text after "PROGRAM: ", except lines that begin with a blank. The name
/// of the program is red if stderr may contain colours. If the error is about an option, the text is "OPTION: got X,
/// allowed Y".
void print_error(std::string_view program, std::string_view text);

} // namespace evod::command_line
