#include "server/network/reply_cache.h"

#include <gtest/gtest.h>

#include <map>
#include <optional>
#include <random>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace evod::network {
namespace {

using Verdict = ReplyCache::Verdict;

SharedBytes bytes(std::string text) {
    return std::make_shared<const std::string>(std::move(text));
}

class ReplyCacheTest : public testing::Test {
  protected:
    // A user can use half of each of these.
    static constexpr ReplyCache::Bounds bounds{.kept_per_key = 3, .keys_max = 4, .bytes_max = 4000, .evicted_max = 6};

    Verdict begin(const UserKey& key, std::uint64_t id, const std::string& request = "request") {
        return cache.begin(key, key.user, id, request, [this](const SharedBytes& answer) { heard.push_back(*answer); });
    }
    Verdict begin(const std::string& key, std::uint64_t id, const std::string& request = "request") {
        return begin(UserKey{"ada", key}, id, request);
    }
    void finish(const std::string& key, std::uint64_t id, std::string answer) {
        cache.finish(UserKey{"ada", key}, id, bytes(std::move(answer)));
    }
    /// Begins and finishes a command.
    void run(const UserKey& key, std::uint64_t id, std::string answer = "answer") {
        ASSERT_EQ(begin(key, id), Verdict::New);
        cache.finish(key, id, bytes(std::move(answer)));
        heard.clear();
    }
    void run(const std::string& key, std::uint64_t id, std::string answer = "answer") {
        run(UserKey{"ada", key}, id, std::move(answer));
    }

