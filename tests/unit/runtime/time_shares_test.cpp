#include "server/runtime/time_shares.h"

#include <gtest/gtest.h>

#include <map>
#include <vector>

namespace evod::runtime {
namespace {

using namespace std::chrono_literals;

/// Serves the user with the least time of those who want some.
std::string serve_next(TimeShares& shares, const std::vector<std::string>& wanting) {
    const std::string next =
        *std::ranges::min_element(wanting, {}, [&](const auto& user) { return shares.spent(user); });
    shares.serve(next);
    return next;
}

TEST(TimeShares, UsersGetEqualTimeWhateverTheirSlicesTake) {
    TimeShares shares;
    std::map<std::string, Clock::duration> got;
    const std::map<std::string, Clock::duration> slice{{"ada", 1ms}, {"bob", 5ms}, {"eve", 20ms}};
    for (int i = 0; i < 1000; ++i) {
        const std::string user = serve_next(shares, {"ada", "bob", "eve"});
        shares.spend(user, slice.at(user));
        got[user] += slice.at(user);
    }
    EXPECT_LE(std::chrono::abs(got["ada"] - got["eve"]), 20ms);
    EXPECT_LE(std::chrono::abs(got["bob"] - got["eve"]), 20ms);
}

TEST(TimeShares, AUserWhoWantedNothingHasNotSavedTime) {
    TimeShares shares;
    for (int i = 0; i < 1000; ++i) {
        shares.spend(serve_next(shares, {"ada"}), 5ms);
    }
    int served = 0;
    for (int i = 0; i < 100; ++i) {
        const std::string user = serve_next(shares, {"ada", "bob"});
        shares.spend(user, 5ms);
        served += user == "bob" ? 1 : 0;
    }
    EXPECT_NEAR(served, 50, 1);
}

TEST(TimeShares, TimeOutsideOfSlicesCountsToo) {
    TimeShares shares;
    shares.spend("eve", 100ms);
    for (int i = 0; i < 20; ++i) {
        EXPECT_EQ(serve_next(shares, {"ada", "eve"}), "ada");
        shares.spend("ada", 5ms);
    }
    shares.spend("ada", 5ms);
    EXPECT_EQ(serve_next(shares, {"ada", "eve"}), "eve");
}

} // namespace
} // namespace evod::runtime
