#include "server/protocol/actors.h"

#include "evod/v1/stream.pb.h"

#include <gtest/gtest.h>

#include <string>

namespace evod::protocol {
namespace {

/// "kind|user|client|address"
std::string parts(const v1::Actor& actor) {
    return std::to_string(actor.kind()) + "|" + actor.user() + "|" + actor.client() + "|" + actor.address();
}

TEST(Actors, PartsStayApart) {
    EXPECT_EQ(parts(to_proto(base::client_actor("karl", "evoctl", "127.0.0.1:5000"))), "1|karl|evoctl|127.0.0.1:5000");
    EXPECT_EQ(parts(to_proto(base::client_actor("", "ada:", "127.0.0.1:5000"))), "1||ada:|127.0.0.1:5000");
    EXPECT_EQ(parts(to_proto(base::client_actor("", "a: b", "::1:5000"))), "1||a: b|::1:5000");
    EXPECT_EQ(parts(to_proto(base::client_actor("karl", "evod", "127.0.0.1:5000"))), "1|karl|evod|127.0.0.1:5000");
}

TEST(Actors, SomeAreNoClients) {
    EXPECT_EQ(parts(to_proto(base::server_actor())), "4|||");
    EXPECT_EQ(to_proto(base::Actor{}).kind(), v1::ACTOR_KIND_SCHEDULE);
}

TEST(Actors, AViewerSeesOnlyUsersAtAnyDepth) {
    v1::Event event;
    auto& cancelled = *event.mutable_change_cancelled();
    *cancelled.mutable_by() = to_proto(base::client_actor("karl", "evoctl", "127.0.0.1:5000"));
    *cancelled.mutable_change()->mutable_by() = to_proto(base::client_actor("", "evoctl", "127.0.0.1:5001"));
    keep_users_only(event);
    EXPECT_EQ(parts(cancelled.by()), "1|karl||");
    EXPECT_EQ(parts(cancelled.change().by()), "1|||");
}

} // namespace
} // namespace evod::protocol
