#include "server/access/authorization.h"

#include <gmock/gmock.h>
#include <google/protobuf/descriptor.h>
#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

namespace evod::access {
namespace {

using testing::HasSubstr;

constexpr Role all_roles[] = {Role::Viewer, Role::Teacher, Role::Controller, Role::Admin};

struct NamedRules {
    std::string name;
    v1::RequestRules rules;
};

std::vector<NamedRules> all_requests() {
    std::vector<NamedRules> requests;
    const auto* kinds = v1::Request::descriptor()->FindOneofByName("kind");
    for (int i = 0; i < kinds->field_count(); ++i) {
        requests.push_back({kinds->field(i)->name(), kinds->field(i)->options().GetExtension(v1::rules)});
    }
    return requests;
}

const simulation::Ownership of_no_user;
const simulation::Ownership of_ann{.user = "bio/ann", .class_name = "bio", .teacher = "kant"};

bool permits(const Requester& requester, const NamedRules& request, const simulation::Ownership& ownership,
             bool frozen = false) {
    const RequestedWorld world{ownership, frozen};
    return may(requester, request.rules, request.name, &world).has_value();
}

TEST(Authorization, TheRoleNeededIsThatOfTheRules) {
    v1::RequestRules rules;
    rules.set_role(v1::ROLE_VIEWER);
    EXPECT_EQ(role_needed(rules, false), Role::Viewer);
    rules.set_role(v1::ROLE_TEACHER);
    EXPECT_EQ(role_needed(rules, false), Role::Teacher);
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

TEST(Authorization, OwnersMaySendExactlyTheRequestsThatConcernOneWorld) {
    const std::set<std::string> expected{"delete_world", "reset_world", "run",           "run_until_tick",
                                         "pause",        "resume",      "set_speed",     "set_parameters",
                                         "fork_world",   "add_note",    "release_lease", "cancel_change",
                                         "place",        "remove",      "set_fitness",   "renew_lease"};
    std::set<std::string> by_owner;
    for (const NamedRules& request : all_requests()) {
        if (request.rules.by_owner()) {
            by_owner.insert(request.name);
        }
    }
    EXPECT_EQ(by_owner, expected);
}

/// Every role, request, owner, own replay and freeze.
TEST(Authorization, TheWholeMatrix) {
    struct User {
        const char* name;
        bool owns, teaches;
    };
    const User users[] = {{"bio/ann", true, false},
                          {"kant", false, true},
                          {"bio/ben", false, false},
                          {"hume", false, false},
                          {"", false, false}};
    std::size_t permitted = 0, refused = 0;
    for (const NamedRules& request : all_requests()) {
        for (const Role role : all_roles) {
            for (const User& user : users) {
                for (const bool frozen : {false, true}) {
                    for (const bool in_own_replay : {false, true}) {
                        const Requester requester{user.name, role, in_own_replay};
                        const bool by_role = role >= role_needed(request.rules, in_own_replay);
                        const bool by_ownership = request.rules.by_owner() && (user.teaches || (user.owns && !frozen));
                        EXPECT_EQ(permits(requester, request, of_ann, frozen), by_role || by_ownership)
                            << user.name << " as " << name_of(role) << ": " << request.name << ", frozen " << frozen;
                        EXPECT_EQ(permits(requester, request, of_no_user, frozen), by_role)
                            << user.name << " as " << name_of(role) << ": " << request.name;
                        // What is permitted for some world must reach the thread that knows the world.
                        EXPECT_EQ(may(requester, request.rules, request.name, nullptr).has_value(),
                                  by_role || request.rules.by_owner());
                        ++(by_role || by_ownership ? permitted : refused);
                    }
                }
            }
        }
    }
    EXPECT_GT(permitted, 1'000u);
    EXPECT_GT(refused, 500u);
}

TEST(Authorization, ALowerRoleIsRefusedAndLearnsBothRoles) {
    v1::RequestRules rules;
    rules.set_role(v1::ROLE_CONTROLLER);
    EXPECT_TRUE(may({"a", Role::Controller}, rules, "pause", nullptr));
    EXPECT_TRUE(may({"a", Role::Admin}, rules, "pause", nullptr));
    const auto refused = may({"a", Role::Viewer}, rules, "pause", nullptr);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, base::RefusalCode::PermissionDenied);
    EXPECT_EQ(refused.error().message,
              "pause needs the role controller; this session has the role viewer: connect with a token of that role");
}

TEST(Authorization, ARefusalNamesTheOwner) {
    v1::RequestRules rules;
    rules.set_role(v1::ROLE_CONTROLLER);
    rules.set_by_owner(true);
    const RequestedWorld world{of_ann};
    const auto refused = may({"bio/ben", Role::Viewer}, rules, "pause", &world);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, base::RefusalCode::PermissionDenied);
    EXPECT_THAT(refused.error().message, HasSubstr("this world belongs to bio/ann"));
    ASSERT_EQ(refused.error().arguments.size(), 1u);
    EXPECT_EQ(refused.error().arguments[0].name, "owner");
}

TEST(Authorization, InAFrozenClassOwnersWaitAndTeachersDoNot) {
    v1::RequestRules rules;
    rules.set_role(v1::ROLE_CONTROLLER);
    rules.set_by_owner(true);
    const RequestedWorld world{of_ann, true};
    const auto refused = may({"bio/ann", Role::Viewer}, rules, "pause", &world);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().reason, base::Reason::WorldFrozen);
    EXPECT_EQ(refused.error().message, "kant has frozen the class: wait until it goes on");
    EXPECT_TRUE(may({"kant", Role::Teacher}, rules, "pause", &world));
    EXPECT_TRUE(may({"root", Role::Admin}, rules, "pause", &world));
}

TEST(Authorization, WithoutATokenNoUserOwnsAWorld) {
    EXPECT_FALSE(owns({"", Role::Viewer}, of_no_user));
}

} // namespace
} // namespace evod::access
