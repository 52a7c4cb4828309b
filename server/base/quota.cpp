#include "server/base/quota.h"

#include "server/base/assert.h"

#include <algorithm>

namespace evod::base {

Quota::Verdict Quota::ask(std::string_view user, std::size_t amount) const {
    const std::size_t mine = held(user);
    if (mine + amount > share()) {
        return Verdict::UserFull;
    }
    if (held_ + amount <= total_) {
        return Verdict::Free;
    }
    return held(largest()) >= mine + 2 * amount ? Verdict::FromLargest : Verdict::PoolFull;
}

void Quota::take(const std::string& user, std::size_t amount) {
    held_ += amount;
    users_[user] += amount;
}

void Quota::give_back(const std::string& user, std::size_t amount) {
    const auto found = users_.find(user);
    EVOD_ASSERT(found != users_.end() && found->second >= amount);
    held_ -= amount;
    found->second -= amount;
    if (found->second == 0) {
        users_.erase(found);
    }
}

void Quota::give_back_all() {
    held_ = 0;
    users_.clear();
}

std::size_t Quota::held(std::string_view user) const {
    const auto found = users_.find(user);
    return found == users_.end() ? 0 : found->second;
}

const std::string& Quota::largest() const {
    static const std::string no_user;
    const auto most = std::ranges::max_element(users_, {}, [](const auto& user) { return user.second; });
    return most == users_.end() ? no_user : most->first;
}

} // namespace evod::base
