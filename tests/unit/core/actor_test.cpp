#include "client/core/actor.h"

#include <gtest/gtest.h>

namespace evod::core {
namespace {

v1::Actor client(const char* user, const char* program, const char* address) {
    v1::Actor actor;
    actor.set_kind(v1::ACTOR_KIND_CLIENT);
    actor.set_user(user);
    actor.set_client(program);
    actor.set_address(address);
    return actor;
}

TEST(Actor, ClientsAreNamedByWhatIsKnown) {
    EXPECT_EQ(to_text(client("karl", "evoctl", "127.0.0.1:5000")), "karl: evoctl 127.0.0.1:5000");
    EXPECT_EQ(to_text(client("", "evoctl", "127.0.0.1:5000")), "evoctl 127.0.0.1:5000");
    EXPECT_EQ(to_text(client("karl", "", "")), "karl");
    EXPECT_EQ(to_text(client("", "", "")), "a local client");
}

TEST(Actor, OthersAreNamedByTheirKind) {
    v1::Actor actor;
    for (const auto& [kind, text] : {std::pair{v1::ACTOR_KIND_SCHEDULE, "the schedule"},
                                     {v1::ACTOR_KIND_GOAL, "a goal"},
                                     {v1::ACTOR_KIND_SERVER, "evod"}}) {
        actor.set_kind(kind);
        EXPECT_EQ(to_text(actor), text);
    }
}

} // namespace
} // namespace evod::core
