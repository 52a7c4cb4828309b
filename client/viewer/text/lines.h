// Lines: breaks a text into lines of a given width.
//
// Owner        none: a function.
// Threads      any.
#pragma once

#include <functional>
#include <string>
#include <string_view>

namespace evod::viewer {

/// Replaces spaces by line breaks so that no line is wider than `width_max`. Breaks a word only if the word alone is
/// wider than a line. Numbers that contain commas or points stay whole.
///
/// width_of  function that returns the width of a text on one line
std::string in_lines(std::string_view text, float width_max, const std::function<float(std::string_view)>& width_of);

} // namespace evod::viewer
