// ReplyCache: caches the answers to commands to make commands idempotent. A repeated command receives the cached answer
// and is not applied again.
//
// A command is identified by (user, client_key, request_id), so commands of different users never collide. The cache
// keeps the newest `kept_per_key` answers of each client_key, for `keys_max` keys and `bytes_max` bytes. Beyond these
// limits it first evicts keys with a single command, then the least recently used keys. It remembers the highest
// request_id of the last `evicted_max` evicted keys. It can therefore refuse a command whose answer it no longer has,
// instead of applying the command again.
//
// Owner        the dispatcher, on the network thread.
#pragma once

#include "proto/codec/shared_bytes.h"
#include "server/base/state_hash.h"

#include <cstdint>
#include <deque>
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
        : bounds_{bounds}, key_forgotten_{std::move(key_forgotten)} {}

    enum class Verdict {
        New,       // the caller must apply the command, then call finish() or forget(); the cache keeps the waiter
        Known,     // the command is known: the cache has called the waiter, or will call it
        Different, // a different request has used this id; the cache drops the waiter
        TooOld,    // the answer is no longer cached; the cache drops the waiter
    };
    /// Returns the key that all other functions take as `client_key`. Equal client keys of different users give
    /// different keys.
    ///
    /// user  name of the session's token; empty: the session has no token.
    static std::string key_of(const std::string& user, const std::string& client_key);

    /// Looks up a command. A new command is marked as pending.
    ///
    /// request  the deterministically serialised request, so that equal requests have equal bytes.
    Verdict begin(const std::string& client_key, std::uint64_t request_id, std::string_view request, Waiter waiter);

    /// Stores the answer to a pending command and passes the answer to all waiters.
    void finish(const std::string& client_key, std::uint64_t request_id, const SharedBytes& answer);

    /// Adds a command that was applied before this server started, with its answer.
    void restore(const std::string& client_key, std::uint64_t request_id, std::string_view request,
                 const SharedBytes& answer);

    /// Drops a pending command that cannot be applied now, and passes `answer` to all waiters. The client may send the
    /// same command again.
    void forget(const std::string& client_key, std::uint64_t request_id, const SharedBytes& answer);

    std::size_t key_count() const { return keys_.size(); }
    std::size_t answer_bytes() const { return answer_bytes_; }

  private:
    struct Command {
        base::StateHash request;
        SharedBytes answer; // nullptr: the command is pending
        std::vector<Waiter> waiters;
    };
    struct Key {
        std::map<std::uint64_t, Command> commands;
        std::uint64_t forgotten_up_to = 0; // ids up to this one are too old unless `commands` contains them
        std::size_t pending_count = 0;
        bool used_again = false;              // the key has sent more than one command
        std::list<std::string>::iterator use; // position of this key in used_once_ or used_again_
    };
    struct HashOfHash {
        std::size_t operator()(const base::StateHash& hash) const { return hash.low; }
    };
    Key& touch(const std::string& client_key, std::uint64_t request_id);
    void trim(Key& key);
    void evict_keys();
    /// Evicts the least recently used keys of a list until the cache is within its limits. Does not evict `spared`,
    /// which was just used.
    void evict_keys(std::list<std::string>& used, const std::string& spared);
    bool exceeds_bounds() const { return keys_.size() > bounds_.keys_max || answer_bytes_ > bounds_.bytes_max; }
    void remember_evicted(const std::string& client_key, const Key& key);

    const Bounds bounds_;
    const std::function<void()> key_forgotten_;
    std::unordered_map<std::string, Key> keys_;
    std::list<std::string> used_once_, used_again_; // most recently used key first
    const std::string* last_used_ = nullptr;        // points into one of the two lists
    // Maps the hash of each evicted key to the highest request_id of that key.
    std::unordered_map<base::StateHash, std::uint64_t, HashOfHash> evicted_;
    std::deque<base::StateHash> evicted_in_order_;
    std::size_t answer_bytes_ = 0;
};

} // namespace evod::network
