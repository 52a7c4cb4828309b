// Retries: the answers to commands that were run, so that sending one again never runs it again.
//
// A command is known by (user, client_key, request_id): what one user sends never meets the commands of another. The newest
// `kept_per_key` answers of each key are kept, for `keys_max` keys. Where there are more, or more bytes, keys that sent a
// single command go first, then those used longest ago. Of a key that went, its highest request_id is remembered, for
// `evicted_max` keys, so that a command whose answer is gone is refused instead of being carried out again.
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

class Retries {
  public:
    struct Bounds {
        std::size_t kept_per_key, keys_max, bytes_max, evicted_max;
    };
    /// Called with the answer when it is there.
    using Waiter = std::function<void(const SharedBytes&)>;

    /// key_forgotten  called for each key whose answers had to make room.
    explicit Retries(
        Bounds bounds, std::function<void()> key_forgotten = [] {})
        : bounds_{bounds}, key_forgotten_{std::move(key_forgotten)} {}

    enum class Verdict {
        New,       // run it, then finish() or forget() it; the waiter is kept
        Known,     // the waiter has been called, or will be
        Different, // the same id was used for another request; the waiter is not kept
        TooOld,    // its answer is not kept any more; the waiter is not kept
    };
    /// The client_key of a user as the other functions take it: no two users have the same.
    ///
    /// user  name of the session's token; empty: it has none.
    static std::string key_of(const std::string& user, const std::string& client_key);

    /// Looks a command up, and begins it if it is new.
    ///
    /// request  the request as bytes, the same bytes for the same request.
    Verdict begin(const std::string& client_key, std::uint64_t request_id, std::string_view request, Waiter waiter);

    /// The answer to a command that was begun: tells all who wait, and keeps it.
    void finish(const std::string& client_key, std::uint64_t request_id, const SharedBytes& answer);

    /// A command that was run before this server started, with its answer.
    void restore(const std::string& client_key, std::uint64_t request_id, std::string_view request,
                 const SharedBytes& answer);

    /// The command was begun and could not be run for now: tells all who wait, and may be sent again.
    void forget(const std::string& client_key, std::uint64_t request_id, const SharedBytes& answer);

    std::size_t key_count() const { return keys_.size(); }
    std::size_t answer_bytes() const { return answer_bytes_; }

  private:
    struct Command {
        base::StateHash request;
        SharedBytes answer; // nullptr: still being run
        std::vector<Waiter> waiters;
    };
    struct Key {
        std::map<std::uint64_t, Command> commands;
        std::uint64_t forgotten_up_to = 0; // ids up to here are too old unless they are in `commands`
        std::size_t pending_count = 0;
        bool used_again = false;              // sent more than one command
        std::list<std::string>::iterator use; // in used_once_ or used_again_
    };
    struct HashOfHash {
        std::size_t operator()(const base::StateHash& hash) const { return hash.low; }
    };
    Key& touch(const std::string& client_key, std::uint64_t request_id);
    void trim(Key& key);
    void trim_keys();
    /// Evicts the keys of a list used longest ago until the bounds hold. spared  has just been used.
    void trim_keys(std::list<std::string>& used, const std::string& spared);
    bool too_much() const { return keys_.size() > bounds_.keys_max || answer_bytes_ > bounds_.bytes_max; }
    void remember_evicted(const std::string& client_key, const Key& key);

    const Bounds bounds_;
    const std::function<void()> key_forgotten_;
    std::unordered_map<std::string, Key> keys_;
    std::list<std::string> used_once_, used_again_;                          // keys, the last used first
    const std::string* last_used_ = nullptr;                                 // in one of them
    std::unordered_map<base::StateHash, std::uint64_t, HashOfHash> evicted_; // hash of a key: its highest request_id
    std::deque<base::StateHash> evicted_in_order_;
    std::size_t answer_bytes_ = 0;
};

} // namespace evod::network
