// Class info: a class as evoctl reads and prints it; its members by name or number, and their links.
#pragma once

#include "client/ctl/caller.h"

#include <string>
#include <vector>

namespace evod::ctl {

/// Returns a class of this user. Throws Stop if there is none with this name.
v1::ClassInfo class_named(Caller& caller, const std::string& name);

/// Returns the member with this name, otherwise the one with this number. Throws Stop if there is none.
const v1::ClassMember& member_named(const v1::ClassInfo& info, const std::string& word);

/// Returns the link with which a browser joins: "http://lab:7745/#join=KTRMXB". Throws Stop if there is no page.
///
/// page  the address of the page; empty: the one that the server reports.
std::string join_link(const Caller& caller, const std::string& page, const std::string& code);

/// Describes a class: its state, its link, its members.
std::string class_text(const v1::ClassInfo& info);

/// "1:05 min" for the validity of a code.
std::string code_text(const v1::ClassInfo& info);

} // namespace evod::ctl
