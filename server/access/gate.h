// Gate: lets sessions in, as whom their tokens say.
//
// Owner     the server; on the network thread.
// Full      failed logins are remembered of addresses_max addresses; beyond, the oldest are forgotten.
#pragma once

#include "server/access/token_file.h"

#include <chrono>
#include <map>
#include <optional>
#include <string>

#include <sys/types.h>

namespace evod::access {

/// Who a session is for.
struct Visitor {
    std::string name; // of the token; empty: came without one
    Role role = Role::Admin;
    Digest token{};
};

class Gate {
  public:
    using Clock = std::chrono::steady_clock;
    // After a failed login, further unknown tokens from its address are refused unexamined for this long; twice as long
    // after each further one. A known token is always admitted: it cannot be guessed, so there is nothing to slow down.
    static constexpr std::chrono::milliseconds delay_min{500};
    static constexpr std::chrono::milliseconds delay_max{30'000};
    static constexpr std::chrono::minutes forgotten_after{10}; // without another failure
    static constexpr std::size_t addresses_max = 10'000;

    /// folder   where the token file is; empty: there are no tokens.
    /// token_needed  whoever comes without one is refused, and is an admin otherwise.
    /// Refused where the file cannot be believed, or a token is needed and there is none.
    static base::Result<Gate> open(const std::string& folder, bool token_needed);

    /// UNAUTHENTICATED for an unknown token, or none where one is needed; RESOURCE_EXHAUSTED for an unknown one while the
    /// address has to wait.
    ///
    /// address  as far as it tells people apart.
    base::Result<Visitor> admit(const std::string& token, const std::string& address, Clock::time_point now);

    /// Reads the token file again if it is another one than before. Returns whether it was. One that cannot be believed
    /// lets nobody new in, and leaves those who are in.
    bool refresh();
    /// Whether the token by which somebody came in is still good.
    bool knows(const Visitor& visitor) const;
    /// What is wrong with the token file at present.
    const std::optional<base::Refusal>& trouble() const { return trouble_; }

    std::uint64_t failed_login_count() const { return failed_login_count_; }

  private:
    struct Failures {
        int count = 0;
        Clock::time_point last, not_before;
    };
    /// To tell one state of the file from another.
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
