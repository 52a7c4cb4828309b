// World names: the rules for names of worlds and replays, for all code that reads such a name.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string_view>

namespace evod::simulation {

/// A name has 1 to world_name_bytes_max of the characters that is_world_name_character allows.
constexpr std::size_t world_name_bytes_max = 64;
constexpr std::string_view world_name_allowed = "1 to 64 of a-z A-Z 0-9 _ -";

constexpr bool is_world_name_character(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
}

constexpr bool is_world_name(std::string_view name) {
    return !name.empty() && name.size() <= world_name_bytes_max && std::ranges::all_of(name, is_world_name_character);
}

/// A replay has the name of the world whose run it shows, "@" and a number.
constexpr bool is_replay_name(std::string_view name) {
    return name.find('@') != std::string_view::npos;
}
constexpr std::string_view original_of(std::string_view replay) {
    return replay.substr(0, replay.find('@'));
}

/// The world with which a member of a class begins has the name CLASS_MEMBER, without another _ in either part. The
/// forks of the member have names that begin with it and another _.
///
/// world  a world of this class.
constexpr std::string_view first_world_of(std::string_view world, std::string_view class_name) {
    return world.substr(0, world.find('_', class_name.size() + 1));
}

} // namespace evod::simulation
