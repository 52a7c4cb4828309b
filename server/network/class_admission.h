// Class admission: connects the members of classes, with the code of a class, a personal code or a member's token.
//
// Guessing     A school has one address, so wrong codes are not counted for an address. They are bounded for the whole
//              server: above wrong_codes_burst at once, or wrong_codes_per_s, the answer to a wrong code is
//              JOINS_TOO_FAST, and the teachers are shown that codes are guessed. A right code is always admitted,
//              whatever the rate of wrong ones: otherwise one program that guesses would keep a school out.
//              So guessing is as fast as the server answers connections, which is a few thousand per second. Of 64
//              million codes, such a flood tries 6 % at 3,000 per second while a code is valid, and the teacher, who
//              sees the warning after a second, can draw another code or lock the class at any time. A member whom a
//              guess has let in is a viewer with a world of its own, on the teacher's list, where he can be removed. Of
//              10^13 personal codes a flood tries 0.003 % a day.
// Owner        the dispatcher, on the network thread.
#pragma once

#include "server/classes/membership.h"
#include "server/classes/registry.h"
#include "server/network/class_events.h"
#include "server/network/rate_limit.h"

#include <functional>
#include <optional>

namespace evod::network {

/// The refusal for a member whom the teacher has removed.
base::Refusal removed_refusal(const std::string& class_name);

class ClassAdmission {
  public:
    static constexpr std::chrono::seconds warned_for{60}; // after the last wrong code above the bound

    struct Services {
        classes::Draw draw;
        std::function<std::int64_t()> now_s; // seconds since 1970
        /// Creates the world of a member, unless it exists.
        std::function<void(const classes::Class&, const classes::Member&)> create_world;
    };

    /// All arguments must outlive this object.
    ClassAdmission(asio::io_context& context, classes::Registry& registry, ClassEvents& events, SessionHost& host,
                   const Services& services)
        : registry_{registry}, events_{events}, host_{host}, services_{services}, calm_{context} {}

    /// Connects a member. nullopt: the Hello is not that of a member. A token or code of a removed member is refused.
    std::optional<base::Result<AdmittedMember>> admit(const v1::Hello& hello);
    bool codes_are_guessed() const { return guessed_; }

  private:
    base::Result<AdmittedMember> join(const v1::Join& join);
    base::Result<AdmittedMember> join_as(classes::Class of, std::uint32_t number);
    base::Refusal wrong_code();
    AdmittedMember admitted(const classes::Class& of, const classes::Member& member, const std::string& token) const;

    classes::Registry& registry_;
    ClassEvents& events_;
    SessionHost& host_;
    const Services& services_;
    std::optional<RateLimit> wrong_codes_; // nullopt: there was none
    bool guessed_ = false;
    asio::steady_timer calm_; // ends `guessed_`
};

} // namespace evod::network
