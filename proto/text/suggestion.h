// Suggestions: names that are similar to a misspelled word, and what is wrong with a value. Standard library only,
// because every folder may include this one.
//
// Threads      any; no state.
#pragma once

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <numeric>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace evod::text {

/// Returns the edit distance: the smallest number of insertions, deletions, replacements and swaps of adjacent
/// characters that turn `a` into `b`.
inline std::size_t edit_distance(std::string_view a, std::string_view b) {
    // Optimal string alignment distance: Damerau's distance, with the restriction that each substring is edited at most
    // once. Stores only three rows of the table.
    std::vector<std::size_t> before(b.size() + 1), above(b.size() + 1), row(b.size() + 1);
    std::iota(above.begin(), above.end(), std::size_t{0});
    for (std::size_t i = 1; i <= a.size(); ++i) {
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const std::size_t replaced = above[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
            row[j] = std::min({above[j] + 1, row[j - 1] + 1, replaced});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
                row[j] = std::min(row[j], before[j - 2] + 1);
            }
        }
        std::swap(before, above);
        std::swap(above, row);
    }
    return above[b.size()];
}

/// Returns at most three names that are similar to the misspelled `word`, the most similar first.
///
/// names  a range of std::string or std::string_view.
template <class Names>
std::vector<std::string> nearest(std::string_view word, const Names& names) {
    constexpr std::size_t compared_max = 64; // the word may come from a file or a request
    word = word.substr(0, compared_max);
    std::vector<std::pair<std::size_t, std::string>> ranked;
    for (const std::string_view name : names) {
        const std::size_t distance = edit_distance(word, name);
        // A word that is part of a name counts as similar: "mutation" to "mutation_chance".
        const bool part = word.size() >= 3 && name.find(word) != std::string_view::npos;
        if (distance <= std::max<std::size_t>(2, word.size() / 3) || part) {
            ranked.emplace_back(distance, name);
        }
    }
    std::sort(ranked.begin(), ranked.end());
    std::vector<std::string> result;
    for (std::size_t i = 0; i < std::min<std::size_t>(3, ranked.size()); ++i) {
        result.push_back(std::move(ranked[i].second));
    }
    return result;
}

/// Returns "; did you mean A or B?" with the names most similar to `word`; empty if no name is similar.
template <class Names>
std::string did_you_mean(std::string_view word, const Names& names) {
    const auto candidates = nearest(word, names);
    std::string text;
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        text += (i == 0 ? "; did you mean " : i + 1 == candidates.size() ? " or " : ", ") + candidates[i];
    }
    return text.empty() ? text : text + "?";
}

/// Returns what the author of a value that cannot be read probably has to change, after a semicolon; an empty text if
/// the cause is unknown.
///
/// is_number  whether the value has to be a number.
inline std::string value_hint(std::string_view value, bool is_number) {
    std::string changed{value};
    std::replace(changed.begin(), changed.end(), ',', '.');
    double number = 0;
    const char* const end = changed.data() + changed.size();
    if (is_number && changed != value && std::from_chars(changed.data(), end, number).ptr == end) {
        return "; write a decimal point: " + changed;
    }
    changed = value;
    std::transform(changed.begin(), changed.end(), changed.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
    return !is_number && changed != value ? "; write it in lower case" : "";
}

} // namespace evod::text
