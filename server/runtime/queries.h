// Queries: the queries that wait, and the time that the simulation thread may spend on them while worlds run.
//
// The budget grows by a fixed share of the elapsed time, up to a small maximum for bursts. A query that takes longer
// than the budget leaves a debt. The next query waits until the debt is paid. So queries slow a world by at most that
// share, even if clients send them without pause. The time is divided equally among the users who want it.
//
// Owner        a simulation loop, on its thread.
// Full         never: a session has at most one query under way.
// Determinism  the budget decides when a query is answered. It does not influence what a world does.
#pragma once

#include "server/protocol/queries.h"
#include "server/runtime/clock.h"
#include "server/runtime/replies.h"
#include "server/runtime/time_shares.h"

#include <algorithm>
#include <deque>
#include <utility>

namespace evod::runtime {

class Queries {
  public:
    static constexpr int share = 10; // queries get 1 / share of the elapsed time
    static constexpr std::chrono::milliseconds saved_max{5};

    void add(QueryMail query) { waiting_.push_back(std::move(query)); }
    /// Drops the query of a session that has ended.
    void forget(std::uint64_t session) {
        std::erase_if(waiting_, [&](const QueryMail& query) { return query.session == session; });
    }
    bool empty() const { return waiting_.empty(); }

    /// Answers the oldest query of the user for whom the least time was spent. There must be one.
    QueryDone answer_next(const simulation::Laboratory& laboratory) {
        const auto next = std::ranges::min_element(
            waiting_, {}, [this](const QueryMail& query) { return shares_.spent(query.user); });
        QueryDone done{.mail = std::move(*next), .response = {}, .result = {}};
        waiting_.erase(next);
        shares_.serve(done.mail.user);
        const v1::Request& request = *done.mail.request;
        done.response.set_request_id(request.request_id());
        done.result = protocol::answer_query(request, laboratory, done.mail.users_only, done.response);
        return done;
    }

    /// Whether a query may be answered at the time `now` although work is due. Times must not decrease between calls.
    bool allows(Clock::time_point now) {
        saved_ = std::min<Clock::duration>(saved_ + (now - earned_until_) / share, saved_max);
        earned_until_ = now;
        return saved_ > Clock::duration::zero();
    }
    /// Notes the time that a query of a user took.
    ///
    /// work_was_due  it counts against the budget.
    void spend(const std::string& user, Clock::duration time, bool work_was_due) {
        shares_.spend(user, time);
        if (work_was_due) {
            saved_ -= time;
        }
    }
    /// The earliest time at which the next query may be answered. allows() must be called first.
    Clock::time_point next_at() const {
        return earned_until_ + std::max(Clock::duration{1} - saved_, Clock::duration::zero()) * share;
    }

  private:
    std::deque<QueryMail> waiting_;
    TimeShares shares_;
    Clock::time_point earned_until_; // initially the clock's epoch, so that the budget starts full
    Clock::duration saved_{0};       // negative: a debt
};

} // namespace evod::runtime
