#include "server/network/server_options.h"

#include <gtest/gtest.h>

namespace evod::network {
namespace {

TEST(ServerOptions, BeginWithLiveWorldsOnLoopback) {
    const ServerOptions options;
    const auto* const live = std::get_if<LiveWorlds>(&options.worlds);
    ASSERT_NE(live, nullptr);
    EXPECT_TRUE(live->first_commands.is_empty());
    EXPECT_FALSE(live->storage);
    EXPECT_FALSE(live->processes);
    EXPECT_FALSE(needs_token(options.listeners));
}

TEST(ServerOptions, ReachableAddressesNeedTokens) {
    for (const char* address : {"0.0.0.0", "::", "192.0.2.1"}) {
        EXPECT_TRUE(needs_token({.bind_address = address})) << address;
        EXPECT_TRUE(needs_token({.http = HttpOptions{.bind_address = address}})) << address;
    }
    for (const char* address : {"127.0.0.1", "127.0.0.2", "::1"}) {
        EXPECT_FALSE(needs_token({.bind_address = address})) << address;
        EXPECT_FALSE(needs_token({.http = HttpOptions{.bind_address = address}})) << address;
    }
}

TEST(ServerOptions, ProxiesAndTheUserMayRequireTokens) {
    EXPECT_TRUE(needs_token({.http = HttpOptions{.host_names = {"lab.example"}}}));
    EXPECT_TRUE(needs_token({.token_needed = true}));
}

} // namespace
} // namespace evod::network
