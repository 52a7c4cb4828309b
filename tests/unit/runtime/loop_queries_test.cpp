// Queries in the loop, with a manual clock: they get the idle time, and commands and ticks do not wait for them.
#include "tests/unit/runtime/loop_with_clock.h"

#include <gtest/gtest.h>

namespace evod::runtime {
namespace {

/// Always has a query waiting, each taking 4 ms.
class LoopWithAsker : public Loop {
  protected:
    void begin_asking() {
        on_query = [this](const v1::Response&) {
            ++answered;
            clock.advance(4ms);
            send_queries(1);
        };
        send_queries(1);
    }
    int answered = 0;
};

TEST_F(LoopWithAsker, QueriesGetAllIdleTime) {
    send(create("w"));
    send(simulation::Run{"w", {}});
    loop.pass();
    begin_asking();
    const auto began = clock.now();
    auto next = loop.pass();
    while (clock.now() - began < 2s) {
        if (next && *next > clock.now() && !mailbox.pending()) {
            clock.advance(*next - clock.now());
        }
        next = loop.pass();
    }
    EXPECT_NEAR(static_cast<double>(tick()), 201, 2);
    EXPECT_NEAR(answered, 500, 10) << "no world needed the time";
    EXPECT_FALSE(world().slowed);
}

TEST_F(LoopWithAsker, QueriesCostAFastWorldOnlyAShareOfTheTime) {
    send(create("w"));
    send(simulation::SetSpeed{"w", {}});
    send(simulation::Run{"w", {}});
    clock.per_look = 100us; // the length of a tick
    loop.pass();
    begin_asking();
    const auto began = clock.now();
    while (clock.now() - began < 2s) {
        loop.pass();
    }
    EXPECT_NEAR(answered * 4.0, 2000.0 / Queries::share, 12);
}

TEST_F(Loop, CommandsDoNotWaitForQueries) {
    send(create("w"));
    loop.pass();
    std::vector<bool> running;
    on_query = [&](const v1::Response&) {
        running.push_back(world("w").wants_tick());
        if (running.size() == 1) {
            send(simulation::Run{"w", {}});
        }
    };
    send_queries(2);
    loop.pass();
    EXPECT_EQ(running, (std::vector{false, true}));
}

TEST_F(Loop, FollowsAWorldThatIsCreatedBetweenQueries) {
    send(create("w"));
    watch("late", 60);
    loop.pass();
    on_query = [&](const v1::Response&) { send(create("late", 2)); };
    send_queries(1);
    loop.pass();
    ASSERT_EQ(snapshots.size(), 1u);
    EXPECT_EQ(snapshots[0]->world, "late");
}

TEST_F(Loop, AWakeUpDuringQueriesCausesAnotherPass) {
    send(create("w"));
    send(simulation::Run{"w", {}});
    loop.pass();
    snapshots.clear();
    clock.advance(10ms);
    int answered = 0;
    on_query = [&](const v1::Response& response) {
        if (++answered == 1) {
            clock.advance(40ms); // more than the saved budget, so the next query waits for the due ticks
            return;
        }
        EXPECT_GT(response.worlds().worlds(0).tick(), 1u);
        watch("w", 60);
        mailbox.wake();
    };
    send_queries(2);
    const auto next = loop.pass();
    EXPECT_EQ(answered, 2);
    EXPECT_TRUE(snapshots.empty());
    ASSERT_TRUE(next);
    EXPECT_LE(*next, clock.now());
    loop.pass();
    EXPECT_EQ(snapshots.size(), 1u);
}

TEST_F(Loop, PendingQueriesAreAnsweredAtTheEnd) {
    send(create("w"));
    send(simulation::SetSpeed{"w", {}});
    send(simulation::Run{"w", {}});
    int answered = 0;
    on_query = [&](const v1::Response&) {
        ++answered;
        clock.advance(100ms);
    };
    send_queries(50);
    clock.per_look = 100us;
    loop.pass();
    EXPECT_LT(answered, 50);
    loop.close();
    EXPECT_EQ(answered, 50);
}

TEST_F(Loop, TheQueryOfASessionThatEndedIsDropped) {
    int answered = 0;
    on_query = [&](const v1::Response&) { ++answered; };
    mailbox.push(query(1));
    mailbox.push(query(2));
    mailbox.push(SessionEnded{1});
    loop.pass();
    EXPECT_EQ(answered, 1);
}

} // namespace
} // namespace evod::runtime
