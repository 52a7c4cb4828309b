#include "server/network/housekeeping.h"

#include "server/log/log.h"

#include <malloc.h>

#include <algorithm>
#include <utility>
#include <vector>

namespace evod::network {

void Housekeeping::start(access::Gate& gate) {
    checked_at_ = host_.clock->now();
    schedule(gate);
}

void Housekeeping::schedule(access::Gate& gate) {
    timer_.expires_after(housekeeping_interval);
    timer_.async_wait([this, &gate](boost::system::error_code error) {
        if (error) {
            return;
        }
        check_tokens(gate);
        const auto now = host_.clock->now();
        check_clients(now);
        trim_heap(now);
        schedule(gate);
    });
}

void Housekeeping::check_tokens(access::Gate& gate) {
    if (!gate.refresh()) {
        return;
    }
    if (gate.file_problem()) {
        log::error("{}; new connections are refused until this is fixed", gate.file_problem()->message);
    }
    // fail() may remove sessions from the table, so the loop iterates over a copy.
    const std::vector<std::pair<std::uint64_t, SessionPtr>> sessions{table_.sessions().begin(),
                                                                     table_.sessions().end()};
    for (const auto& [number, session] : sessions) {
        if (session->greeted() && !gate.file_problem() && !gate.is_still_valid(session->visitor())) {
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
