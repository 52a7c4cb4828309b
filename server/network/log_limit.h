// Log limit: bounds the rate of log lines that clients cause, separately for each user, so that a client that connects
// again and again neither fills the disk nor hides the lines about other users.
//
// Owner        the server; used on the network thread.
#pragma once

#include "server/network/limits.h"
#include "server/network/rate_limit.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>

namespace evod::network {

class LogLimit {
  public:
    /// Returns how many lines about this user were left out since the last line, or nullopt if this one must be left
    /// out.
    std::optional<std::uint64_t> take(const std::string& user, runtime::Clock::time_point now) {
        if (!users_.contains(user) && users_.size() >= log_users_max) {
            users_.erase(std::ranges::min_element(users_, {}, [](const auto& entry) { return entry.second.used; }));
        }
        User& lines = users_.try_emplace(user, User{{session_lines_per_s, session_lines_burst, now}}).first->second;
        lines.used = now;
        if (!lines.limit.take(1, now)) {
            ++lines.left_out;
            return std::nullopt;
        }
        return std::exchange(lines.left_out, 0);
    }

  private:
    struct User {
        RateLimit limit;
        std::uint64_t left_out = 0;
        runtime::Clock::time_point used = {};
    };
    std::map<std::string, User> users_;
};

} // namespace evod::network
