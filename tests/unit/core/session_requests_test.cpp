#include "client/core/session_requests.h"

#include <gtest/gtest.h>

namespace evod::core {
namespace {

TEST(SessionRequests, NameReplaysByAnAtSign) {
    v1::Request request;
    EXPECT_EQ(replay_in(request), "") << "a request of no kind";
    request.mutable_list_worlds();
    EXPECT_EQ(replay_in(request), "") << "it names no world";
    request.mutable_pause()->set_world("default");
    EXPECT_EQ(replay_in(request), "");
    EXPECT_FALSE(ends_with_session(request));
    request.mutable_pause()->set_world("default@3");
    EXPECT_EQ(replay_in(request), "default@3");
    EXPECT_TRUE(ends_with_session(request));
    request.mutable_subscribe_snapshots()->set_world("default@3");
    EXPECT_TRUE(ends_with_session(request));
}

TEST(SessionRequests, ContainIdsOfTheirSession) {
    v1::Request request;
    request.mutable_unsubscribe();
    EXPECT_TRUE(ends_with_session(request));
    request.mutable_continue_export();
    EXPECT_TRUE(ends_with_session(request));
    request.mutable_open_replay()->set_world("default");
    EXPECT_FALSE(ends_with_session(request));
}

TEST(SessionRequests, OfAnEndedReplayAreRefused) {
    const v1::Status status = replay_has_ended("default@3");
    EXPECT_EQ(status.code(), v1::CODE_NOT_FOUND);
    EXPECT_EQ(status.message(), "the replay default@3 has ended with its session");
}

} // namespace
} // namespace evod::core
