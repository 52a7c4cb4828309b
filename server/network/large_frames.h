// Large frames: divides the network thread's time for parsing and checking large messages among users. A frame of 1 MiB
// can take tens of milliseconds, in which no other session is served, and a user may have many sessions.
//
// The time that a user's large frames take is measured. After each, the sessions of this user parse none for four times
// as long, so they take at most a fifth of the thread's time. Small frames do not wait; requests_per_s_max limits them.
//
// Owner        the server; used on the network thread.
#pragma once

#include "server/runtime/clock.h"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <map>
#include <string>
#include <string_view>

namespace evod::network {

class LargeFrames {
  public:
    using Clock = runtime::Clock;

    static bool contains(std::size_t body_bytes) { return body_bytes > 4096; }

    /// The earliest time at which a large frame of this user may be parsed.
    Clock::time_point earliest(std::string_view user) const {
        const auto found = users_.find(user);
        return found == users_.end() ? Clock::time_point::min() : found->second;
    }
    /// took  the time from the begin of the parsing of a frame until `now`.
    void charge(const std::string& user, Clock::time_point now, Clock::duration took) {
        constexpr std::chrono::seconds charged_max{1}; // the machine, not the frame, may have been slow
        std::erase_if(users_, [now](const auto& entry) { return entry.second <= now; });
        users_[user] = now + 4 * std::clamp<Clock::duration>(took, {}, charged_max);
    }

  private:
    std::map<std::string, Clock::time_point, std::less<>> users_; // those who must wait
};

} // namespace evod::network
