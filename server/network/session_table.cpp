#include "server/network/session_table.h"

#include "server/base/quota.h"

#include <algorithm>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace evod::network {
namespace {

/// The user whose share of the memory a session uses: the name of its token or, without one, its address.
const std::string& account_of(const Session& session) {
    const bool has_name = session.greeted() && !session.visitor().name.empty();
    return has_name ? session.visitor().name : session.address_prefix();
}

} // namespace

void SessionTable::accept(std::unique_ptr<Transport> transport) {
    const auto session = std::make_shared<Session>(std::move(transport), host_, ++last_number_);
    ++connection_count_;
    host_.traffic.connections.add();
    if (going_away_) {
        return session->start(refusal(base::RefusalCode::Unavailable,
                                      "the server is shutting down: connect again after the restart",
                                      base::Reason::ServerGoingAway));
    }
    const auto has_same_address = [&](const auto& other) {
        return other.second->address_prefix() == session->address_prefix();
    };
    const bool all_full = sessions_.size() >= bounds_.sessions_max;
    const bool address_full = std::ranges::count_if(sessions_, has_same_address) >= bounds_.sessions_per_address_max;
    if (all_full || address_full) {
        host_.limit_counters.met(address_full ? Limit::SessionsPerAddress : Limit::Sessions);
        const auto silent = std::ranges::find_if(sessions_, [&](const auto& other) {
            return !other.second->greeted() && (!address_full || has_same_address(other));
        });
        const bool may_get_goodbye = connection_count_ - sessions_.size() <= farewells_max;
        if (silent == sessions_.end()) {
            if (may_get_goodbye) {
                session->start(refusal(base::RefusalCode::ResourceExhausted,
                                       address_full ? "there are " + std::to_string(bounds_.sessions_per_address_max) +
                                                          " sessions from this address: end one of them first"
                                                    : "the server has " + std::to_string(bounds_.sessions_max) +
                                                          " sessions: try again when one has ended",
                                       base::Reason::SessionsMax));
            } else {
                --connection_count_; // the connection is closed without a Goodbye
            }
            return;
        }
        const SessionPtr first = silent->second;
        sessions_.erase(silent);
        if (may_get_goodbye) {
            first->fail(refusal(
                base::RefusalCode::ResourceExhausted,
                "connection dropped to make room, no Hello was received: connect again and send a Hello at once",
                base::Reason::SessionsMax));
        } else {
            first->close();
        }
    }
    sessions_.emplace(session->number(), session);
    session->start();
}

void SessionTable::forget(const Session& session) {
    --connection_count_;
    ++ended_count_;
    sessions_.erase(session.number());
}

void SessionTable::evict() {
    struct Held {
        SessionPtr session;
        std::size_t bytes;
        bool has_command;
    };
    base::Quota users{host_.send_memory.bytes_max()};
    std::map<std::string, std::vector<Held>> sessions_of; // key: the account; the session to close first is the last
    std::map<std::uint64_t, std::size_t> shared;
    if (host_.shared_snapshot_bytes) {
        shared = host_.shared_snapshot_bytes();
    }
    for (const auto& [number, session] : sessions_) {
        if (const std::size_t bytes = session->held_bytes() + shared[number]; bytes > 0) {
            users.take(account_of(*session), bytes);
            sessions_of[account_of(*session)].push_back({session, bytes, session->requests.has_command_under_way()});
        }
    }
    for (auto& [account, sessions] : sessions_of) {
        std::ranges::sort(sessions, {}, [](const Held& held) { return std::pair{!held.has_command, held.bytes}; });
    }
    const std::size_t all_mib = host_.send_memory.bytes_max() >> 20;
    const std::string of_user = "the sessions of one user use more than " + std::to_string(all_mib / 2) + " MiB",
                      of_all = "all sessions use more than " + std::to_string(all_mib) + " MiB";
    std::size_t excess = host_.send_memory.excess();
    const auto is_over = [&] {
        const std::string& account = users.largest();
        if (account.empty() || excess > 0) {
            return account.empty();
        }
        const std::size_t most = std::ranges::max(sessions_of.at(account), {}, &Held::bytes).bytes;
        return users.held(account) <= users.share() || users.held(account) - most <= users.share() / 16;
    };
    while (!is_over()) {
        const std::string account = users.largest();
        const Held held = sessions_of.at(account).back();
        sessions_of.at(account).pop_back();
        held.session->evict(users.held(account) > users.share() ? of_user : of_all, held.bytes);
        users.give_back(account, held.bytes);
        excess -= std::min(excess, held.bytes);
    }
}

} // namespace evod::network
