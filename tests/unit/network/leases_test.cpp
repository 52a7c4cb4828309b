#include "server/network/leases.h"

#include <gtest/gtest.h>

namespace evod::network {
namespace {

TEST(Leases, AreRenewedOnlyByTheirHolder) {
    boost::asio::io_context context;
    Leases leases{context, [](const std::string&, std::uint64_t) { ADD_FAILURE() << "a lease has expired"; }};
    EXPECT_FALSE(leases.renew("w", UserKey{"anna", "key"}));
    leases.begin("w", 1, UserKey{"anna", "key"});
    EXPECT_TRUE(leases.renew("w", UserKey{"anna", "key"}));
    EXPECT_FALSE(leases.renew("w", UserKey{"karl", "key"}));
    EXPECT_FALSE(leases.renew("w", UserKey{"anna", "another key"}));
    EXPECT_FALSE(leases.renew("another", UserKey{"anna", "key"}));
    leases.begin("w", 2, UserKey{"karl", "key"}); // takes the place of the first
    EXPECT_FALSE(leases.renew("w", UserKey{"anna", "key"}));
    EXPECT_TRUE(leases.renew("w", UserKey{"karl", "key"}));
    context.poll(); // timers that were moved have not expired
    leases.end("w");
    EXPECT_FALSE(leases.renew("w", UserKey{"karl", "key"}));
    context.poll();
}

TEST(Leases, OfTheServerBeforeHaveNoHolder) {
    boost::asio::io_context context;
    Leases leases{context, [](const std::string&, std::uint64_t) {}};
    leases.begin("w", 0, {});
    EXPECT_FALSE(leases.renew("w", UserKey{"", ""}));
    leases.end_all();
}

TEST(Leases, NoneIsLeftAtTheEnd) {
    boost::asio::io_context context;
    Leases leases{context, [](const std::string&, std::uint64_t) {}};
    leases.begin("a", 1, UserKey{"anna", "key"});
    leases.begin("b", 1, UserKey{"anna", "key"});
    leases.end_all();
    EXPECT_FALSE(leases.renew("a", UserKey{"anna", "key"}));
    EXPECT_FALSE(leases.renew("b", UserKey{"anna", "key"}));
    context.run(); // no timer is left to wait for
}

} // namespace
} // namespace evod::network
