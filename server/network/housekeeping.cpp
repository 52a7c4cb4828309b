#include "server/network/housekeeping.h"

#include "server/log/log.h"

#include <malloc.h>

#include <algorithm>
#include <utility>
#include <vector>

namespace evod::network {

void Housekeeping::start(access::Authenticator& authenticator) {
    checked_at_ = host_.clock->now();
    schedule(authenticator);
}

void Housekeeping::schedule(access::Authenticator& authenticator) {
    timer_.expires_after(housekeeping_interval);
    timer_.async_wait([this, &authenticator](boost::system::error_code error) {
        if (error) {
            return;
        }
        check_tokens(authenticator);
        const auto now = host_.clock->now();
        check_clients(now);
        trim_heap(now);
        schedule(authenticator);
    });
}

void Housekeeping::check_tokens(access::Authenticator& authenticator) {
    if (!authenticator.refresh()) {
        return;
    }
    if (authenticator.file_problem()) {
        log::error("{}; new connections are refused until this is fixed", authenticator.file_problem()->message);
    }
    // fail() may remove sessions from the table, so the loop iterates over a copy.
    const std::vector<std::pair<std::uint64_t, SessionPtr>> sessions{table_.sessions().begin(),
                                                                     table_.sessions().end()};
    for (const auto& [number, session] : sessions) {
        if (session->greeted() && !authenticator.file_problem() && !authenticator.is_still_valid(session->user())) {
            session->fail(refusal(base::RefusalCode::Unauthenticated,
                                  "the token has been revoked: ask the operator of the server for a new one",
                                  base::Reason::TokenRevoked));
        }
    }
}

void Housekeeping::check_clients(runtime::Clock::time_point now) {
    // If the timer fired late, the server itself was busy. That time does not count against the clients.
    const auto watched =
        std::min<runtime::Clock::duration>(now - std::exchange(checked_at_, now), 2 * housekeeping_interval);
    for (const auto& [number, session] : table_.sessions()) {
        session->check_progress(watched);
    }
}

void Housekeeping::trim_heap(runtime::Clock::time_point now) {
    const std::uint64_t ended = table_.ended_count(), answered = host_.traffic.sent_control_bytes.value();
    if (now < trim_at_ || (ended == ended_at_trim_ && answered - answered_at_trim_ < answered_to_trim_bytes)) {
        return;
    }
    ::malloc_trim(0);
    trim_at_ = now + trim_every;
    ended_at_trim_ = ended;
    answered_at_trim_ = answered;
}

} // namespace evod::network
