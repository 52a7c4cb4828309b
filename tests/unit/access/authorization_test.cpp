#include "server/access/authorization.h"

#include <gtest/gtest.h>

namespace evod::access {
namespace {

TEST(Authorization, TheRoleNeededIsThatOfTheRules) {
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

TEST(Authorization, WithoutRulesTheHighestRoleIsNeeded) {
    EXPECT_EQ(role_needed(v1::RequestRules{}, false), Role::Admin);
    EXPECT_EQ(role_needed(v1::RequestRules{}, true), Role::Admin);
}

TEST(Authorization, ALowerRoleIsRefusedAndLearnsBothRoles) {
    v1::RequestRules rules;
    rules.set_role(v1::ROLE_CONTROLLER);
    EXPECT_TRUE(authorize(Role::Controller, rules, "pause", false));
    EXPECT_TRUE(authorize(Role::Admin, rules, "pause", false));
    const auto refused = authorize(Role::Viewer, rules, "pause", false);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, base::RefusalCode::PermissionDenied);
    EXPECT_EQ(refused.error().message,
              "pause needs the role controller; this session has the role viewer: connect with a token of that role");
}

} // namespace
} // namespace evod::access
