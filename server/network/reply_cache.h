// ReplyCache: the answers to commands, which make commands idempotent: a repeated command gets the first answer and is
// not applied again.
//
// The key of a command is (user, client_key, request_id), so commands of different users never collide. The cache keeps
// the newest `kept_per_key` answers of each client_key, for `keys_max` keys and `bytes_max` bytes. Beyond that it
// evicts the keys with a single command first, then the least recently used keys. For `evicted_max` evicted keys it
// remembers the highest request_id, so that a command whose answer is gone is refused and not applied again.
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
    /// Called with the answer once it exists.
    using Waiter = std::function<void(const SharedBytes&)>;

    /// key_forgotten  called for each evicted key.
    explicit ReplyCache(
        Bounds bounds, std::function<void()> key_forgotten = [] {})
        : bounds_{bounds}, key_forgotten_{std::move(key_forgotten)} {}

    enum class Verdict {
        New,       // apply it, then call finish() or forget(); the cache keeps the waiter
        Known,     // the cache has called the waiter, or will call it
        Different, // the id belongs to another request; the cache drops the waiter
        TooOld,    // its answer is no longer cached; the cache drops the waiter
    };
    /// The key that the other functions take; it differs for any two users.
    ///
    /// user  name of the session's token; empty: it has none.
    static std::string key_of(const std::string& user, const std::string& client_key);

    /// Looks a command up and marks a new one as pending.
    ///
    /// request  the request serialised deterministically, so that equal requests have equal bytes.
    Verdict begin(const std::string& client_key, std::uint64_t request_id, std::string_view request, Waiter waiter);

    /// Stores the answer to a pending command and passes it to all waiters.
    void finish(const std::string& client_key, std::uint64_t request_id, const SharedBytes& answer);

    /// A command applied before this server started, with its answer.
    void restore(const std::string& client_key, std::uint64_t request_id, std::string_view request,
                 const SharedBytes& answer);

    /// Drops a pending command that cannot be applied now and passes `answer` to all waiters. The client may send it
    /// again.
    void forget(const std::string& client_key, std::uint64_t request_id, const SharedBytes& answer);

    std::size_t key_count() const { return keys_.size(); }
    std::size_t answer_bytes() const { return answer_bytes_; }

  private:
    struct Command {
        base::StateHash request;
        SharedBytes answer; // nullptr: pending
        std::vector<Waiter> waiters;
    };
    struct Key {
        std::map<std::uint64_t, Command> commands;
        std::uint64_t forgotten_up_to = 0; // these ids are too old unless they are in `commands`
        std::size_t pending_count = 0;
        bool used_again = false;              // more than one command was sent
        std::list<std::string>::iterator use; // position in used_once_ or used_again_
    };
    struct HashOfHash {
        std::size_t operator()(const base::StateHash& hash) const { return hash.low; }
    };
    Key& touch(const std::string& client_key, std::uint64_t request_id);
    void trim(Key& key);
    void trim_keys();
    /// Evicts the least recently used keys of a list until the bounds hold, except `spared`, which was just used.
    void trim_keys(std::list<std::string>& used, const std::string& spared);
    bool too_much() const { return keys_.size() > bounds_.keys_max || answer_bytes_ > bounds_.bytes_max; }
    void remember_evicted(const std::string& client_key, const Key& key);

    const Bounds bounds_;
    const std::function<void()> key_forgotten_;
    std::unordered_map<std::string, Key> keys_;
    std::list<std::string> used_once_, used_again_;                          // keys, most recently used first
    const std::string* last_used_ = nullptr;                                 // in one of the two lists
    std::unordered_map<base::StateHash, std::uint64_t, HashOfHash> evicted_; // hash of the key → its highest request_id
    std::deque<base::StateHash> evicted_in_order_;
    std::size_t answer_bytes_ = 0;
};

} // namespace evod::network
