#include "server/base/actor.h"

#include <gtest/gtest.h>

namespace evod::base {
namespace {

TEST(Actor, IsShownInLogs) {
    EXPECT_EQ(to_text(client_actor("anna", "evoview", "127.0.0.1:5000")), "anna: evoview 127.0.0.1:5000");
    EXPECT_EQ(to_text(client_actor("", "evoview", "127.0.0.1:5000")), "evoview 127.0.0.1:5000");
    EXPECT_EQ(to_text(server_actor()), "evod");
    EXPECT_EQ(to_text(Actor{}), "the schedule");
}

TEST(Actor, APartBelongsToOneField) {
    const Actor named = client_actor("", "anna: evoview", "127.0.0.1:5000");
    const Actor user = client_actor("anna", "evoview", "127.0.0.1:5000");
    EXPECT_EQ(to_text(named), to_text(user));
    EXPECT_NE(named, user);
    EXPECT_NE(client_actor("", "evod", ""), server_actor());
}

} // namespace
} // namespace evod::base
