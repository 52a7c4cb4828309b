// Class requests and class admission, without the simulation: who is admitted, and what the simulation is asked for.
#include "server/network/class_requests.h"

#include "server/access/random.h"
#include "server/network/class_admission.h"
#include "server/network/class_events.h"
#include "tests/unit/network/loopback.h"

#include <string>
#include <vector>

namespace evod::network {
namespace {

class ClassRequestsTest : public Loopback {
  protected:
    v1::Response ask(const v1::Request& request) {
        Client& teacher = clients.empty() ? connect(access::Role::Admin) : *clients.front();
        requests.handle(*teacher.session, request);
        settle();
        return teacher.responses.back();
    }
    v1::ClassInfo create(const std::string& name, v1::ClassSeeds seeds = v1::CLASS_SEEDS_SAME) {
        v1::Request request;
        request.set_request_id(1);
        request.mutable_create_class()->set_name(name);
        request.mutable_create_class()->set_seeds(seeds);
        request.mutable_create_class()->mutable_template_()->set_seed(7);
        return ask(request).class_info();
    }
    base::Result<AdmittedMember> join(const std::string& code, const std::string& name = "") {
        v1::Hello hello;
        hello.mutable_join()->set_code(code);
        hello.mutable_join()->set_name(name);
        return *requests.admit(hello);
    }

    std::vector<v1::Request> created; // commands that create worlds
    std::vector<simulation::Ownership> owners;
    std::vector<std::string> left_worlds, deleted; // worlds of a class, and those that were deleted
    std::vector<std::string> rules_of;             // classes whose rules were set
    bool is_busy = false;
    classes::Registry registry;
    ClassRequests requests{
        context,
        registry,
        sessions,
        host,
        {.create_world =
             [this](v1::Request request, simulation::Ownership owner) {
                 if (!is_busy) {
                     created.push_back(std::move(request));
                     owners.push_back(std::move(owner));
                 }
                 return !is_busy;
             },
         .send = [this](const v1::Request& request) { deleted.push_back(request.delete_world().world()); },
         .set_class =
             [this](const std::string& name, const auto&, const auto&, const auto& done) {
                 rules_of.push_back(name);
                 done(left_worlds);
             }},
        access::draw_random};
};

TEST_F(ClassRequestsTest, AJoinCreatesTheMembersWorld) {
    const v1::ClassInfo info = create("bio2");
    EXPECT_EQ(rules_of, std::vector<std::string>{"bio2"});
    const auto anna = join(info.code(), "Anna");
    ASSERT_TRUE(anna);
    EXPECT_EQ(anna->user.name, "bio2/anna");
    EXPECT_EQ(anna->user.role, access::Role::Viewer);
    EXPECT_TRUE(anna->user.is_member);
    ASSERT_EQ(created.size(), 1u);
    EXPECT_EQ(created[0].create_world().name(), "bio2_anna");
    EXPECT_EQ(created[0].create_world().seed(), 7u);
    EXPECT_EQ(owners[0], (simulation::Ownership{"bio2/anna", "bio2", ""}));

    v1::Hello again;
    again.set_token(anna->membership.token());
    EXPECT_EQ((*requests.admit(again))->membership.world(), "bio2_anna");
    EXPECT_EQ(created.size(), 2u) << "it may be missing";
    again.set_token("evod_");
    EXPECT_FALSE(requests.admit(again)) << "not a member";
}

TEST_F(ClassRequestsTest, OwnSeedsFollowFromTheNumber) {
    const v1::ClassInfo info = create("bio2", v1::CLASS_SEEDS_OWN);
    ASSERT_TRUE(join(info.code(), "Anna"));
    ASSERT_TRUE(join(info.code(), "Ben"));
    EXPECT_NE(created[0].create_world().seed(), created[1].create_world().seed());
    const std::uint64_t first = created[0].create_world().seed();
    const v1::ClassInfo other = create("bio3", v1::CLASS_SEEDS_OWN);
    ASSERT_TRUE(join(other.code(), "Zoe"));
    EXPECT_EQ(created[2].create_world().seed(), first) << "of the same template and number";
}

TEST_F(ClassRequestsTest, WrongCodesAreBoundedNotRightOnes) {
    const v1::ClassInfo info = create("bio2");
    for (int i = 0; i < 50; ++i) {
        EXPECT_EQ(join("BBBBBB").error().reason, base::Reason::CodeUnknown) << i;
    }
    const auto refused = join("BBBBBB");
    EXPECT_EQ(refused.error().reason, base::Reason::JoinsTooFast);
    EXPECT_EQ(refused.error().arguments.at(0).value, "10");
    EXPECT_EQ(join("not a code").error().reason, base::Reason::JoinsTooFast);
    EXPECT_TRUE(join(info.code(), "Anna"));
    EXPECT_EQ(counters.count(Limit::WrongCodes), 2u);
    clock.advance(std::chrono::seconds{1});
    for (int i = 0; i < 5; ++i) {
        EXPECT_EQ(join("BBBBBB").error().reason, base::Reason::CodeUnknown) << i;
    }
    EXPECT_EQ(join("BBBBBB").error().reason, base::Reason::JoinsTooFast);
}

TEST_F(ClassRequestsTest, ABusySimulationGetsTheWorldLater) {
    const v1::ClassInfo info = create("bio2");
    is_busy = true;
    ASSERT_TRUE(join(info.code(), "Anna"));
    EXPECT_TRUE(created.empty());
    is_busy = false;
    context.restart();
    while (created.empty() && context.run_one() > 0) {
    }
    ASSERT_EQ(created.size(), 1u);
    EXPECT_EQ(created[0].create_world().name(), "bio2_anna");
}

TEST_F(ClassRequestsTest, ANewClassHasNoWorldsOfAnEarlierOne) {
    left_worlds = {"bio2_anna"};
    create("bio2");
    EXPECT_EQ(deleted, left_worlds);
}

TEST_F(ClassRequestsTest, AnUnknownFieldIsRefused) {
    v1::Request request;
    request.set_request_id(1);
    request.mutable_create_class()->set_name("bio2");
    request.mutable_create_class()
        ->GetReflection()
        ->MutableUnknownFields(request.mutable_create_class())
        ->AddVarint(99, 1);
    EXPECT_EQ(ask(request).status().reason(), v1::REASON_FIELD_UNKNOWN);
    EXPECT_TRUE(registry.classes().empty());
}

} // namespace
} // namespace evod::network
