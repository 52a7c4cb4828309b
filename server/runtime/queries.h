// Queries: the queries that wait, and the time that the simulation thread may spend on them while worlds run.
//
// The budget grows by a fixed share of the elapsed time, up to a small maximum for bursts. A query that takes longer
// than the budget leaves a debt. The next query waits until the debt is paid. So queries slow a world by at most that
// share, even if clients send them without pause.
//
// Owner        a simulation loop, on its thread.
// Full         never: a session has at most one query under way.
// Determinism  the budget decides when a query is answered. It does not influence what a world does.
#pragma once

#include "server/protocol/queries.h"
#include "server/runtime/clock.h"
#include "server/runtime/replies.h"

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

    /// Answers the oldest query. There must be one.
    QueryDone answer_next(const simulation::Laboratory& laboratory) {
        QueryDone done{.mail = std::move(waiting_.front()), .response = {}, .result = {}};
        waiting_.pop_front();
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
    /// Notes the time that a query took while work was due.
    void spend(Clock::duration time) { saved_ -= time; }
    /// The earliest time at which the next query may be answered. allows() must be called first.
    Clock::time_point next_at() const {
        return earned_until_ + std::max(Clock::duration{1} - saved_, Clock::duration::zero()) * share;
    }

  private:
    std::deque<QueryMail> waiting_;
    Clock::time_point earned_until_; // initially the clock's epoch, so that the budget starts full
    Clock::duration saved_{0};       // negative: a debt
};

} // namespace evod::runtime
