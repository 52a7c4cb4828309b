#include "server/network/leases.h"

#include <gtest/gtest.h>

namespace evod::network {
namespace {

TEST(Leases, AreRenewedOnlyByTheirHolder) {
    boost::asio::io_context context;
    Leases leases{context, [](const std::string&, std::uint64_t) { ADD_FAILURE() << "a lease has expired"; }};
    EXPECT_FALSE(leases.renew("w", "anna"));
    leases.begin("w", 1, "anna");
    EXPECT_TRUE(leases.renew("w", "anna"));
    EXPECT_FALSE(leases.renew("w", "karl"));
    EXPECT_FALSE(leases.renew("another", "anna"));
    leases.begin("w", 2, "karl"); // takes the place of the first
    EXPECT_FALSE(leases.renew("w", "anna"));
    EXPECT_TRUE(leases.renew("w", "karl"));
    context.poll(); // timers that were moved have not expired
    leases.end("w");
    EXPECT_FALSE(leases.renew("w", "karl"));
    context.poll();
}

TEST(Leases, NoneIsLeftAtTheEnd) {
    boost::asio::io_context context;
    Leases leases{context, [](const std::string&, std::uint64_t) {}};
    leases.begin("a", 1, "anna");
    leases.begin("b", 1, "anna");
    leases.end_all();
    EXPECT_FALSE(leases.renew("a", "anna"));
    EXPECT_FALSE(leases.renew("b", "anna"));
    context.run(); // no timer is left to wait for
}

} // namespace
} // namespace evod::network
