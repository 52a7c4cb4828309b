// Class: the data of a class and of its members, as classes.sqlite stores it, and the limits of both.
//
// A class belongs to a teacher. Each member is a user of its own, with a world of its own:
//
//   class bio2, member "Red Fox"  →  user bio2/red-fox, world bio2_red-fox
//
// No token has a name with a "/", and no slug contains a "_", so these names are not those of other users and worlds.
//
// Threads      any; plain data.
#pragma once

#include "server/access/token_file.h"
#include "server/simulation/class_rules.h"

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace evod::classes {

using access::Digest;

constexpr std::size_t classes_max = 16;
constexpr std::size_t members_max = 64; // of a class, with those who were removed
constexpr std::size_t class_name_bytes_max = 24;
constexpr std::size_t member_name_characters_max = 24;
constexpr std::size_t member_sessions_max = 3;                 // of one member; the oldest ends
constexpr std::size_t member_tokens_max = member_sessions_max; // of one member; the oldest is forgotten
constexpr std::size_t lesson_name_bytes_max = 64;
constexpr std::uint32_t member_worlds_least = 1, member_worlds_most = 8, member_worlds_by_default = 3;
constexpr std::int64_t code_valid_s = 20 * 60;

/// A narrower range of a numeric parameter in the worlds of a class.
using Range = simulation::ParameterRange;

struct Member {
    std::uint32_t number = 0;        // from 1; never used again in the class
    std::string name;                // as the member or the server chose it
    std::string slug;                // made from the first name; part of the names of its user and world
    bool removed = false;            // by the teacher
    bool joined = false;             // the member has connected at least once
    std::vector<Digest> tokens = {}; // at most member_tokens_max, oldest first
    std::optional<Digest> personal_code = {};
    friend bool operator==(const Member&, const Member&) = default;
};

/// The code with which new members join.
struct JoinCode {
    std::string letters;
    std::int64_t ends_at_s = 0; // seconds since 1970
    friend bool operator==(const JoinCode&, const JoinCode&) = default;
};

struct Class {
    std::string name, teacher;         // teacher: a user; empty: a client without a token
    std::optional<JoinCode> code = {}; // nullopt: the class is locked
    bool frozen = false;
    std::string world_template; // a serialised v1::CreateWorld with a seed and without a name
    bool own_seeds = false;     // each member's world has a seed of its own
    std::vector<Range> ranges = {};
    std::uint32_t member_worlds_max = member_worlds_by_default;
    std::string lesson = {};          // empty: none
    std::uint32_t last_number = 0;    // of a member
    std::vector<Member> members = {}; // ordered by number
    friend bool operator==(const Class&, const Class&) = default;
};

/// The key is the name of the class.
using Classes = std::map<std::string, Class>;

/// Returns 64 random bits. In the server they come from the operating system.
using Draw = std::function<std::uint64_t()>;

inline std::string user_of(const Class& of, const Member& member) {
    return of.name + "/" + member.slug;
}
inline std::string world_of(const Class& of, const Member& member) {
    return of.name + "_" + member.slug;
}
/// Whether a user is a member of a class.
inline bool is_member_name(const std::string& user) {
    return user.find('/') != std::string::npos;
}

} // namespace evod::classes
