// Gate: authenticates sessions by their tokens.
//
// Owner        the server, on the network thread.
// Full         remembers failed logins of addresses_max addresses; beyond that it forgets the oldest.
#pragma once

#include "server/access/token_file.h"

#include <chrono>
#include <map>
#include <optional>
#include <string>

#include <sys/types.h>

namespace evod::access {

/// The user behind a session.
struct Visitor {
    std::string name; // of the token; empty: no token
    Role role = Role::Admin;
    Digest token{};
};

class Gate {
  public:
    using Clock = std::chrono::steady_clock;
    // After a failed login the gate refuses unknown tokens from that address for this long, and twice as long after
    // each further failure. A known token is always admitted: tokens cannot be guessed, so it needs no rate limit.
    static constexpr std::chrono::milliseconds delay_min{500};
    static constexpr std::chrono::milliseconds delay_max{30'000};
    static constexpr std::chrono::minutes forgotten_after{10}; // without another failure
    static constexpr std::size_t addresses_max = 10'000;

    /// folder        of the token file; empty: there are no tokens.
    /// token_needed  false: a client without a token is an admin; true: it is refused.
    ///
    /// Refused if the token file is not trustworthy, or if a token is needed and there is none.
    static base::Result<Gate> open(const std::string& folder, bool token_needed);

    /// UNAUTHENTICATED for an unknown or missing token; RESOURCE_EXHAUSTED for an unknown token while the address must
    /// wait.
    ///
    /// address  the key of the rate limit: an IPv4 address or an IPv6 /64.
    base::Result<Visitor> admit(const std::string& token, const std::string& address, Clock::time_point now);

    /// Reads the token file again if it has changed, and returns whether it has. While the file is not trustworthy, new
    /// sessions are refused and existing ones continue.
    bool refresh();
    /// Whether the token of an admitted session is still valid.
    bool knows(const Visitor& visitor) const;
    /// Why the token file is currently not usable; nullopt: it is.
    const std::optional<base::Refusal>& trouble() const { return trouble_; }

    std::uint64_t failed_login_count() const { return failed_login_count_; }

  private:
    struct Failures {
        int count = 0;
        Clock::time_point last, not_before;
    };
    /// Identifies a version of the file.
    struct Stamp {
        bool there = false;
        ino_t inode = 0;
        off_t bytes = 0;
        mode_t mode = 0;
        uid_t owner = 0;
        std::int64_t changed_s = 0, changed_ns = 0;
        friend bool operator==(const Stamp&, const Stamp&) = default;
    };

    Gate(std::string folder, bool token_needed) : folder_{std::move(folder)}, token_needed_{token_needed} {}
    Stamp stamp() const;
    void fail(const std::string& address, Clock::time_point now);

    std::string folder_;
    bool token_needed_;
    Tokens tokens_;
    std::optional<base::Refusal> trouble_;
    Stamp stamp_;
    std::map<std::string, Failures> failures_; // by address
    std::uint64_t failed_login_count_ = 0;
};

} // namespace evod::access
