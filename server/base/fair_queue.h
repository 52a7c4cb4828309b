// Fair queue: serves users in turn, however many items each of them adds.
//
//   the oldest item of the user who was served least recently
//
// A user who has no item in the queue is forgotten. With the next item, the user comes after those who have waited for
// longer, and before the user served last.
//
// Threads      none of its own; its owner protects it.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <utility>

namespace evod::base {

template <class T>
class FairQueue {
  public:
    void add(std::string user, T item) {
        count_one(user);
        items_.push_back({std::move(user), std::move(item)});
    }
    /// Adds an item that comes before all others of its user, but not before those of other users.
    void add_first(std::string user, T item) {
        count_one(user);
        const auto before = std::ranges::find(items_, user, &Entry::user);
        items_.insert(before, Entry{std::move(user), std::move(item)});
    }
    /// Removes the next item that `may` allows; nullopt: there is none. may(user, item) returns a bool.
    template <class May>
    std::optional<T> take(May may) {
        auto next = items_.end();
        for (auto entry = items_.begin(); entry != items_.end(); ++entry) {
            if ((next == items_.end() || served(*entry) < served(*next)) && may(entry->user, entry->item)) {
                next = entry;
            }
        }
        if (next == items_.end()) {
            return std::nullopt;
        }
        std::optional<T> taken{std::move(next->item)};
        users_.at(next->user).served = ++last_served_;
        forget_one(next->user);
        items_.erase(next);
        return taken;
    }
    /// Whether take() would return an item.
    template <class May>
    bool has(May may) const {
        return std::ranges::any_of(items_, [&](const Entry& entry) { return may(entry.user, entry.item); });
    }
    /// Removes all items for which `is_unwanted(item)` returns true.
    template <class IsUnwanted>
    void remove_if(IsUnwanted is_unwanted) {
        std::erase_if(items_, [&](const Entry& entry) {
            const bool unwanted = is_unwanted(entry.item);
            if (unwanted) {
                forget_one(entry.user);
            }
            return unwanted;
        });
    }

    std::size_t size() const { return items_.size(); }
    /// The number of items of one user.
    std::size_t count(const std::string& user) const {
        const auto found = users_.find(user);
        return found == users_.end() ? 0 : found->second.count;
    }

  private:
    struct Entry {
        std::string user;
        T item;
    };
    struct User {
        std::size_t count = 0;    // items in the queue
        std::uint64_t served = 0; // as if this had been the number of the last item taken
    };
    std::uint64_t served(const Entry& entry) const { return users_.at(entry.user).served; }
    void count_one(const std::string& user) {
        const std::uint64_t before_last = last_served_ - std::min<std::uint64_t>(last_served_, 1);
        users_.try_emplace(user, User{.served = before_last}).first->second.count += 1;
    }
    void forget_one(const std::string& user) {
        const auto found = users_.find(user);
        if (--found->second.count == 0) {
            users_.erase(found);
        }
    }

    std::deque<Entry> items_; // in the order in which they were added
    std::map<std::string, User> users_;
    std::uint64_t last_served_ = 0;
};

} // namespace evod::base
