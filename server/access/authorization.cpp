#include "server/access/authorization.h"

namespace evod::access {

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

base::Result<void> authorize(Role role, const v1::RequestRules& rules, const std::string& request, bool in_own_replay) {
    const Role needed = role_needed(rules, in_own_replay);
    if (role >= needed) {
        return {};
    }
    return base::refusal(base::RefusalCode::PermissionDenied, request + " needs the role " + name_of(needed) +
                                                                  "; this session has the role " + name_of(role) +
                                                                  ": connect with a token of that role");
}

} // namespace evod::access
