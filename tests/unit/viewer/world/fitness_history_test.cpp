#include "client/viewer/world/fitness_history.h"

#include "tests/unit/viewer/world/viewed_world_fixture.h"

namespace evod::viewer {
namespace {

struct FitnessHistoryTest : ViewedWorldTest {
    FitnessHistoryTest() {
        world.emplace(wanted());
        session.emplace(begin(*world));
        until(*world, [&] { return session->unread_bytes() > 0; });
        answer_statistics(*session, session->read_request());
        until(*world, [&] { return world->all_answered(); });
    }

    /// Updates until the history has sent a request for its next page.
    evod::v1::Request next_request() {
        until(*world, [&] {
            history.update(*world, Poll::Clock::now());
            return session->unread_bytes() > 0;
        });
        return session->read_request();
    }
    /// Two islands with 10 and 30 organisms in each generation.
    template <class Message>
    static void add_generation(Message& message, std::uint64_t generation) {
        for (std::uint32_t island = 0; island < 2; ++island) {
            evod::v1::GenerationStatistics added;
            added.set_generation(generation);
            added.set_island(island);
            added.set_organism_count(island == 0 ? 10 : 30);
            added.set_fitness_best(static_cast<double>(generation) * 10 - island);
            added.set_fitness_mean(island == 0 ? 4 : 8);
            *message.Add() = added;
        }
    }
    void answer(const evod::v1::Request& request, std::uint64_t last, std::uint64_t next_page = 0) {
        ASSERT_TRUE(request.has_get_history()) << request.DebugString();
        evod::v1::ServerMessage message;
        message.mutable_response()->set_request_id(request.request_id());
        auto& page = *message.mutable_response()->mutable_history();
        for (auto generation = request.get_history().first_generation(); generation <= last; ++generation) {
            add_generation(*page.mutable_generations(), generation);
        }
        if (next_page != 0) {
            page.set_next_generation(next_page);
        }
        session->send(message);
        until(*world, [&] { return world->all_answered(); });
    }
    void finish(std::uint64_t generation) {
        evod::v1::ServerMessage message;
        message.mutable_event()->set_world("default");
        message.mutable_event()->set_run_id("aa");
        add_generation(*message.mutable_event()->mutable_generation_finished()->mutable_statistics(), generation);
        session->send(message);
        until(*world, [&] { return !world->feed.events().empty(); });
        history.update(*world, Poll::Clock::now());
    }

    std::optional<ViewedWorld> world; // declared before the session, which is closed first
    std::optional<core::FakeSession> session;
    FitnessHistory history;
};

TEST_F(FitnessHistoryTest, ReadsAllPagesAndThenEvents) {
    const auto first = next_request();
    EXPECT_EQ(first.get_history().first_generation(), 1u);
    EXPECT_FALSE(history.complete());
    answer(first, 2, 3);
    const auto second = next_request();
    EXPECT_EQ(second.get_history().first_generation(), 3u);
    answer(second, 4);
    EXPECT_TRUE(history.complete());
    ASSERT_EQ(history.generations().size(), 4u);
    EXPECT_EQ(history.generations()[3].number, 4u);
    EXPECT_EQ(history.generations()[3].best, 40);
    EXPECT_EQ(history.generations()[3].mean, 7) << "of all organisms";
    finish(5);
    EXPECT_EQ(history.generations().size(), 5u);
    EXPECT_TRUE(history.complete());
    EXPECT_EQ(session->unread_bytes(), 0u);
}

TEST_F(FitnessHistoryTest, RequestsTheGenerationsThatItHasMissed) {
    answer(next_request(), 2);
    finish(5);
    const auto missing = next_request();
    EXPECT_EQ(missing.get_history().first_generation(), 3u);
    answer(missing, 5);
    EXPECT_EQ(history.generations().size(), 5u);
    EXPECT_TRUE(history.complete());
}

TEST_F(FitnessHistoryTest, ARefusedRequestIsSentAgain) {
    const auto request = next_request();
    session->refuse(request.request_id(), evod::v1::CODE_UNAVAILABLE, "busy");
    until(*world, [&] { return world->all_answered(); });
    EXPECT_FALSE(history.complete());
    until(*world, [&] {
        history.update(*world, Poll::Clock::now() + Poll::after_refusal);
        return session->unread_bytes() > 0;
    });
    answer(session->read_request(), 1);
    EXPECT_TRUE(history.complete());
}

} // namespace
} // namespace evod::viewer
