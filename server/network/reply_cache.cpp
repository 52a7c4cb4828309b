#include "server/network/reply_cache.h"

#include "server/base/assert.h"

#include <algorithm>
#include <cstring>
#include <utility>

namespace evod::network {
namespace {

void add_bytes(base::EntityHash& hash, std::string_view bytes) {
    while (!bytes.empty()) {
        std::uint64_t word = 0;
        const std::size_t taken = std::min(sizeof word, bytes.size());
        std::memcpy(&word, bytes.data(), taken);
        hash.add(word);
        bytes.remove_prefix(taken);
    }
}

/// A 128-bit hash of a request. It shows whether a client reuses an id for a different request.
base::StateHash fingerprint(std::string_view request) {
    base::EntityHash hash{0, request.size()};
    add_bytes(hash, request);
    return hash.finish();
}

/// The memory of an answer and of its entry in the cache.
std::size_t bytes_of(const SharedBytes& answer) {
    constexpr std::size_t entry_bytes = 128;
    return entry_bytes + answer->size();
}

base::StateHash fingerprint(const UserKey& key) {
    base::EntityHash hash{1, key.client_key.size()};
    hash.add(std::uint64_t{key.user.size()});
    add_bytes(hash, key.user);
    add_bytes(hash, key.client_key);
    return hash.finish();
}

} // namespace

std::size_t ReplyCache::HashOfKey::operator()(const UserKey& key) const {
    return fingerprint(key).low;
}

ReplyCache::Verdict ReplyCache::begin(const UserKey& user_key, const std::string& account, std::uint64_t request_id,
                                      std::string_view request, Waiter waiter) {
    if (!keys_.contains(user_key)) {
        const auto evicted = evicted_.find(fingerprint(user_key));
        if (evicted != evicted_.end() && request_id <= evicted->second.highest_id) {
            remember_evicted(base::StateHash{evicted->first}, account, request_id);
            return Verdict::TooOld;
        }
    }
    Keys::value_type& item = touch(user_key, account, request_id);
    Key& key = item.second;
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
    settle(item);
    return Verdict::New;
}

void ReplyCache::finish(const UserKey& user_key, std::uint64_t request_id, const SharedBytes& answer) {
    Keys::value_type& item = key_of_pending(user_key, request_id);
    Command& command = item.second.commands.at(request_id);
    store(item.second, command, answer);
    --item.second.pending_count;
    for (const Waiter& waiter : std::exchange(command.waiters, {})) {
        waiter(answer);
    }
    settle(item);
}

void ReplyCache::forget(const UserKey& user_key, std::uint64_t request_id, const SharedBytes& answer) {
    Keys::value_type& item = key_of_pending(user_key, request_id);
    const auto command = item.second.commands.extract(request_id);
    --item.second.pending_count;
    for (const Waiter& waiter : command.mapped().waiters) {
        waiter(answer);
    }
    settle(item);
}

void ReplyCache::restore(const UserKey& user_key, const std::string& account, std::uint64_t request_id,
                         std::string_view request, const SharedBytes& answer) {
    Keys::value_type& item = touch(user_key, account, request_id);
    const auto [command, is_new] = item.second.commands.try_emplace(request_id);
    if (is_new) {
        command->second.request = fingerprint(request);
        store(item.second, command->second, answer);
        settle(item);
    }
}

void ReplyCache::restore_evicted(const UserKey& user_key, const std::string& account, std::uint64_t highest_id) {
    if (const auto found = keys_.find(user_key); found != keys_.end()) {
        found->second.forgotten_up_to = std::max(found->second.forgotten_up_to, highest_id);
    } else {
        remember_evicted(fingerprint(user_key), account, highest_id);
    }
}

ReplyCache::Keys::value_type& ReplyCache::touch(const UserKey& user_key, const std::string& account,
                                                std::uint64_t request_id) {
    const auto [found, is_new] = keys_.try_emplace(user_key);
    Key& key = found->second;
    if (!is_new) {
        move(*found, account);
        Account& owner = accounts_[account];
        KeyList& from = owner.list_of(key);
        key.used_again |= !key.commands.contains(request_id);
        KeyList& to = owner.list_of(key);
        to.splice(to.begin(), from, key.use);
        return *found;
    }
    key.account = account;
    Account& owner = accounts_[account];
    owner.used_once.push_front(&*found);
    key.use = owner.used_once.begin();
    if (const auto evicted = evicted_.find(fingerprint(user_key)); evicted != evicted_.end()) {
        key.forgotten_up_to = evicted->second.highest_id;
        forget_evicted(evicted);
    }
    return *found;
}

void ReplyCache::move(Keys::value_type& item, const std::string& account) {
    Key& key = item.second;
    if (key.account == account) {
        return;
    }
    const std::string former = std::exchange(key.account, account);
    KeyList& to = accounts_[account].list_of(key);
    to.splice(to.begin(), accounts_[former].list_of(key), key.use);
    if (key.is_counted) {
        key_quota_.give_back(former);
        key_quota_.take(account);
    }
    for (const auto& [id, command] : key.commands) {
        if (command.answer) {
            byte_quota_.give_back(former, bytes_of(command.answer));
            byte_quota_.take(account, bytes_of(command.answer));
        }
    }
    drop_if_empty(former);
}

ReplyCache::Keys::value_type& ReplyCache::key_of_pending(const UserKey& user_key, std::uint64_t request_id) {
    const auto found = keys_.find(user_key);
    EVOD_ASSERT(found != keys_.end());
    const auto command = found->second.commands.find(request_id);
    EVOD_ASSERT(command != found->second.commands.end());
    EVOD_ASSERT(!command->second.answer);
    return *found;
}

void ReplyCache::store(Key& key, Command& command, const SharedBytes& answer) {
    command.answer = answer;
    byte_quota_.take(key.account, bytes_of(answer));
}

void ReplyCache::settle(Keys::value_type& item) {
    Key& key = item.second;
    while (key.commands.size() > kept_per_key_ && evict_oldest_answer(key)) {
    }
    if (key.commands.empty()) {
        return evict(item);
    }
    if (const bool can_be_evicted = key.pending_count == 0; can_be_evicted != key.is_counted) {
        key.is_counted = can_be_evicted;
        can_be_evicted ? key_quota_.take(key.account) : key_quota_.give_back(key.account);
    }
    while (key_quota_.held(key.account) > key_quota_.share() && evict_key_of(key.account, key)) {
    }
    while (key_quota_.held() > key_quota_.total() && evict_key_of_largest(key)) {
    }
    while (byte_quota_.held(key.account) > byte_quota_.share() && evict_bytes_of(key.account, key)) {
    }
    while (byte_quota_.held() > byte_quota_.total()) {
        const std::string largest = byte_quota_.largest();
        const bool has_as_much = byte_quota_.held(key.account) == byte_quota_.held(largest);
        if (!evict_bytes_of(has_as_much ? key.account : largest, key)) {
            break;
        }
    }
    if (key.commands.empty()) { // its only answer was too large
        evict(item);
    }
}

bool ReplyCache::evict_oldest_answer(Key& key) {
    const auto oldest =
        std::ranges::find_if(key.commands, [](const auto& command) { return command.second.answer != nullptr; });
    if (oldest == key.commands.end()) {
        return false;
    }
    key.forgotten_up_to = std::max(key.forgotten_up_to, oldest->first);
    byte_quota_.give_back(key.account, bytes_of(oldest->second.answer));
    key.commands.erase(oldest);
    return true;
}

bool ReplyCache::evict_key_of(const std::string& account, const Key& spared) {
    const auto found = accounts_.find(account);
    if (found == accounts_.end()) {
        return false;
    }
    for (const KeyList* list : {&found->second.used_once, &found->second.used_again}) {
        const auto oldest = std::find_if(list->rbegin(), list->rend(), [&](const Keys::value_type* item) {
            return item->second.pending_count == 0 && &item->second != &spared;
        });
        if (oldest != list->rend()) {
            evict(**oldest);
            return true;
        }
    }
    return false;
}

bool ReplyCache::evict_key_of_largest(const Key& spared) {
    const std::string largest = key_quota_.largest();
    const std::size_t most = key_quota_.held(largest);
    if (key_quota_.held(spared.account) == most && evict_key_of(spared.account, spared)) {
        return true;
    }
    if (largest != spared.account) {
        return evict_key_of(largest, spared);
    }
    const auto other = std::ranges::find_if(accounts_, [&](const auto& account) {
        return account.first != largest && key_quota_.held(account.first) == most;
    });
    return other != accounts_.end() && evict_key_of(std::string{other->first}, spared);
}

bool ReplyCache::evict_bytes_of(const std::string& account, Key& spared) {
    if (evict_key_of(account, spared)) {
        return true;
    }
    const auto found = accounts_.find(account); // all its keys have pending commands, except `spared`
    if (found == accounts_.end()) {
        return false;
    }
    for (const KeyList* list : {&found->second.used_once, &found->second.used_again}) {
        for (auto item = list->rbegin(); item != list->rend(); ++item) {
            if (Key& key = (*item)->second; &key != &spared && evict_oldest_answer(key)) {
                return true;
            }
        }
    }
    return spared.account == account && evict_oldest_answer(spared);
}

void ReplyCache::evict(Keys::value_type& item) {
    Key& key = item.second;
    const std::string account = key.account;
    const base::StateHash hash = fingerprint(item.first);
    const std::uint64_t highest_id =
        key.commands.empty() ? key.forgotten_up_to : std::max(key.forgotten_up_to, key.commands.rbegin()->first);
    for (const auto& [id, command] : key.commands) {
        byte_quota_.give_back(account, bytes_of(command.answer));
    }
    if (key.is_counted) {
        key_quota_.give_back(account);
    }
    accounts_[account].list_of(key).erase(key.use);
    keys_.erase(keys_.find(item.first));
    if (highest_id == 0) { // the key has never had a command that was applied
        return drop_if_empty(account);
    }
    remember_evicted(hash, account, highest_id);
    key_forgotten_();
}

void ReplyCache::remember_evicted(const base::StateHash& hash, const std::string& account, std::uint64_t highest_id) {
    if (const auto entry = evicted_.find(hash); entry != evicted_.end()) { // it becomes the newest one
        highest_id = std::max(highest_id, entry->second.highest_id);
        forget_evicted(entry);
    }
    Account& owner = accounts_[account];
    evicted_.emplace(hash, Evicted{highest_id, account, owner.evicted.insert(owner.evicted.end(), hash)});
    evicted_quota_.take(account);
    while (evicted_quota_.held(account) > evicted_quota_.share()) {
        forget_evicted(evicted_.find(accounts_[account].evicted.front()));
    }
    while (evicted_quota_.held() > evicted_quota_.total()) {
        const std::string largest = evicted_quota_.largest();
        const bool has_as_much = evicted_quota_.held(account) == evicted_quota_.held(largest);
        forget_evicted(evicted_.find(accounts_[has_as_much ? account : largest].evicted.front()));
    }
}

void ReplyCache::forget_evicted(EvictedKeys::iterator evicted) {
    const std::string account = evicted->second.account;
    accounts_[account].evicted.erase(evicted->second.place);
    evicted_quota_.give_back(account);
    evicted_.erase(evicted);
    drop_if_empty(account);
}

void ReplyCache::drop_if_empty(const std::string& account) {
    if (const auto found = accounts_.find(account); found != accounts_.end() && found->second.is_empty()) {
        accounts_.erase(found);
    }
}

} // namespace evod::network
