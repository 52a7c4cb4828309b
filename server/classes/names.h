// Names: which names classes and their members may have, and the names that the server makes up.
//
// Threads      any; no state.
#pragma once

#include "server/base/result.h"

#include <cstdint>
#include <string>
#include <string_view>

namespace evod::classes {

constexpr std::string_view class_name_allowed = "1 to 24 characters of a-z 0-9 -, a letter first";
constexpr std::string_view member_name_allowed =
    "at most 24 characters of UTF-8 without control characters and invisible characters";

bool is_class_name(std::string_view name);

/// Returns the name of a member without spaces at its ends, and with single spaces within; it may be empty. A refusal
/// names `field`.
base::Result<std::string> cleaned_member_name(std::string_view given, const std::string& field);

/// Returns the name in lower case, so that names that differ in their case only are equal. Covers the letters of
/// Latin, Greek and Cyrillic.
std::string folded(std::string_view name);

/// Returns the part of the names of user and world that is made from a member's name: at most 24 of a-z 0-9 -, at least
/// one, a letter or digit at both ends.
std::string slug_of(std::string_view member_name);

/// Returns a name of two words, such as "red-fox".
///
/// number  any; equal numbers give equal names, and made_up_names consecutive numbers give different ones.
std::string made_up_name(std::uint64_t number);
constexpr std::size_t words_of_a_kind = 64;
constexpr std::size_t made_up_names = words_of_a_kind * words_of_a_kind;

} // namespace evod::classes
