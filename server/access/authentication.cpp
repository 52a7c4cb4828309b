#include "server/access/authentication.h"

#include <sys/stat.h>

#include <algorithm>
#include <utility>

namespace evod::access {

using base::Refusal;
using base::RefusalCode;
using base::Result;

Authenticator::Stamp Authenticator::stamp() const {
    struct stat about {};
    if (!folder_ || ::lstat(token_file_of(*folder_).c_str(), &about) != 0) {
        return {};
    }
    return {true,         about.st_ino,         about.st_size,        about.st_mode,
            about.st_uid, about.st_ctim.tv_sec, about.st_ctim.tv_nsec};
}

Result<Authenticator> Authenticator::open(const std::optional<std::string>& folder, bool token_needed) {
    Authenticator authenticator{folder, token_needed};
    authenticator.refresh();
    if (authenticator.file_problem_) {
        return *authenticator.file_problem_;
    }
    if (token_needed && authenticator.tokens_.empty()) {
        return refusal(
            RefusalCode::FailedPrecondition,
            folder ? "any client on the network could control this server, and there is no token yet: create one "
                     "with `evod token add NAME --role admin --data " +
                         *folder + "`, or listen on 127.0.0.1 without --require-token and --http-host"
                   : "any client on the network could control this server, and tokens need a folder: "
                     "listen on 127.0.0.1, or name a folder with --data");
    }
    return authenticator;
}

bool Authenticator::refresh() {
    // The stamp is taken before the file is read, so that a later change is detected at the next check.
    const Stamp now = stamp();
    if (now == stamp_) {
        return false;
    }
    stamp_ = now;
    auto tokens = folder_ ? read_tokens(*folder_) : Result<Tokens>{Tokens{}};
    file_problem_ = tokens ? std::nullopt : std::optional{tokens.error()};
    if (tokens) {
        tokens_ = *std::move(tokens);
    }
    return true;
}

bool Authenticator::is_still_valid(const AuthenticatedUser& user) const {
    if (user.is_member) {
        return true; // the requests of its teacher end its sessions
    }
    if (user.name.empty()) {
        return !token_needed_;
    }
    const Token* token = find(tokens_, user.token);
    return token != nullptr && token->name == user.name && token->role == user.role;
}

void Authenticator::fail(const std::string& address, Clock::time_point now) {
    ++failed_login_count_;
    std::erase_if(failures_, [&](const auto& item) { return now - item.second.last > forgotten_after; });
    if (failures_.size() >= addresses_max && !failures_.contains(address)) {
        failures_.erase(std::ranges::min_element(failures_, {}, [](const auto& item) { return item.second.last; }));
    }
    Failures& failures = failures_[address];
    const auto delay = std::min<Clock::duration>(delay_max, delay_min * (1 << std::min(failures.count, 10)));
    ++failures.count;
    failures.last = now;
    failures.not_before = now + delay;
}

Result<AuthenticatedUser> Authenticator::admit(const std::string& token, const std::string& address,
                                               Clock::time_point now) {
    if (token.empty() && !token_needed_) {
        return AuthenticatedUser{};
    }
    if (file_problem_) {
        return refusal(RefusalCode::Unavailable,
                       "authentication is unavailable: the token file cannot be used (see the server log)",
                       base::Reason::AuthenticationUnavailable);
    }
    const Digest digest = digest_of(token);
    const Token* entry = token.empty() ? nullptr : find(tokens_, digest);
    if (entry != nullptr) {
        failures_.erase(address);
        return AuthenticatedUser{entry->name, entry->role, digest};
    }
    if (token.empty()) {
        return refusal(
            RefusalCode::Unauthenticated,
            "this server requires a token: set EVOD_TOKEN or --token-file; the operator of the server creates tokens",
            base::Reason::TokenMissing);
    }
    if (const auto before = failures_.find(address); before != failures_.end() && now < before->second.not_before) {
        const auto wait = std::chrono::ceil<std::chrono::seconds>(before->second.not_before - now);
        return refusal(RefusalCode::ResourceExhausted,
                       "logins from this address are paused after a failed one: try again in " +
                           std::to_string(wait.count()) + " s",
                       base::Reason::LoginTooSoon, {{"retry_after_s", std::to_string(wait.count())}});
    }
    fail(address, now);
    return refusal(RefusalCode::Unauthenticated,
                   "this server does not know the token: ask the operator of the server for one",
                   base::Reason::TokenUnknown);
}

} // namespace evod::access
