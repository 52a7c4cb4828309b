#include "server/protocol/request_rules.h"

#include <google/protobuf/descriptor.h>
#include <gtest/gtest.h>

namespace evod::protocol {
namespace {

v1::Request request_of(const google::protobuf::FieldDescriptor* field) {
    v1::Request request;
    request.GetReflection()->MutableMessage(&request, field);
    return request;
}

TEST(RequestRules, ExistForEveryRequest) {
    const auto& requests = *v1::Request::descriptor()->FindOneofByName("kind");
    const auto& answers = *v1::Response::descriptor()->FindOneofByName("answer");
    for (int i = 0; i < requests.field_count(); ++i) {
        const v1::Request request = request_of(requests.field(i));
        const v1::RequestRules* rules = rules_of(request);
        ASSERT_NE(rules, nullptr);
        EXPECT_NE(rules->kind(), v1::REQUEST_KIND_UNSPECIFIED) << name_of(request);
        EXPECT_NE(rules->role(), v1::ROLE_UNSPECIFIED) << name_of(request);
        const auto* answer = v1::Response::descriptor()->FindFieldByName(rules->answer());
        EXPECT_TRUE(rules->answer().empty() || (answer != nullptr && answer->containing_oneof() == &answers))
            << name_of(request) << " names the answer " << rules->answer();
    }
}

TEST(RequestRules, OfAReplayNeedAWorldToName) {
    const auto& requests = *v1::Request::descriptor()->FindOneofByName("kind");
    for (int i = 0; i < requests.field_count(); ++i) {
        const v1::Request request = request_of(requests.field(i));
        if (rules_of(request)->viewer_in_own_replay()) {
            EXPECT_NE(requests.field(i)->message_type()->FindFieldByName("world"), nullptr) << name_of(request);
        }
    }
}

TEST(RequestRules, DoNotExistForAnUnknownRequest) {
    const v1::Request unknown;
    EXPECT_EQ(rules_of(unknown), nullptr);
    EXPECT_EQ(kind_of(unknown), v1::REQUEST_KIND_UNSPECIFIED);
    EXPECT_EQ(name_of(unknown), "");
    EXPECT_EQ(world_of(unknown), "");
}

TEST(RequestRules, NameTheRequestAndItsWorld) {
    v1::Request request;
    request.mutable_set_speed()->set_world("meadow");
    EXPECT_EQ(name_of(request), "set_speed");
    EXPECT_EQ(world_of(request), "meadow");
    EXPECT_EQ(kind_of(request), v1::REQUEST_KIND_COMMAND);
    request.mutable_list_worlds();
    EXPECT_EQ(world_of(request), "") << "the request has no field world";
}

} // namespace
} // namespace evod::protocol
