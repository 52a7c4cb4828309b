// The part of the laboratory that concerns classes.
#include "server/simulation/laboratory.h"

#include "server/simulation/world_name.h"

#include <algorithm>
#include <utility>

namespace evod::simulation {

std::optional<base::Refusal> Laboratory::refusal_of_fork(const ForkWorld& command) const {
    const Ownership& owner = command.ownership;
    const auto rules = classes_.find(owner.class_name);
    if (rules == classes_.end() || owner.class_name.empty()) {
        return std::nullopt;
    }
    const std::string beginning = std::string{first_world_of(original_of(command.world), owner.class_name)} + "_";
    if (!command.name.starts_with(beginning)) {
        return base::Refusal{.code = base::RefusalCode::InvalidArgument,
                             .message = "the name of a fork in a class begins with the name of its world",
                             .violations = {{"fork_world.name", "a name that begins with " + beginning, command.name}}};
    }
    const auto held = static_cast<std::size_t>(
        std::ranges::count_if(entries_, [&](const auto& entry) { return entry->ownership == owner; }));
    const std::size_t allowed = rules->second.worlds_per_member;
    if (owner.user == owner.teacher || held < allowed) {
        return std::nullopt;
    }
    return base::limit_refusal("this member of the class has " + std::to_string(held) + " worlds already, of " +
                                   std::to_string(allowed) + ": delete one first",
                               base::Reason::OwnerWorldsMax, "member_worlds_max", held, allowed);
}

std::vector<std::string> Laboratory::set_class(const std::string& name, std::optional<ClassRules> rules) {
    const bool frozen = rules && rules->frozen;
    if (rules) {
        classes_.insert_or_assign(name, *std::move(rules));
    } else {
        classes_.erase(name);
    }
    std::vector<std::string> changed;
    for (const auto& entry : entries_) {
        if (entry->ownership.class_name == name && std::exchange(entry->frozen, frozen) != frozen) {
            changed.push_back(entry->name);
        }
    }
    return changed;
}

const ClassRules* Laboratory::class_of(const Entry& entry) const {
    const auto rules = classes_.find(entry.ownership.class_name);
    return rules == classes_.end() ? nullptr : &rules->second;
}

} // namespace evod::simulation
