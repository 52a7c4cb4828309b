// Lines: a text broken so that it fits.
//
// Threads      none.
#pragma once

#include <functional>
#include <string>
#include <string_view>

namespace evod::viewer {

/// The text with line breaks in place of spaces, so that no line is wider than `width_max`. A word that is wider is
/// broken between its signs; nothing else is, numbers with commas and points least of all.
///
/// width_of  of a text in one line
std::string in_lines(std::string_view text, float width_max, const std::function<float(std::string_view)>& width_of);

} // namespace evod::viewer
