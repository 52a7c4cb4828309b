// Retries: the answers to commands that were run, so that sending one again never runs it again.
//
// A command is known by (client_key, request_id). The newest `retries_kept` of each key are kept, for the
// `client_keys_max` keys used last; both bounds and the bytes of all answers together hold memory down.
//
// Owner        the dispatcher, on the network thread.
#pragma once

#include "server/base/state_hash.h"

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

/// A frame as it goes to clients, shared by all who get it.
using SharedBytes = std::shared_ptr<const std::string>;

class Retries {
  public:
    struct Bounds {
        std::size_t kept_per_key, keys_max, bytes_max;
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
        std::list<std::string>::iterator use; // in used_
    };
    Key& touch(const std::string& client_key);
    void trim(Key& key);
    void trim_keys();

    const Bounds bounds_;
    const std::function<void()> key_forgotten_;
    std::unordered_map<std::string, Key> keys_;
    std::list<std::string> used_; // keys, the last used first
    std::size_t answer_bytes_ = 0;
};

} // namespace evod::network
