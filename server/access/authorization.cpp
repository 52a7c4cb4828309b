#include "server/access/authorization.h"

namespace evod::access {
namespace {

base::Refusal role_too_low(const Requester& requester, Role needed, const std::string& request,
                           const simulation::Ownership* owner) {
    base::Refusal refused = base::refusal(base::RefusalCode::PermissionDenied, {}, base::Reason::RoleTooLow);
    if (owner != nullptr && !owner->user.empty()) {
        refused.message = "this world belongs to " + owner->user + ": " + request + " needs the role " +
                          name_of(needed) + " there, and this session has the role " + name_of(requester.role);
        refused.arguments.push_back({"owner", owner->user});
    } else {
        refused.message = request + " needs the role " + name_of(needed) + "; this session has the role " +
                          name_of(requester.role) + ": connect with a token of that role";
    }
    return refused;
}

} // namespace

Role role_needed(const v1::RequestRules& rules, bool in_own_replay) {
    if (in_own_replay && rules.viewer_in_own_replay()) {
        return Role::Viewer;
    }
    switch (rules.role()) {
    case v1::ROLE_VIEWER:
        return Role::Viewer;
    case v1::ROLE_TEACHER:
        return Role::Teacher;
    case v1::ROLE_CONTROLLER:
        return Role::Controller;
    default:
        return Role::Admin;
    }
}

bool owns(const Requester& requester, const simulation::Ownership& ownership) {
    return !requester.user.empty() && (requester.user == ownership.user || requester.user == ownership.teacher);
}

base::Result<void> may(const Requester& requester, const v1::RequestRules& rules, const std::string& request,
                       const RequestedWorld* world) {
    const Role needed = role_needed(rules, requester.in_own_replay);
    if (requester.role >= needed || (rules.by_owner() && world == nullptr)) {
        return {};
    }
    if (!rules.by_owner() || !owns(requester, world->ownership)) {
        return role_too_low(requester, needed, request, world != nullptr ? &world->ownership : nullptr);
    }
    if (world->frozen && requester.user != world->ownership.teacher) {
        base::Refusal frozen = base::refusal(base::RefusalCode::FailedPrecondition,
                                             world->ownership.teacher + " has frozen the class: wait until it goes on",
                                             base::Reason::WorldFrozen);
        frozen.arguments.push_back({"class", world->ownership.class_name});
        return frozen;
    }
    return {};
}

} // namespace evod::access
