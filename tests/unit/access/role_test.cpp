#include "server/access/role.h"

#include <gtest/gtest.h>

namespace evod::access {
namespace {

TEST(Role, HasANameThatLeadsBackToIt) {
    for (const Role role : {Role::Viewer, Role::Controller, Role::Admin}) {
        EXPECT_EQ(role_named(name_of(role)), role);
        EXPECT_NE(to_proto(role), v1::ROLE_UNSPECIFIED);
    }
    EXPECT_EQ(role_named("owner"), std::nullopt);
}

} // namespace
} // namespace evod::access
