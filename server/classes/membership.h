// Membership: who may connect as which member, and how a class changes. Each function changes one value in memory; the
// registry stores it.
//
// Threads      any; no state. Random numbers and the time are arguments.
#pragma once

#include "server/base/result.h"
#include "server/classes/class.h"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace evod::classes {

/// Returns the class with this name; nullptr if there is none.
const Class* find(const Classes& classes, const std::string& name);
/// Returns the member with this number; nullptr if there is none.
Member* find(Class& of, std::uint32_t number);

/// A member, and the class to which it belongs.
struct Found {
    const Class* of;
    const Member* member;
};

/// Finds a member by one of its tokens, also a removed member. Compares with all tokens, in constant time.
std::optional<Found> find_by_token(const Classes& classes, std::string_view token);
/// Finds a member by its personal code, also a removed member. Compares in the same way.
///
/// code  a normalised code.
std::optional<Found> find_by_personal_code(const Classes& classes, std::string_view code);
/// Finds the class that new members can join with this code now. Compares in the same way.
const Class* find_by_code(const Classes& classes, std::string_view code, std::int64_t now_s);

/// Whether new members can join the class now.
bool is_open(const Class& of, std::int64_t now_s);
/// Makes the code valid from now on. Draws another one if it is not valid now, or if `new_code` is true.
///
/// classes  all classes: no two of them have the same code.
void open(Class& of, bool new_code, const Classes& classes, std::int64_t now_s, const Draw& draw);

/// Adds a member. Refuses an invalid name, the name of another member, and one more than members_max.
///
/// name   as given; empty: one is made up.
/// field  "hello.join.name", for refusals.
/// returns the new member, which stays valid until the next one is added.
base::Result<Member*> add_member(Class& of, std::string_view name, const std::string& field, const Draw& draw);
/// Changes the name of a member. Refused as above, and if the name is empty.
base::Result<void> rename(Class& of, Member& member, std::string_view name, const std::string& field);

/// Draws one more token for the member, and returns it: "evod_" and 64 hexadecimal digits.
std::string add_token(Member& member, const Draw& draw);
/// Draws another personal code, and returns it.
std::string renew_personal_code(Member& member, const Draw& draw);

} // namespace evod::classes
