#include "server/network/reply_cache.h"

#include <algorithm>
#include <cstring>
#include <utility>

namespace evod::network {
namespace {

/// A 128-bit hash of a request or a key. It shows whether a client reuses an id for a different request.
base::StateHash fingerprint(std::string_view bytes) {
    base::EntityHash hash{0, bytes.size()};
    while (!bytes.empty()) {
        std::uint64_t word = 0;
        const std::size_t taken = std::min(sizeof word, bytes.size());
        std::memcpy(&word, bytes.data(), taken);
        hash.add(word);
        bytes.remove_prefix(taken);
    }
    return hash.finish();
}

} // namespace

std::string ReplyCache::key_of(const std::string& user, const std::string& client_key) {
    return user + '\0' + client_key; // a token's name contains no NUL
}

ReplyCache::Verdict ReplyCache::begin(const std::string& client_key, std::uint64_t request_id, std::string_view request,
                                      Waiter waiter) {
    Key& key = touch(client_key, request_id);
    const auto print = fingerprint(request);
    if (const auto found = key.commands.find(request_id); found != key.commands.end()) {
        Command& command = found->second;
        if (command.request != print) {
            return Verdict::Different;
        }
        if (command.answer) {
            waiter(command.answer);
        } else {
            command.waiters.push_back(std::move(waiter));
        }
        return Verdict::Known;
    }
    if (request_id <= key.forgotten_up_to) {
        return Verdict::TooOld;
    }
    Command& command = key.commands[request_id];
    command.request = print;
    command.waiters.push_back(std::move(waiter));
    ++key.pending_count;
    trim(key);
    evict_keys();
    return Verdict::New;
}

void ReplyCache::finish(const std::string& client_key, std::uint64_t request_id, const SharedBytes& answer) {
    const auto found = keys_.find(client_key);
    if (found == keys_.end()) {
        return;
    }
    Key& key = found->second;
    const auto command = key.commands.find(request_id);
    if (command == key.commands.end()) {
        return;
    }
    command->second.answer = answer;
    answer_bytes_ += answer->size();
    --key.pending_count;
    for (const Waiter& waiter : std::exchange(command->second.waiters, {})) {
        waiter(answer);
    }
    trim(key);
    evict_keys();
}

void ReplyCache::restore(const std::string& client_key, std::uint64_t request_id, std::string_view request,
                         const SharedBytes& answer) {
    if (begin(client_key, request_id, request, [](const SharedBytes&) {}) == Verdict::New) {
        finish(client_key, request_id, answer);
    }
}

void ReplyCache::forget(const std::string& client_key, std::uint64_t request_id, const SharedBytes& answer) {
    const auto found = keys_.find(client_key);
    if (found == keys_.end()) {
        return;
    }
    auto command = found->second.commands.extract(request_id);
    if (command.empty()) {
        return;
    }
    --found->second.pending_count;
    for (const Waiter& waiter : command.mapped().waiters) {
        waiter(answer);
    }
}

ReplyCache::Key& ReplyCache::touch(const std::string& client_key, std::uint64_t request_id) {
    const auto found = keys_.find(client_key);
    if (found != keys_.end()) {
        Key& key = found->second;
        auto& from = key.used_again ? used_again_ : used_once_;
        key.used_again |= !key.commands.contains(request_id);
        auto& to = key.used_again ? used_again_ : used_once_;
        to.splice(to.begin(), from, key.use);
        last_used_ = &*key.use;
        return key;
    }
    used_once_.push_front(client_key);
    Key& key = keys_[client_key];
    key.use = used_once_.begin();
    last_used_ = &*key.use;
    if (const auto evicted = evicted_.find(fingerprint(client_key)); evicted != evicted_.end()) {
        key.forgotten_up_to = evicted->second;
    }
    return key;
}

void ReplyCache::trim(Key& key) {
    // Pending commands are not evicted. The capacity of the mailbox bounds their number.
    for (auto oldest = key.commands.begin();
         key.commands.size() > bounds_.kept_per_key && oldest != key.commands.end();) {
        if (!oldest->second.answer) {
            ++oldest;
            continue;
        }
        key.forgotten_up_to = std::max(key.forgotten_up_to, oldest->first);
        answer_bytes_ -= oldest->second.answer->size();
        oldest = key.commands.erase(oldest);
    }
}

void ReplyCache::evict_keys() {
    evict_keys(used_once_, *last_used_);
    evict_keys(used_again_, *last_used_);
}

void ReplyCache::evict_keys(std::list<std::string>& used, const std::string& spared) {
    for (auto oldest = used.end(); exceeds_bounds() && oldest != used.begin();) {
        const auto key = keys_.find(*--oldest);
        if (&*oldest == &spared || key->second.pending_count > 0) {
            continue;
        }
        remember_evicted(key->first, key->second);
        for (const auto& [id, command] : key->second.commands) {
            answer_bytes_ -= command.answer->size();
        }
        keys_.erase(key);
        oldest = used.erase(oldest);
        key_forgotten_();
    }
}

void ReplyCache::remember_evicted(const std::string& client_key, const Key& key) {
    const std::uint64_t highest =
        key.commands.empty() ? key.forgotten_up_to : std::max(key.forgotten_up_to, key.commands.rbegin()->first);
    const auto [entry, is_new] = evicted_.try_emplace(fingerprint(client_key), highest);
    entry->second = std::max(entry->second, highest);
    if (!is_new) {
        return;
    }
    evicted_in_order_.push_back(entry->first);
    if (evicted_in_order_.size() > bounds_.evicted_max) {
        evicted_.erase(evicted_in_order_.front());
        evicted_in_order_.pop_front();
    }
}

} // namespace evod::network