    ReplyCache cache{bounds};
    std::vector<std::string> heard;
};

TEST_F(ReplyCacheTest, ARepeatedCommandIsAnsweredButRunOnce) {
    EXPECT_EQ(begin("k", 1), Verdict::New);
    EXPECT_EQ(begin("k", 1), Verdict::Known) << "while it is pending";
    EXPECT_TRUE(heard.empty());
    finish("k", 1, "done");
    EXPECT_EQ(heard, (std::vector<std::string>{"done", "done"}));
    EXPECT_EQ(begin("k", 1), Verdict::Known);
    EXPECT_EQ(heard.size(), 3);
}

TEST_F(ReplyCacheTest, KeysAreIndependent) {
    run("a", 1, "for a");
    EXPECT_EQ(begin("b", 1), Verdict::New);
    finish("b", 1, "for b");
    begin("a", 1);
    EXPECT_EQ(heard, (std::vector<std::string>{"for b", "for a"}));
}

TEST_F(ReplyCacheTest, AnIdBelongsToOneRequest) {
    EXPECT_EQ(begin("k", 1, "one"), Verdict::New);
    EXPECT_EQ(begin("k", 1, "two"), Verdict::Different) << "while it is pending";
    finish("k", 1, "done");
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
    finish("k", 1, "at last");
    EXPECT_EQ(heard, (std::vector<std::string>{"at last", "at last"}));
}

TEST_F(ReplyCacheTest, AForgottenCommandMayBeSentAgain) {
    EXPECT_EQ(begin("k", 1), Verdict::New);
    cache.forget({"ada", "k"}, 1, bytes("busy"));
    EXPECT_EQ(heard, (std::vector<std::string>{"busy"}));
    EXPECT_EQ(cache.key_count(), 0u) << "nothing needs to be remembered";
    EXPECT_EQ(cache.evicted_count(), 0u);
    EXPECT_EQ(begin("k", 1), Verdict::New);
}

TEST_F(ReplyCacheTest, AnAnswerWithoutItsCommandIsAFault) {
    EXPECT_DEATH(finish("k", 1, "done"), "");
    EXPECT_DEATH(cache.forget({"ada", "k"}, 1, bytes("busy")), "");
    run("k", 1);
    EXPECT_DEATH(finish("k", 1, "again"), "");
    EXPECT_DEATH(finish("k", 2, "done"), "");
    EXPECT_DEATH(cache.finish({"bob", "k"}, 1, bytes("done")), "");
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

TEST_F(ReplyCacheTest, AKeyThatIsEvictedAgainIsTheNewestOne) {
    for (const char* key : {"a", "b", "c", "d", "e"}) {
        run(key, 7); // remembers a, b and c
    }
    run("a", 8); // evicts d
    run("f", 1); // evicts e
    run("g", 1); // evicts a, again
    run("h", 1); // evicts f
    EXPECT_EQ(begin("a", 8), Verdict::TooOld) << "d was evicted before it";
    EXPECT_EQ(begin("d", 7), Verdict::New);
}

TEST_F(ReplyCacheTest, ACommandThatIsTooOldKeepsItsKeyRemembered) {
    for (const char* key : {"a", "b", "c", "d", "e"}) {
        run(key, 7); // remembers a, b and c
    }
    EXPECT_EQ(begin("a", 7), Verdict::TooOld);
    EXPECT_EQ(cache.key_count(), 2u) << "and evicts no other key";
    run("f", 1);
    run("g", 1);
    EXPECT_EQ(begin("a", 7), Verdict::TooOld);
    EXPECT_EQ(begin("b", 7), Verdict::New);
}

TEST_F(ReplyCacheTest, KeepsUsersApart) {
    run(UserKey{"ada", "k"}, 1);
    EXPECT_EQ(begin(UserKey{"bob", "k"}, 1), Verdict::New);
    EXPECT_EQ(begin(UserKey{"", "adak"}, 1), Verdict::New);
    EXPECT_EQ(begin(UserKey{"adak", ""}, 1), Verdict::New);
}

TEST_F(ReplyCacheTest, AUserEvictsNoAnswerOfAnother) {
    run(UserKey{"ada", "k"}, 1, "for ada");
    for (int i = 0; i < 100; ++i) {
        run(UserKey{"eve", std::to_string(i)}, 1, std::string(500, 'e'));
    }
    EXPECT_EQ(begin(UserKey{"ada", "k"}, 1), Verdict::Known);
    EXPECT_EQ(heard, std::vector<std::string>{"for ada"});
    EXPECT_LE(cache.key_count(), 3u);
}

TEST_F(ReplyCacheTest, AUserForgetsNoEvictedKeyOfAnother) {
    for (const char* key : {"a", "b", "c"}) {
        run(UserKey{"ada", key}, 7); // remembers a
    }
    for (int i = 0; i < 100; ++i) {
        run(UserKey{"eve", std::to_string(i)}, 1);
    }
    EXPECT_EQ(begin(UserKey{"ada", "a"}, 7), Verdict::TooOld);
    EXPECT_EQ(begin(UserKey{"ada", "b"}, 7), Verdict::Known);
    EXPECT_EQ(begin(UserKey{"ada", "c"}, 7), Verdict::Known);
    EXPECT_LE(cache.evicted_count(), 4u);
}

TEST_F(ReplyCacheTest, AFullPoolEvictsFromTheUserWithTheMost) {
    for (const char* user : {"ada", "bob"}) {
        run(UserKey{user, "1"}, 1);
        run(UserKey{user, "2"}, 1);
    }
    run(UserKey{"eve", "1"}, 1); // ada, the first of the largest, loses a key
    run(UserKey{"eve", "2"}, 1); // bob loses a key
    EXPECT_EQ(cache.key_count(), 4u);
    EXPECT_EQ(begin(UserKey{"ada", "2"}, 1), Verdict::Known);
    EXPECT_EQ(begin(UserKey{"bob", "2"}, 1), Verdict::Known);
    EXPECT_EQ(begin(UserKey{"ada", "1"}, 1), Verdict::TooOld);
    run(UserKey{"eve", "3"}, 1); // eve has the most
    EXPECT_EQ(begin(UserKey{"ada", "2"}, 1), Verdict::Known);
    EXPECT_EQ(begin(UserKey{"bob", "2"}, 1), Verdict::Known);
}

TEST_F(ReplyCacheTest, AKeyFollowsItsAccount) {
    const auto begin_at = [&](const char* address, const char* key) {
        return cache.begin({"", key}, address, 1, "request", [](const SharedBytes&) {});
    };
    EXPECT_EQ(begin_at("10.0.0.1", "k"), Verdict::New);
    cache.finish({"", "k"}, 1, bytes("done"));
    EXPECT_EQ(begin_at("10.0.0.2", "k"), Verdict::Known) << "the client has another address now";
    for (const char* key : {"a", "b", "c"}) {
        EXPECT_EQ(begin_at("10.0.0.1", key), Verdict::New);
        cache.finish({"", key}, 1, bytes("done"));
    }
    EXPECT_EQ(begin_at("10.0.0.2", "k"), Verdict::Known);
}

TEST_F(ReplyCacheTest, AKeyWithAPendingCommandIsNotEvicted) {
    EXPECT_EQ(begin("a", 1), Verdict::New);
    run("b", 1);
    run("c", 1);
    EXPECT_EQ(begin("a", 1), Verdict::Known);
}

TEST_F(ReplyCacheTest, PendingCommandsOfOthersEvictNothing) {
    run(UserKey{"ada", "k"}, 1);
    for (int i = 0; i < 100; ++i) {
        EXPECT_EQ(begin(UserKey{"eve", std::to_string(i)}, 1), Verdict::New);
    }
    run(UserKey{"ada", "l"}, 1);
    EXPECT_EQ(begin(UserKey{"ada", "k"}, 1), Verdict::Known);
    for (int i = 0; i < 100; ++i) {
        cache.finish({"eve", std::to_string(i)}, 1, bytes("done"));
    }
    EXPECT_EQ(cache.key_count(), 4u);
    EXPECT_EQ(begin(UserKey{"ada", "k"}, 1), Verdict::Known);
}

TEST_F(ReplyCacheTest, LongAnswersEvictOtherKeysFirst) {
    run("a", 1, std::string(1200, 'a'));
    run("b", 1, std::string(1200, 'b'));
    EXPECT_EQ(cache.key_count(), 1);
    EXPECT_EQ(begin("b", 1), Verdict::Known);
    for (std::uint64_t id = 2; id <= 10; ++id) {
        run("b", id, std::string(800, 'b'));
    }
    EXPECT_EQ(cache.key_count(), 1);
    EXPECT_LE(cache.answer_bytes(), 2000u) << "then the oldest answers of the key";
    EXPECT_EQ(begin("b", 8), Verdict::TooOld);
    EXPECT_EQ(begin("b", 9), Verdict::Known);
    run("b", 11, std::string(5000, 'b'));
    EXPECT_EQ(begin("b", 11), Verdict::TooOld) << "too long to be cached";
    EXPECT_EQ(cache.answer_bytes(), 0u);
}

TEST_F(ReplyCacheTest, RestoredKeysAreNotRunAgain) {
    cache.restore_evicted({"ada", "a"}, "ada", 2000);
    cache.restore_evicted({"ada", "b"}, "ada", 5);
    cache.restore_evicted({"ada", "b"}, "ada", 4);
    cache.restore({"ada", "a"}, "ada", 1999, "request", bytes("answer")); // from another run, whose answers are known
    EXPECT_EQ(begin("a", 1999), Verdict::Known);
    EXPECT_EQ(begin("a", 2000), Verdict::TooOld);
    EXPECT_EQ(begin("a", 2001), Verdict::New);
    cache.restore_evicted({"ada", "a"}, "ada", 3000);
    EXPECT_EQ(begin("a", 3000), Verdict::TooOld);
    EXPECT_EQ(begin("b", 5), Verdict::TooOld);
    EXPECT_EQ(begin("b", 6), Verdict::New);
}

/// What a journal contains, and the clients that send commands and repeat them at any time.
class RandomUse {
  public:
    explicit RandomUse(std::uint32_t seed)
        : random_{seed}
        , user_count_{any(1, 4)}
        , hostile_count_{any(0, user_count_ - 1)}
        , bounds_{.kept_per_key = any(1, 4),
                  .keys_max = any(1, 12),
                  .bytes_max = any(200, 4000),
                  .evicted_max = user_count_ * honest_keys * 2} {
        restart();
    }

    void run(int steps) {
        for (int i = 0; i < steps && !testing::Test::HasFailure(); ++i) {
            switch (any(0, 19)) {
            case 0:
                restart();
                break;
            case 1:
            case 2:
            case 3:
                answer_pending();
                break;
            default:
                send();
            }
        }
    }

  private:
    using Id = std::tuple<std::string, std::string, std::uint64_t>; // user, key, id
    struct Entry {
        Id id;
        std::string answer;
    };
    static constexpr std::size_t honest_keys = 3;

    std::size_t any(std::size_t least, std::size_t most) {
        return std::uniform_int_distribution<std::size_t>{least, most}(random_);
    }

    void send() {
        const std::size_t user = any(0, user_count_ - 1);
        const bool hostile = user < hostile_count_;
        const std::string name = "user " + std::to_string(user),
                          key = std::to_string(any(1, hostile ? 200 : honest_keys));
        std::uint64_t& highest = highest_[{name, key}];
        const bool is_fresh = any(0, 1) == 0;
        const std::uint64_t id = is_fresh ? highest + any(1, 3) : any(1, std::max<std::size_t>(highest, 1));
        const Id sent{name, key, id};
        const bool was_new = id > highest;
        const Verdict verdict = cache_->begin({name, key}, name, id, "request", [](const SharedBytes&) {});
        if (was_new) {
            highest = id;
            EXPECT_EQ(verdict, Verdict::New) << "a fresh command is not refused";
        }
        if (verdict != Verdict::New) {
            return;
        }
        if (!hostile) {
            EXPECT_FALSE(applied_.contains(sent)) << name << ' ' << key << ' ' << id << " is applied twice";
        }
        pending_.push_back(sent);
        if (any(0, 2) != 0) {
            answer_pending();
        }
    }

    void answer_pending() {
        if (pending_.empty()) {
            return;
        }
        const auto at = pending_.begin() + static_cast<std::ptrdiff_t>(any(0, pending_.size() - 1));
        const auto [user, key, id] = *at;
        const std::string answer(any(0, 400), 'a');
        if (any(0, 9) == 0) {
            cache_->forget({user, key}, id, bytes("busy"));
        } else {
            applied_.insert(*at);
            journal_.push_back({*at, answer});
            cache_->finish({user, key}, id, bytes(answer));
        }
        pending_.erase(at);
        EXPECT_LE(cache_->answer_bytes(), bounds_.bytes_max);
        EXPECT_LE(cache_->evicted_count(), bounds_.evicted_max);
        EXPECT_LE(cache_->key_count(), bounds_.keys_max + pending_.size());
    }

    /// As a server does: the older part of the journal gives keys, the newer part answers.
    void restart() {
        cache_.emplace(bounds_);
        pending_.clear(); // they were not applied
        const std::size_t first_answer = any(0, journal_.size());
        std::map<std::pair<std::string, std::string>, std::pair<std::size_t, std::uint64_t>>
            used; // last use, highest id
        for (std::size_t i = 0; i < first_answer; ++i) {
            const auto& [user, key, id] = journal_[i].id;
            auto& known = used[{user, key}];
            known = {i, std::max(known.second, id)};
        }
        std::map<std::size_t, std::pair<UserKey, std::uint64_t>> in_order;
        for (const auto& [key, last] : used) {
            in_order[last.first] = {UserKey{key.first, key.second}, last.second};
        }
        for (const auto& [place, key] : in_order) {
            cache_->restore_evicted(key.first, key.first.user, key.second);
        }
        for (std::size_t i = first_answer; i < journal_.size(); ++i) {
            const auto& [user, key, id] = journal_[i].id;
            cache_->restore({user, key}, user, id, "request", bytes(journal_[i].answer));
        }
    }

    std::mt19937 random_;
    const std::size_t user_count_, hostile_count_; // hostile users use any number of keys, the others honest_keys
    const ReplyCache::Bounds bounds_;
    std::optional<ReplyCache> cache_;
    std::map<std::pair<std::string, std::string>, std::uint64_t> highest_; // sent by each key
    std::vector<Id> pending_;
    std::vector<Entry> journal_;
    std::set<Id> applied_;
};

TEST(AtMostOnce, HoldsForAnyJournalBoundsAndRestarts) {
    for (std::uint32_t seed = 1; seed <= 100 && !testing::Test::HasFailure(); ++seed) {
        SCOPED_TRACE(seed);
        RandomUse{seed}.run(500);
    }
}

} // namespace
} // namespace evod::network
