#include "server/access/role.h"

namespace evod::access {

const char* name_of(Role role) {
    switch (role) {
    case Role::Viewer:
        return "viewer";
    case Role::Teacher:
        return "teacher";
    case Role::Controller:
        return "controller";
    case Role::Admin:
        return "admin";
    }
    return "unknown role";
}

std::optional<Role> role_named(std::string_view name) {
    for (const Role role : {Role::Viewer, Role::Teacher, Role::Controller, Role::Admin}) {
        if (name == name_of(role)) {
            return role;
        }
    }
    return std::nullopt;
}

v1::Role to_proto(Role role) {
    switch (role) {
    case Role::Viewer:
        return v1::ROLE_VIEWER;
    case Role::Teacher:
        return v1::ROLE_TEACHER;
    case Role::Controller:
        return v1::ROLE_CONTROLLER;
    case Role::Admin:
        return v1::ROLE_ADMIN;
    }
    return v1::ROLE_UNSPECIFIED;
}

} // namespace evod::access
