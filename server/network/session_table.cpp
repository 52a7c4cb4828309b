#include "server/network/session_table.h"

#include <algorithm>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace evod::network {

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
    std::vector<std::pair<std::size_t, SessionPtr>> most;
    for (const auto& [number, session] : sessions_) {
        most.emplace_back(session->held_bytes(), session);
    }
    std::ranges::sort(most, std::greater{}, [](const auto& item) { return item.first; });
    std::size_t excess = host_.send_memory.excess();
    for (const auto& [bytes, session] : most) {
        if (excess == 0 || bytes == 0) {
            break;
        }
        session->evict();
        excess -= std::min(excess, bytes);
    }
}

} // namespace evod::network
