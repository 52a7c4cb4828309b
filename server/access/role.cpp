#include "server/access/role.h"

namespace evod::access {

const char* name_of(Role role) {
    switch (role) {
    case Role::Viewer:
        return "viewer";
    case Role::Controller:
        return "controller";
    case Role::Admin:
        return "admin";
    }
    return "nobody";
}

std::optional<Role> role_named(std::string_view name) {
    for (const Role role : {Role::Viewer, Role::Controller, Role::Admin}) {
        if (name == name_of(role)) {
            return role;
        }
    }
    return std::nullopt;
}

// A request without a line here is an error of the build: nothing is allowed by accident.
#pragma GCC diagnostic push
#pragma GCC diagnostic error "-Wswitch"
Role role_needed(v1::Request::KindCase request, bool of_own_past) {
    using Case = v1::Request::KindCase;
    switch (request) {
    case Case::kListWorlds:
    case Case::kGetParameters:
    case Case::kGetStatistics:
    case Case::kGetHistory:
    case Case::kGetOrganism:
    case Case::kDescribe:
    case Case::kGetMetrics:
    case Case::kGetBreeding:
    case Case::kGetPopulation:
    case Case::kGetMotion:
    case Case::kSubscribeSnapshots:
    case Case::kSubscribeEvents:
    case Case::kUnsubscribe:
    case Case::kRequestKeyframe:
    case Case::kSetView:
    case Case::kOpenReplay:
    case Case::kExportRun:
    case Case::kContinueExport:
        return Role::Viewer;
    case Case::kRun:
    case Case::kRunUntilTick:
    case Case::kPause:
    case Case::kResume:
    case Case::kSetSpeed:
    case Case::kSeek:
    case Case::kCloseReplay:
        return of_own_past ? Role::Viewer : Role::Controller;
    case Case::kResetWorld:
    case Case::kSetParameters:
    case Case::kCancelChange:
    case Case::kReleaseLease:
    case Case::kRenewLease:
        return Role::Controller;
    case Case::kCreateWorld:
    case Case::kDeleteWorld:
    case Case::kForkWorld:
    case Case::kShutDown:
    case Case::KIND_NOT_SET:
        return Role::Admin;
    }
    return Role::Admin;
}
#pragma GCC diagnostic pop

} // namespace evod::access
