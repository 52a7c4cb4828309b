#include "server/network/reply_cache.h"

#include <gtest/gtest.h>

namespace evod::network {
namespace {

using Verdict = ReplyCache::Verdict;

SharedBytes bytes(std::string text) {
    return std::make_shared<const std::string>(std::move(text));
}

class ReplyCacheTest : public testing::Test {
  protected:
    Verdict begin(std::string key, std::uint64_t id, std::string request = "request") {
        return cache.begin(key, id, request, [this](const SharedBytes& answer) { heard.push_back(*answer); });
    }
    /// Begins and finishes a command.
    void run(std::string key, std::uint64_t id, std::string answer = "answer") {
        ASSERT_EQ(begin(key, id), Verdict::New);
        cache.finish(key, id, bytes(std::move(answer)));
        heard.clear();
    }

    ReplyCache cache{{.kept_per_key = 3, .keys_max = 2, .bytes_max = 1000, .evicted_max = 3}};
    std::vector<std::string> heard;
};

TEST_F(ReplyCacheTest, ARepeatedCommandIsAnsweredButRunOnce) {
    EXPECT_EQ(begin("k", 1), Verdict::New);
    EXPECT_EQ(begin("k", 1), Verdict::Known) << "while it is pending";
    EXPECT_TRUE(heard.empty());
    cache.finish("k", 1, bytes("done"));
    EXPECT_EQ(heard, (std::vector<std::string>{"done", "done"}));
    EXPECT_EQ(begin("k", 1), Verdict::Known);
    EXPECT_EQ(heard.size(), 3);
}

TEST_F(ReplyCacheTest, KeysAreIndependent) {
    run("a", 1, "for a");
    EXPECT_EQ(begin("b", 1), Verdict::New);
    cache.finish("b", 1, bytes("for b"));
    begin("a", 1);
    EXPECT_EQ(heard, (std::vector<std::string>{"for b", "for a"}));
}

TEST_F(ReplyCacheTest, AnIdBelongsToOneRequest) {
    EXPECT_EQ(begin("k", 1, "one"), Verdict::New);
    EXPECT_EQ(begin("k", 1, "two"), Verdict::Different) << "while it is pending";
    cache.finish("k", 1, bytes("done"));
    EXPECT_EQ(begin("k", 1, "two"), Verdict::Different);
    EXPECT_EQ(begin("k", 1, std::string("one\0", 4)), Verdict::Different);
    EXPECT_EQ(heard.size(), 1);
}

TEST_F(ReplyCacheTest, ACommandOlderThanTheCacheIsNotRunAgain) {
    for (std::uint64_t id = 1; id <= 5; ++id) {
        run("k", id);
    }
    EXPECT_EQ(begin("k", 1), Verdict::TooOld);
    EXPECT_EQ(begin("k", 2), Verdict::TooOld);
    EXPECT_EQ(begin("k", 3), Verdict::Known);
    EXPECT_EQ(begin("k", 5), Verdict::Known);
    EXPECT_EQ(begin("k", 7), Verdict::New) << "ids may be skipped";
    EXPECT_EQ(begin("k", 6), Verdict::New) << "and arrive late, unless newer ones evicted them";
}

TEST_F(ReplyCacheTest, APendingCommandIsKeptHoweverOld) {
    EXPECT_EQ(begin("k", 1), Verdict::New);
    for (std::uint64_t id = 2; id <= 9; ++id) {
        run("k", id);
    }
    EXPECT_EQ(begin("k", 1), Verdict::Known);
    cache.finish("k", 1, bytes("at last"));
    EXPECT_EQ(heard, (std::vector<std::string>{"at last", "at last"}));
}

TEST_F(ReplyCacheTest, AForgottenCommandMayBeSentAgain) {
    EXPECT_EQ(begin("k", 1), Verdict::New);
    cache.forget("k", 1, bytes("busy"));
    EXPECT_EQ(heard, (std::vector<std::string>{"busy"}));
    EXPECT_EQ(begin("k", 1), Verdict::New);
}

TEST_F(ReplyCacheTest, EvictsTheLeastRecentlyUsedKey) {
    run("a", 1);
    run("b", 1);
    begin("a", 1); // no longer a key with a single command
    run("c", 1);
    EXPECT_EQ(cache.key_count(), 2);
    EXPECT_EQ(begin("a", 1), Verdict::Known);
    EXPECT_EQ(begin("b", 1), Verdict::TooOld) << "its answer is evicted, and it is not run again";
    EXPECT_EQ(begin("b", 2), Verdict::New);
}

TEST_F(ReplyCacheTest, EvictsKeysWithASingleCommandFirst) {
    run("steady", 1);
    run("steady", 2);
    for (int i = 0; i < 20; ++i) {
        run("one-shot " + std::to_string(i), 1);
    }
    EXPECT_EQ(begin("steady", 1), Verdict::Known);
    EXPECT_EQ(begin("steady", 2), Verdict::Known);
}

TEST_F(ReplyCacheTest, RemembersTheHighestIdsOfSomeEvictedKeys) {
    for (const char* key : {"a", "b", "c", "d", "e", "f"}) {
        run(key, 7); // keeps e and f, and remembers the last three of a to d
    }
    EXPECT_EQ(begin("b", 7), Verdict::TooOld);
    EXPECT_EQ(begin("d", 3), Verdict::TooOld);
    EXPECT_EQ(begin("a", 7), Verdict::New);
}

TEST_F(ReplyCacheTest, KeepsUsersApart) {
    EXPECT_NE(ReplyCache::key_of("ada", "k"), ReplyCache::key_of("bob", "k"));
    EXPECT_NE(ReplyCache::key_of("", "ak"), ReplyCache::key_of("a", "k"));
}

TEST_F(ReplyCacheTest, AKeyWithAPendingCommandIsNotEvicted) {
    EXPECT_EQ(begin("a", 1), Verdict::New);
    run("b", 1);
    run("c", 1);
    EXPECT_EQ(begin("a", 1), Verdict::Known);
}

TEST_F(ReplyCacheTest, LongAnswersEvictOtherKeysButNotTheirOwn) {
    run("a", 1, std::string(600, 'a'));
    run("b", 1, std::string(600, 'b'));
    EXPECT_EQ(cache.key_count(), 1);
    EXPECT_EQ(begin("b", 1), Verdict::Known);
    EXPECT_LE(cache.answer_bytes(), 600);
    for (std::uint64_t id = 2; id <= 10; ++id) {
        run("b", id, std::string(600, 'b'));
    }
    EXPECT_EQ(cache.answer_bytes(), 3 * 600);
}

} // namespace
} // namespace evod::network
