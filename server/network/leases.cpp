#include "server/network/leases.h"

#include "server/network/limits.h"

#include <utility>

namespace evod::network {

void Leases::begin(const std::string& world, std::uint64_t number, const std::optional<UserKey>& holder) {
    const auto lease = leases_.try_emplace(world, Lease{0, {}, boost::asio::steady_timer{context_}}).first;
    lease->second.number = number;
    lease->second.holder = holder;
    await_end(world, lease->second);
}

bool Leases::renew(const std::string& world, const UserKey& key) {
    const auto lease = leases_.find(world);
    if (lease == leases_.end() || lease->second.holder != key) {
        return false;
    }
    await_end(world, lease->second);
    return true;
}

void Leases::await_end(const std::string& world, Lease& lease) {
    lease.timer.expires_after(lease_time);
    lease.timer.async_wait([this, world](boost::system::error_code error) {
        const auto ended = leases_.find(world);
        if (error || ended == leases_.end() ||
            ended->second.timer.expiry() > boost::asio::steady_timer::clock_type::now()) {
            return; // end() or renew() was called just before the timer expired
        }
        ended->second.holder.reset();
        await_end(world, ended->second);
        expired_(world, ended->second.number);
    });
}

} // namespace evod::network
