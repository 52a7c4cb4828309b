#include "server/base/fair_queue.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace evod::base {
namespace {

const auto any = [](const std::string& /*user*/, const std::string& /*item*/) { return true; };

std::vector<std::string> take_all(FairQueue<std::string>& queue) {
    std::vector<std::string> taken;
    while (auto item = queue.take(any)) {
        taken.push_back(*item);
    }
    return taken;
}

TEST(FairQueue, ServesUsersInTurn) {
    FairQueue<std::string> queue;
    for (const char* item : {"eve 1", "eve 2", "eve 3", "eve 4"}) {
        queue.add("eve", item);
    }
    queue.add("ada", "ada 1");
    queue.add("ada", "ada 2");
    queue.add("bob", "bob 1");
    EXPECT_EQ(queue.size(), 7u);
    EXPECT_EQ(queue.count("eve"), 4u);
    EXPECT_EQ(take_all(queue),
              (std::vector<std::string>{"eve 1", "ada 1", "bob 1", "eve 2", "ada 2", "eve 3", "eve 4"}));
    EXPECT_EQ(queue.size(), 0u);
    EXPECT_EQ(queue.count("eve"), 0u);
}

TEST(FairQueue, AUserWhoComesBackDoesNotPassOthers) {
    FairQueue<std::string> queue;
    queue.add("eve", "eve");
    queue.add("bob", "bob 1");
    queue.add("bob", "bob 2");
    std::vector<std::string> taken;
    for (int i = 0; i < 4; ++i) {
        taken.push_back(*queue.take(any));
        if (taken.back() == "eve") {
            queue.add("eve", "eve"); // always one item
        }
    }
    EXPECT_EQ(taken, (std::vector<std::string>{"eve", "bob 1", "eve", "bob 2"}));
}

TEST(FairQueue, ANewUserWaitsForOneItemOfEachOther) {
    FairQueue<std::string> queue;
    for (int i = 0; i < 100; ++i) {
        queue.add("eve", "eve");
    }
    EXPECT_EQ(queue.take(any), "eve");
    queue.add("ada", "ada");
    EXPECT_EQ(queue.take(any), "ada");
    EXPECT_EQ(queue.take(any), "eve");
}

TEST(FairQueue, TakesWhatMayBeTaken) {
    FairQueue<std::string> queue;
    queue.add("eve", "a");
    queue.add("ada", "b");
    queue.add("eve", "c");
    const auto is_c = [](const std::string& user, const std::string& item) { return user == "eve" && item == "c"; };
    EXPECT_TRUE(queue.has(is_c));
    EXPECT_EQ(queue.take(is_c), "c");
    EXPECT_FALSE(queue.has(is_c));
    EXPECT_EQ(queue.take(is_c), std::nullopt);
    queue.remove_if([](const std::string& item) { return item == "a"; });
    EXPECT_EQ(queue.count("eve"), 0u);
    queue.add_first("ada", "0");
    EXPECT_EQ(take_all(queue), (std::vector<std::string>{"0", "b"}));
}

} // namespace
} // namespace evod::base
