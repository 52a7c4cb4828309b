// Quota: divides a pool that all clients share among its users, so that no user can take what belongs to all.
//
// A user holds at most half of the pool, whether or not others want the rest. If nothing is free, a user who wants more
// may take it from the user who holds the most, as long as that leaves the other one with at least as much.
//
// Threads      none of its own; its owner protects it.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>

namespace evod::base {

class Quota {
  public:
    /// total  the size of the pool, at least 1. The unit is that of all amounts.
    explicit Quota(std::size_t total) : total_{total} {}

    enum class Verdict {
        Free,        // the user may take the amount
        FromLargest, // nothing is free: the user largest() must lose something first
        UserFull,    // the user holds, or would hold, more than half of the pool
        PoolFull,    // nothing is free, and no other user holds clearly more
    };
    /// Whether a user may take so much more of the pool.
    Verdict ask(std::string_view user, std::size_t amount = 1) const;

    void take(const std::string& user, std::size_t amount = 1);
    /// Gives back what the user has taken.
    void give_back(const std::string& user, std::size_t amount = 1);
    void give_back_all();

    std::size_t total() const { return total_; }
    /// The most that one user can hold: half of the pool, but at least 1.
    std::size_t share() const { return (total_ + 1) / 2; }
    std::size_t held() const { return held_; }
    std::size_t held(std::string_view user) const;
    /// The user who holds the most; empty: no user holds anything. Of several, the first by name.
    const std::string& largest() const;

  private:
    std::size_t total_, held_ = 0;
    std::map<std::string, std::size_t, std::less<>> users_; // those who hold something
};

} // namespace evod::base
