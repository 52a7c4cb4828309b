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

TEST(Role, NeededForARequestIsThatOfItsRules) {
    v1::RequestRules rules;
    rules.set_role(v1::ROLE_VIEWER);
    EXPECT_EQ(role_needed(rules, false), Role::Viewer);
    rules.set_role(v1::ROLE_CONTROLLER);
    EXPECT_EQ(role_needed(rules, false), Role::Controller);
    EXPECT_EQ(role_needed(rules, true), Role::Controller) << "the rules make no exception for replays";
    rules.set_viewer_in_own_replay(true);
    EXPECT_EQ(role_needed(rules, true), Role::Viewer);
    EXPECT_EQ(role_needed(rules, false), Role::Controller);
}

TEST(Role, NeededWithoutRulesIsTheHighest) {
    EXPECT_EQ(role_needed(v1::RequestRules{}, false), Role::Admin);
    EXPECT_EQ(role_needed(v1::RequestRules{}, true), Role::Admin);
}

} // namespace
} // namespace evod::access
