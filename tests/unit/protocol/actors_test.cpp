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

TEST(Actors, TextIsSplitIntoItsParts) {
    EXPECT_EQ(parts(actor_of("karl: evoctl 127.0.0.1:5000")), "1|karl|evoctl|127.0.0.1:5000");
    EXPECT_EQ(parts(actor_of("evoctl 127.0.0.1:5000")), "1||evoctl|127.0.0.1:5000");
    EXPECT_EQ(parts(actor_of("karl: my own client [::1]:5000")), "1|karl|my own client|[::1]:5000");
    EXPECT_EQ(parts(actor_of("evod")), "4|||");
    EXPECT_EQ(parts(actor_of("evod 127.0.0.1:5000")), "1||evod|127.0.0.1:5000") << "a client may use this name";
}

TEST(Actors, AViewerSeesOnlyUsersAtAnyDepth) {
    v1::Event event;
    auto& cancelled = *event.mutable_change_cancelled();
    *cancelled.mutable_by() = actor_of("karl: evoctl 127.0.0.1:5000");
    *cancelled.mutable_change()->mutable_by() = actor_of("evoctl 127.0.0.1:5001");
    keep_users_only(event);
    EXPECT_EQ(parts(cancelled.by()), "1|karl||");
    EXPECT_EQ(parts(cancelled.change().by()), "1|||");
}

} // namespace
} // namespace evod::protocol
