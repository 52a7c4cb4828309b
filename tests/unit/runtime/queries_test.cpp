#include "server/runtime/queries.h"

#include "evod/v1/session.pb.h"
#include "tests/support/manual_clock.h"

#include <gtest/gtest.h>

namespace evod::runtime {
namespace {

using namespace std::chrono_literals;

QueryMail query_of(std::uint64_t session, const std::string& user = {}) {
    v1::Request request;
    request.set_request_id(session + 100);
    request.mutable_list_worlds();
    return {.session = session, .request = std::make_shared<const v1::Request>(std::move(request)), .user = user};
}

TEST(Queries, AreAnsweredInOrderWithoutThoseOfEndedSessions) {
    Queries queries;
    for (const std::uint64_t session : {1, 2, 3}) {
        queries.add(query_of(session));
    }
    queries.forget(2);
    const simulation::Laboratory laboratory;
    EXPECT_EQ(queries.answer_next(laboratory).mail.session, 1u);
    EXPECT_EQ(queries.answer_next(laboratory).response.request_id(), 103u);
    EXPECT_TRUE(queries.empty());
}

TEST(Queries, UsersGetEqualTimeWhateverTheyAsk) {
    Queries queries;
    const simulation::Laboratory laboratory;
    for (std::uint64_t session = 1; session <= 16; ++session) {
        queries.add(query_of(session, "eve"));
    }
    for (std::uint64_t session = 17; session <= 19; ++session) {
        queries.add(query_of(session, "ada"));
    }
    std::string order;
    while (!queries.empty()) {
        const std::string user = queries.answer_next(laboratory).mail.user;
        order += user.front();
        queries.spend(user, user == "eve" ? 4ms : 1ms, false);
    }
    EXPECT_EQ(order, "eaaaeeeeeeeeeeeeeee") << "eve's first query takes as long as ada's three and one more";
}

TEST(Queries, ALongQueryLeavesADebt) {
    Queries queries;
    support::ManualClock clock;
    clock.advance(1h);
    EXPECT_TRUE(queries.allows(clock.now())) << "the budget starts full";
    queries.spend("", Queries::saved_max + 10ms, true);
    EXPECT_FALSE(queries.allows(clock.now()));
    const auto next = queries.next_at();
    EXPECT_NEAR(static_cast<double>((next - clock.now()) / 1ms), 10.0 * Queries::share, 1);
    clock.advance(next - clock.now() - 1ms);
    EXPECT_FALSE(queries.allows(clock.now()));
    clock.advance(1ms);
    EXPECT_TRUE(queries.allows(clock.now()));
}

} // namespace
} // namespace evod::runtime
