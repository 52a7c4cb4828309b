#include "server/network/replay_places.h"

#include <gtest/gtest.h>

namespace evod::network {
namespace {

class ReplayPlacesTest : public testing::Test {
  protected:
    auto take(std::uint64_t session, std::uint64_t request_id, const std::string& account) {
        return places.take({.session = session, .request_id = request_id, .account = account});
    }

    ReplayPlaces places{4};
};

TEST_F(ReplayPlacesTest, AUserHasAtMostHalf) {
    EXPECT_TRUE(take(1, 1, "eve"));
    EXPECT_TRUE(take(2, 1, "eve"));
    const auto refused = take(3, 1, "eve");
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, base::RefusalCode::ResourceExhausted);
    EXPECT_EQ(refused.error().reason, base::Reason::ReplaysMax);
    EXPECT_TRUE(take(4, 1, "ada"));
}

TEST_F(ReplayPlacesTest, TheUserWithTheMostLosesTheOldest) {
    ASSERT_TRUE(take(1, 1, "eve"));
    ASSERT_TRUE(take(1, 2, "eve"));
    ASSERT_TRUE(take(2, 1, "bob"));
    ASSERT_TRUE(places.open(2, 1, "w@1"));
    ASSERT_TRUE(take(2, 2, "bob"));
    const auto lost = take(3, 1, "ada");
    ASSERT_TRUE(lost && *lost);
    EXPECT_EQ((*lost)->name, "w@1") << "of equal users the first by name";
    EXPECT_EQ((*lost)->session, 2u);
    const auto next = take(4, 1, "cat");
    ASSERT_TRUE(next && *next);
    EXPECT_EQ((*next)->session, 1u);
    EXPECT_EQ((*next)->request_id, 1u);
    EXPECT_FALSE(places.open(1, 1, "w@2")) << "it has lost its place while it was being opened";
    EXPECT_FALSE(take(5, 1, "dan")) << "all have one each";
}

TEST_F(ReplayPlacesTest, PlacesComeBack) {
    ASSERT_TRUE(take(1, 1, "eve"));
    places.give_back(1, 1);
    places.give_back(1, 1);
    EXPECT_EQ(places.quota().held(), 0u);
    ASSERT_TRUE(take(1, 2, "eve"));
    ASSERT_TRUE(places.open(1, 2, "w@1"));
    places.give_back(1, 2);
    EXPECT_EQ(places.quota().held(), 1u) << "the request was answered already";
    places.close("w@1");
    EXPECT_EQ(places.quota().held(), 0u);
    ASSERT_TRUE(take(1, 3, "eve"));
    ASSERT_TRUE(take(2, 3, "eve"));
    places.forget(1);
    EXPECT_EQ(places.quota().held("eve"), 1u);
}

} // namespace
} // namespace evod::network
