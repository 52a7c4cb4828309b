#include "server/runtime/admission.h"

#include "server/protocol/request_rules.h"

#include <gtest/gtest.h>

namespace evod::runtime {
namespace {

class OneCommand : public testing::Test {
  protected:
    OneCommand() {
        simulation::CreateWorld create{"bio_ann", {}, base::Seed{1}, simulation::RunId{1, 1}};
        create.parameters.population_size = 2;
        create.ownership = ann;
        EXPECT_TRUE(laboratory.apply(create));
    }
    CommandMail mail(simulation::Command command, const v1::Request& request, access::Requester requester) {
        return {.command = std::move(command),
                .origin = {},
                .request_name = protocol::name_of(request),
                .requester = std::move(requester),
                .rules = protocol::rules_of(request)};
    }
    CommandMail fork(access::Requester requester) {
        v1::Request request;
        request.mutable_fork_world();
        return mail(simulation::ForkWorld{"bio_ann", "bio_ann_2", {}, {}}, request, std::move(requester));
    }
    const simulation::Entry* world() { return *std::as_const(laboratory).find("bio_ann"); }
    static const simulation::Ownership& owner_of(const CommandMail& mail) {
        return std::get<simulation::ForkWorld>(mail.command).ownership;
    }

    const simulation::Ownership ann{.user = "bio/ann", .class_name = "bio", .teacher = "kant"};
    simulation::Laboratory laboratory;
};

TEST_F(OneCommand, AForkByTheOwnerStaysInTheClass) {
    CommandMail command = fork({"bio/ann", access::Role::Viewer});
    EXPECT_FALSE(admit(command, world()));
    EXPECT_EQ(owner_of(command), ann);
}

TEST_F(OneCommand, AForkByTheTeacherBelongsToTheTeacher) {
    CommandMail command = fork({"kant", access::Role::Teacher});
    EXPECT_FALSE(admit(command, world()));
    EXPECT_EQ(owner_of(command), (simulation::Ownership{.user = "kant", .class_name = "bio", .teacher = "kant"}));
}

TEST_F(OneCommand, AForkByAnAdminLeavesTheClass) {
    CommandMail command = fork({"root", access::Role::Admin});
    EXPECT_FALSE(admit(command, world()));
    EXPECT_EQ(owner_of(command), (simulation::Ownership{.user = "root", .class_name = {}, .teacher = {}}));
}

TEST_F(OneCommand, AForkByAnotherMemberIsRefused) {
    CommandMail command = fork({"bio/ben", access::Role::Viewer});
    const auto refused = admit(command, world());
    ASSERT_TRUE(refused);
    EXPECT_EQ(refused->code, base::RefusalCode::PermissionDenied);
}

TEST_F(OneCommand, AWorldBelongsToItsCreator) {
    v1::Request request;
    request.mutable_create_world();
    CommandMail command =
        mail(simulation::CreateWorld{"w", {}, base::Seed{1}, {}}, request, {"root", access::Role::Admin});
    EXPECT_FALSE(admit(command, nullptr));
    EXPECT_EQ(std::get<simulation::CreateWorld>(command.command).ownership.user, "root");
}

TEST_F(OneCommand, TheServerMayDoEverything) {
    CommandMail command{.command = simulation::DeleteWorld{"bio_ann"}, .origin = {}, .request_name = "delete_world"};
    EXPECT_FALSE(admit(command, world()));
}

} // namespace
} // namespace evod::runtime
