// Suggestions: names that are similar to a misspelled word.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace evod::command_line {

/// Returns the edit distance: the smallest number of insertions, deletions, replacements and swaps of adjacent
/// characters that turn `a` into `b`.
std::size_t edit_distance(std::string_view a, std::string_view b);
/// Returns at most three names that are similar to the misspelled `word`, the most similar first.
std::vector<std::string> nearest(std::string_view word, std::span<const std::string> names);
/// Returns "; did you mean A or B?" with the names most similar to `word`; empty if no name is similar.
std::string did_you_mean(std::string_view word, std::span<const std::string> names);

} // namespace evod::command_line
