// Authentication: which user a session belongs to, by its token.
//
// Owner        the server, on the network thread.
// Full         stores the failed logins of at most addresses_max addresses. Beyond that it drops the address whose
//              last failure is the oldest.
#pragma once

#include "server/access/token_file.h"

#include <chrono>
#include <map>
#include <optional>
#include <string>

#include <sys/types.h>

namespace evod::access {

/// The user of a session.
struct AuthenticatedUser {
    std::string name; // name of the token; empty: no token
    Role role = Role::Admin;
    Digest token{};
    bool is_member = false; // a member of a class, whose token is not in the token file
};

class Authenticator {
  public:
    using Clock = std::chrono::steady_clock;
    // After a failed login, unknown tokens from the same address are refused for this time. Each further failure
    // doubles the time. A known token is always admitted. Tokens cannot be guessed, so known tokens need no rate limit.
    static constexpr std::chrono::milliseconds delay_min{500};
    static constexpr std::chrono::milliseconds delay_max{30'000};
    // Earlier failures of an address no longer count after this time without a failure.
    static constexpr std::chrono::minutes forgotten_after{10};
    static constexpr std::size_t addresses_max = 10'000;

    /// folder        folder of the token file; nullopt: there is no token file.
    /// token_needed  true: a client without a token is refused; false: a client without a token becomes an admin.
    ///
    /// Refused if the token file is not trustworthy, or if a token is needed and the file contains none.
    static base::Result<Authenticator> open(const std::optional<std::string>& folder, bool token_needed);

    /// Authenticates a client. Refuses with UNAUTHENTICATED if the token is missing or unknown, and with
    /// RESOURCE_EXHAUSTED if the token is unknown and the address must wait.
    ///
    /// address  key of the rate limit: the IPv4 address, or the /48 prefix of the IPv6 address.
    base::Result<AuthenticatedUser> admit(const std::string& token, const std::string& address, Clock::time_point now);

    /// Reads the token file again if it has changed, and returns whether it has changed. While the file is not
    /// trustworthy, new sessions are refused and existing sessions continue.
    bool refresh();
    /// Whether the token with which the user was admitted is still valid.
    bool is_still_valid(const AuthenticatedUser& user) const;
    /// Why the token file cannot be used now; nullopt: it can be used.
    const std::optional<base::Refusal>& file_problem() const { return file_problem_; }

    std::uint64_t failed_login_count() const { return failed_login_count_; }

  private:
    struct Failures {
        int count = 0;
        Clock::time_point last, not_before;
    };
    /// Identifies one version of the token file.
    struct Stamp {
        bool there = false;
        ino_t inode = 0;
        off_t bytes = 0;
        mode_t mode = 0;
        uid_t owner = 0;
        std::int64_t changed_s = 0, changed_ns = 0;
        friend bool operator==(const Stamp&, const Stamp&) = default;
    };

    Authenticator(std::optional<std::string> folder, bool token_needed)
        : folder_{std::move(folder)}, token_needed_{token_needed} {}
    Stamp stamp() const;
    void fail(const std::string& address, Clock::time_point now);

    std::optional<std::string> folder_;
    bool token_needed_;
    Tokens tokens_;
    std::optional<base::Refusal> file_problem_;
    Stamp stamp_;
    std::map<std::string, Failures> failures_; // key: address
    std::uint64_t failed_login_count_ = 0;
};

} // namespace evod::access
