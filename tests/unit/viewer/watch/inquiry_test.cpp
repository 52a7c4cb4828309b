#include "client/viewer/watch/inquiry.h"

#include "tests/support/waiting.h"
#include "tests/unit/core/fake_server.h"

#include <gmock/gmock.h>

namespace evod::viewer {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;

struct InquiryTest : testing::Test {
    InquiryTest() {
        Watch::Wanted wanted{.connection = {}, .world = "default", .all_islands = true};
        wanted.connection = server.options();
        watch.emplace(wanted);
        session.emplace(server.accept_and_welcome());
        for (std::uint32_t id : {6u, 7u}) { // events, pictures
            session->answer_subscription(session->read_request(), id);
        }
        until([&] { return session->unread_bytes() > 0; });
        session->answer(session->read_request()); // how things stand
        until([&] { return watch->all_answered(); });
    }

    template <class Condition>
    void until(Condition condition) {
        ASSERT_TRUE(wait_until(condition, [this] {
            watch->update(std::chrono::steady_clock::now());
            take_a_nap();
        }));
    }
    /// Asks, and returns what the server is asked.
    evod::v1::Request ask() {
        evod::v1::Request request;
        request.mutable_get_metrics();
        inquiry->ask(*watch, std::move(request), now, [this](const evod::v1::Response* response) {
            heard.push_back(response != nullptr ? static_cast<int>(response->applied_tick()) : -1);
        });
        return session->read_request();
    }
    void take_all() {
        until([&] { return watch->all_answered(); });
    }

    core::FakeServer server;
    std::optional<Watch> watch; // before the session, which is closed first
    std::optional<core::FakeSession> session;
    std::optional<Inquiry> inquiry{std::in_place, 1h};
    const Inquiry::Clock::time_point now = Inquiry::Clock::now();
    std::vector<int> heard; // ticks; -1: a refusal
};

TEST_F(InquiryTest, IsAskedAgainAfterThePauseOrAsSoonAsItIsOutOfDate) {
    EXPECT_TRUE(inquiry->due(*watch, now));
    const auto question = ask();
    EXPECT_FALSE(inquiry->due(*watch, now));
    session->answer(question, 5);
    take_all();
    EXPECT_THAT(heard, ElementsAre(5));
    EXPECT_FALSE(inquiry->due(*watch, now + 59min));
    EXPECT_TRUE(inquiry->due(*watch, now + 61min));
    inquiry->hurry();
    EXPECT_TRUE(inquiry->due(*watch, now));
    ask();
    inquiry->hurry();
    EXPECT_FALSE(inquiry->due(*watch, now)) << "one at a time";
}

TEST_F(InquiryTest, ARefusalIsToldUntilTheNextAnswer) {
    session->refuse(ask().request_id(), evod::v1::CODE_NOT_FOUND, "no such world");
    take_all();
    EXPECT_THAT(heard, ElementsAre(-1));
    EXPECT_EQ(inquiry->trouble(), "No such world");
    EXPECT_FALSE(inquiry->is_unknown());
    EXPECT_FALSE(inquiry->due(*watch, now));
    EXPECT_TRUE(inquiry->due(*watch, Inquiry::Clock::now() + Inquiry::after_refusal));
    session->refuse(ask().request_id(), evod::v1::CODE_UNIMPLEMENTED, "what?");
    take_all();
    EXPECT_TRUE(inquiry->is_unknown());
    session->answer(ask(), 7);
    take_all();
    EXPECT_EQ(inquiry->trouble(), "");
    EXPECT_FALSE(inquiry->is_unknown());
}

TEST_F(InquiryTest, OfTwoQuestionsOnlyTheSecondIsAnswered) {
    const auto first = ask(), second = ask();
    session->answer(first, 1);
    session->answer(second, 2);
    take_all();
    EXPECT_THAT(heard, ElementsAre(2));
}

TEST_F(InquiryTest, WhatWasAskedAboutAnotherPlaceIsNotBelieved) {
    const auto question = ask();
    watch->choose_island(2);
    EXPECT_TRUE(inquiry->due(*watch, now)) << "of this place nothing was asked";
    session->answer(question, 1);
    take_all();
    EXPECT_THAT(heard, ElementsAre());
    EXPECT_TRUE(inquiry->due(*watch, now));
}

TEST_F(InquiryTest, WhatWasAskedOfAnotherWatchIsNotBelieved) {
    const auto question = ask();
    Watch::Wanted wanted{.connection = {}, .world = "default", .all_islands = true};
    wanted.connection = server.options();
    const Watch beside{wanted};
    EXPECT_TRUE(inquiry->due(beside, now)) << "the panel is for the other half now";
    session->answer(question, 1);
    take_all();
    EXPECT_THAT(heard, ElementsAre());
}

TEST_F(InquiryTest, AnAnswerToNobodyIsDropped) {
    const auto question = ask();
    inquiry.reset();
    session->answer(question, 1);
    take_all();
    EXPECT_THAT(heard, ElementsAre());
}

TEST_F(InquiryTest, WhatIsForgottenIsNotBelievedAndMayBeAskedAtOnce) {
    const auto question = ask();
    inquiry->forget();
    EXPECT_TRUE(inquiry->due(*watch, now));
    session->answer(question, 1);
    take_all();
    EXPECT_THAT(heard, ElementsAre());
}

TEST_F(InquiryTest, HasPatienceButNotForEver) {
    ask();
    EXPECT_FALSE(inquiry->due(*watch, now + Inquiry::patience));
    EXPECT_TRUE(inquiry->due(*watch, now + Inquiry::patience + 1ms));
}

} // namespace
} // namespace evod::viewer
