// Time shares: divides the time of a simulation thread equally among users who want more than there is, whatever number
// of worlds or seeks each of them has.
//
// Each user has an account of the time that was spent for them. The user with the least time comes next. A user who
// wanted nothing for a while begins again with the account of the user served last, so unused time is not saved.
//
// Owner        a simulation loop, on its thread.
// Determinism  decides when worlds advance. It does not influence what happens in them.
// Source       Goyal, Vin & Cheng 1996, "Start-time Fair Queuing", doi:10.1145/248157.248171.
#pragma once

#include "server/runtime/clock.h"

#include <algorithm>
#include <map>
#include <string>
#include <string_view>

namespace evod::runtime {

class TimeShares {
  public:
    /// The time that counts as spent for a user.
    Clock::duration spent(std::string_view user) const {
        const auto found = accounts_.find(user);
        return found == accounts_.end() ? served_ : std::max(found->second, served_);
    }
    /// Notes that a user comes next, who has the least time of those who want any.
    void serve(std::string_view user) {
        served_ = spent(user);
        std::erase_if(accounts_, [this](const auto& account) { return account.second <= served_; });
    }
    void spend(const std::string& user, Clock::duration time) { accounts_[user] = spent(user) + time; }
    /// By how much a user's time exceeds that of the user served last.
    Clock::duration lead(std::string_view user) const { return spent(user) - served_; }

  private:
    std::map<std::string, Clock::duration, std::less<>> accounts_; // those that are ahead of served_
    Clock::duration served_{0};                                    // the account of the user served last
};

} // namespace evod::runtime
