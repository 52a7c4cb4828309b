// ReplyCache: caches the answers to commands to make commands idempotent. A repeated command receives the cached answer
// and is not applied again.
//
// A command is identified by (user, client_key, request_id), so commands of different users never collide. The cache
// keeps the newest `kept_per_key` answers of each client_key, for `keys_max` keys and `bytes_max` bytes. It remembers
// the highest request_id of the last `evicted_max` evicted keys. It can therefore refuse a command whose answer it no
// longer has, instead of applying the command again.
//
// Each of these three pools is divided among accounts (base/quota.h). If an account has more than half of a pool, the
// cache evicts keys of this account. If a pool is full, the cache evicts keys of the account that has the most. Of an
// account, it first evicts keys with a single command, then the least recently used keys. Therefore an account never
// loses an answer or a remembered key to an account that has more. A key with a pending command is not evicted and not
// counted; the capacity of the mailbox bounds the number of pending commands.
//
// Owner        the dispatcher, on the network thread.
#pragma once

#include "proto/codec/shared_bytes.h"
#include "server/base/quota.h"
#include "server/base/state_hash.h"
#include "server/network/user_key.h"

#include <cstdint>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

namespace evod::network {

using codec::SharedBytes;

class ReplyCache {
  public:
    struct Bounds {
        std::size_t kept_per_key, keys_max, bytes_max, evicted_max;
    };
    /// The function that receives the answer once it exists.
    using Waiter = std::function<void(const SharedBytes&)>;

    /// key_forgotten  called for each key that the cache evicts.
    explicit ReplyCache(
        Bounds bounds, std::function<void()> key_forgotten = [] {})
        : kept_per_key_{bounds.kept_per_key}
        , key_forgotten_{std::move(key_forgotten)}
        , key_quota_{bounds.keys_max}
        , byte_quota_{bounds.bytes_max}
        , evicted_quota_{bounds.evicted_max} {}

    enum class Verdict {
        New,       // the caller must apply the command, then call finish() or forget(); the cache keeps the waiter
        Known,     // the command is known: the cache has called the waiter, or will call it
        Different, // a different request has used this id; the cache drops the waiter
        TooOld,    // the answer is no longer cached; the cache drops the waiter
    };
    /// Looks up a command. A new command is marked as pending.
    ///
    /// account  whose share of the cache the key uses from now on.
    /// request  the deterministically serialised request, so that equal requests have equal bytes.
    Verdict begin(const UserKey& user_key, const std::string& account, std::uint64_t request_id,
                  std::string_view request, Waiter waiter);

    /// Stores the answer to a pending command and passes the answer to all waiters.
    void finish(const UserKey& user_key, std::uint64_t request_id, const SharedBytes& answer);

    /// Drops a pending command that cannot be applied now, and passes `answer` to all waiters. The client may send the
    /// same command again.
    void forget(const UserKey& user_key, std::uint64_t request_id, const SharedBytes& answer);

    /// Adds a command that was applied before this server started, with its answer.
    void restore(const UserKey& user_key, const std::string& account, std::uint64_t request_id,
                 std::string_view request, const SharedBytes& answer);

    /// Adds a key that was used before this server started. Commands up to `highest_id` whose answers are not restored
    /// are too old.
    void restore_evicted(const UserKey& user_key, const std::string& account, std::uint64_t highest_id);

    const base::Quota& key_quota() const { return key_quota_; }
    std::size_t key_count() const { return keys_.size(); }
    /// The memory of all answers and of their entries in the cache.
    std::size_t answer_bytes() const { return byte_quota_.held(); }
    std::size_t evicted_count() const { return evicted_.size(); }

  private:
    struct HashOfKey {
        std::size_t operator()(const UserKey& key) const;
    };
    struct HashOfHash {
        std::size_t operator()(const base::StateHash& hash) const { return hash.low; }
    };
    struct Key;
    using Keys = std::unordered_map<UserKey, Key, HashOfKey>;
    using KeyList = std::list<Keys::value_type*>;

    struct Command {
        base::StateHash request;
        SharedBytes answer; // nullptr: the command is pending
        std::vector<Waiter> waiters;
    };
    struct Key {
        std::string account;
        std::map<std::uint64_t, Command> commands;
        std::uint64_t forgotten_up_to = 0; // ids up to this one are too old unless `commands` contains them
        std::size_t pending_count = 0;
        bool is_counted = false; // in key_quota_: the key has no pending command, so it can be evicted
        bool used_again = false; // the key has sent more than one command
        KeyList::iterator use;   // position of this key in a list of its account
    };
    /// The highest request_id of an evicted key.
    struct Evicted {
        std::uint64_t highest_id = 0;
        std::string account = {};
        std::list<base::StateHash>::iterator place = {}; // in the list of its account
    };
    struct Account {
        KeyList used_once, used_again;      // most recently used key first
        std::list<base::StateHash> evicted; // the evicted keys that are remembered, oldest first

        KeyList& list_of(const Key& key) { return key.used_again ? used_again : used_once; }
        bool is_empty() const { return used_once.empty() && used_again.empty() && evicted.empty(); }
    };
    using EvictedKeys = std::unordered_map<base::StateHash, Evicted, HashOfHash>;

    /// Returns the key as the most recently used one of this account. Creates it if the cache does not have it.
    Keys::value_type& touch(const UserKey& user_key, const std::string& account, std::uint64_t request_id);
    /// Counts a key and its answers for another account.
    void move(Keys::value_type& item, const std::string& account);
    /// The key of a pending command.
    Keys::value_type& key_of_pending(const UserKey& user_key, std::uint64_t request_id);
    void store(Key& key, Command& command, const SharedBytes& answer);
    /// Counts the key if it has no pending command. Then evicts keys and answers until no pool contains too much.
    void settle(Keys::value_type& item);
    /// Evicts the oldest answer of a key. Returns false if the key has no answer.
    bool evict_oldest_answer(Key& key);
    /// Evicts one key of an account, but not `spared`. Returns false if there is none without a pending command.
    bool evict_key_of(const std::string& account, const Key& spared);
    /// Evicts one key of the account that has the most keys, but not `spared`. Returns false if there is none.
    bool evict_key_of_largest(const Key& spared);
    /// Evicts a key or answer of an account, the answers of `spared` last. Returns false if there is none.
    bool evict_bytes_of(const std::string& account, Key& spared);
    void evict(Keys::value_type& item);
    void remember_evicted(const base::StateHash& hash, const std::string& account, std::uint64_t highest_id);
    void forget_evicted(EvictedKeys::iterator evicted);
    void drop_if_empty(const std::string& account);

    const std::size_t kept_per_key_;
    const std::function<void()> key_forgotten_;
    base::Quota key_quota_, byte_quota_, evicted_quota_;
    Keys keys_;
    std::map<std::string, Account> accounts_; // those that have a key or a remembered evicted key
    EvictedKeys evicted_;                     // by the hash of the key
};

} // namespace evod::network
