#include "client/viewer/world/poll.h"

#include "tests/support/waiting.h"
#include "tests/unit/core/fake_server.h"

#include <gmock/gmock.h>

namespace evod::viewer {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;

struct PollTest : testing::Test {
    PollTest() {
        WantedWorld wanted{.connection = {}, .world = "default", .all_islands = true};
        wanted.connection = server.options();
        world.emplace(wanted);
        session.emplace(server.accept_and_welcome());
        for (std::uint32_t id : {6u, 7u}) { // events, snapshots
            session->answer_subscription(session->read_request(), id);
        }
        until([&] { return session->unread_bytes() > 0; });
        session->answer(session->read_request()); // statistics
        until([&] { return world->all_answered(); });
    }

    template <class Condition>
    void until(Condition condition) {
        ASSERT_TRUE(wait_until(condition, [this] {
            world->update(std::chrono::steady_clock::now());
            take_a_nap();
        }));
    }
    /// Sends a request, and returns it as the server received it.
    evod::v1::Request ask() {
        evod::v1::Request request;
        request.mutable_get_metrics();
        poll->send(*world, std::move(request), now, [this](const evod::v1::Response* response) {
            received.push_back(response != nullptr ? static_cast<int>(response->applied_tick()) : -1);
        });
        return session->read_request();
    }
    void take_all() {
        until([&] { return world->all_answered(); });
    }

    core::FakeServer server;
    std::optional<ViewedWorld> world; // declared before the session, which is closed first
    std::optional<core::FakeSession> session;
    std::optional<Poll> poll{std::in_place, 1h};
    const Poll::Clock::time_point now = Poll::Clock::now();
    std::vector<int> received; // ticks; -1: a refusal
};

TEST_F(PollTest, SendsAgainAfterTheIntervalOrWhenHurried) {
    EXPECT_TRUE(poll->due(*world, now));
    const auto question = ask();
    EXPECT_FALSE(poll->due(*world, now));
    session->answer(question, 5);
    take_all();
    EXPECT_THAT(received, ElementsAre(5));
    EXPECT_FALSE(poll->due(*world, now + 59min));
    EXPECT_TRUE(poll->due(*world, now + 61min));
    poll->make_due();
    EXPECT_TRUE(poll->due(*world, now));
    ask();
    poll->make_due();
    EXPECT_FALSE(poll->due(*world, now)) << "one at a time";
}

TEST_F(PollTest, KeepsARefusalUntilTheNextAnswer) {
    session->refuse(ask().request_id(), evod::v1::CODE_NOT_FOUND, "no such world");
    take_all();
    EXPECT_THAT(received, ElementsAre(-1));
    EXPECT_EQ(poll->problem(), "No such world");
    EXPECT_FALSE(poll->is_unsupported());
    EXPECT_FALSE(poll->due(*world, now));
    EXPECT_TRUE(poll->due(*world, Poll::Clock::now() + Poll::after_refusal));
    session->refuse(ask().request_id(), evod::v1::CODE_UNIMPLEMENTED, "what?");
    take_all();
    EXPECT_TRUE(poll->is_unsupported());
    session->answer(ask(), 7);
    take_all();
    EXPECT_EQ(poll->problem(), "");
    EXPECT_FALSE(poll->is_unsupported());
}

TEST_F(PollTest, DropsTheAnswerToTheFirstOfTwoRequests) {
    const auto first = ask(), second = ask();
    session->answer(first, 1);
    session->answer(second, 2);
    take_all();
    EXPECT_THAT(received, ElementsAre(2));
}

TEST_F(PollTest, DropsAnswersAboutAnotherIsland) {
    const auto question = ask();
    world->feed.choose_island(2);
    EXPECT_TRUE(poll->due(*world, now)) << "nothing was requested about this island";
    session->answer(question, 1);
    take_all();
    EXPECT_THAT(received, ElementsAre());
    EXPECT_TRUE(poll->due(*world, now));
}

TEST_F(PollTest, DropsAnswersAboutAnotherWorld) {
    const auto question = ask();
    WantedWorld wanted{.connection = {}, .world = "default", .all_islands = true};
    wanted.connection = server.options();
    const ViewedWorld beside{wanted};
    EXPECT_TRUE(poll->due(beside, now)) << "the panel now shows the other world";
    session->answer(question, 1);
    take_all();
    EXPECT_THAT(received, ElementsAre());
}

TEST_F(PollTest, DropsAnswersAfterItsDestruction) {
    const auto question = ask();
    poll.reset();
    session->answer(question, 1);
    take_all();
    EXPECT_THAT(received, ElementsAre());
}

TEST_F(PollTest, AResetDropsTheAnswerAndIsDueAtOnce) {
    const auto question = ask();
    poll->reset();
    EXPECT_TRUE(poll->due(*world, now));
    session->answer(question, 1);
    take_all();
    EXPECT_THAT(received, ElementsAre());
}

TEST_F(PollTest, SendsAgainAfterTheAnswerTimeout) {
    ask();
    EXPECT_FALSE(poll->due(*world, now + Poll::answer_timeout));
    EXPECT_TRUE(poll->due(*world, now + Poll::answer_timeout + 1ms));
}

} // namespace
} // namespace evod::viewer
