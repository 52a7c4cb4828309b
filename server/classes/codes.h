// Codes: the letters with which students join a class. They contain no vowels, so that they form no words, and no Y.
//
//   code of a class   six letters, 64 million; valid for 20 minutes
//   personal code     ten letters, 10^13, so that it may be valid for ever
//
// Threads      any; no state.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace evod::classes {

constexpr std::string_view code_letters = "BCDFGHJKLMNPQRSTVWXZ";
constexpr std::size_t class_code_letters = 6, personal_code_letters = 10;

/// Returns `count` letters, at most 10.
///
/// random  64 random bits. The letters are uniform except for 20^count / 2^64, less than 10^-6.
std::string code_of(std::uint64_t random, std::size_t count);

/// Returns the code in upper case and without the spaces and hyphens that people add. Returns nullopt if it contains
/// other characters, or if no code has so many letters.
std::optional<std::string> normalised_code(std::string_view given);

/// Whether two codes are equal. The time does not depend on the place of a difference.
bool same_code(std::string_view a, std::string_view b);

} // namespace evod::classes
