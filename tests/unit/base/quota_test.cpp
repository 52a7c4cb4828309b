#include "server/base/quota.h"

#include <gtest/gtest.h>

#include <string>

namespace evod::base {
namespace {

using Verdict = Quota::Verdict;

TEST(Quota, AUserGetsHalfAlthoughTheRestIsFree) {
    Quota quota{8};
    for (int i = 0; i < 4; ++i) {
        ASSERT_EQ(quota.ask("eve"), Verdict::Free);
        quota.take("eve");
    }
    EXPECT_EQ(quota.ask("eve"), Verdict::UserFull);
    EXPECT_EQ(quota.ask("ada"), Verdict::Free);
    EXPECT_EQ(quota.held("eve"), 4u);
    EXPECT_EQ(quota.held(), 4u);
    quota.give_back("eve");
    EXPECT_EQ(quota.ask("eve"), Verdict::Free);
}

TEST(Quota, AnAmountIsGrantedAsAWhole) {
    Quota quota{10};
    EXPECT_EQ(quota.ask("eve", 5), Verdict::Free);
    EXPECT_EQ(quota.ask("eve", 6), Verdict::UserFull);
    quota.take("eve", 3);
    EXPECT_EQ(quota.ask("eve", 2), Verdict::Free);
    EXPECT_EQ(quota.ask("eve", 3), Verdict::UserFull);
}

TEST(Quota, HalfOfAnOddPoolIsRoundedUp) {
    EXPECT_EQ(Quota{1}.share(), 1u);
    EXPECT_EQ(Quota{5}.share(), 3u);
}

TEST(Quota, NothingFreeIsTakenFromTheLargest) {
    Quota quota{8};
    quota.take("eve", 4);
    quota.take("bob", 4);
    EXPECT_EQ(quota.ask("ada"), Verdict::FromLargest);
    EXPECT_EQ(quota.largest(), "bob");
    quota.give_back("bob");
    quota.take("ada");
    EXPECT_EQ(quota.ask("ada"), Verdict::FromLargest);
    EXPECT_EQ(quota.largest(), "eve");
}

TEST(Quota, ATransferNeverMakesTheOtherOneSmaller) {
    Quota quota{6};
    for (const std::string user : {"a", "b", "c"}) {
        quota.take(user, 2);
    }
    EXPECT_EQ(quota.ask("a"), Verdict::PoolFull);
    EXPECT_EQ(quota.ask("d"), Verdict::FromLargest);
    quota.give_back("a");
    quota.take("d");
    EXPECT_EQ(quota.ask("a"), Verdict::PoolFull) << "2 and 1 would become 1 and 2, and so on without end";
}

TEST(Quota, WhoHoldsNothingIsForgotten) {
    Quota quota{4};
    EXPECT_EQ(quota.largest(), "");
    quota.take("eve", 2);
    quota.give_back("eve", 2);
    EXPECT_EQ(quota.largest(), "");
    quota.take("eve", 2);
    quota.give_back_all();
    EXPECT_EQ(quota.held(), 0u);
    EXPECT_EQ(quota.ask("eve", 2), Verdict::Free);
}

} // namespace
} // namespace evod::base
