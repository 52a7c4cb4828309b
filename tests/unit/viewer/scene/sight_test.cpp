#include "client/viewer/scene/sight.h"

#include "tests/support/waiting.h"
#include "tests/unit/core/fake_server.h"
#include "tests/unit/viewer/watch/population_pages.h"

#include <gmock/gmock.h>

#include <thread>

namespace evod::viewer {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

// ---- the region ------------------------------------------------------------------------------------------------

struct StreamedRegionTest : testing::Test {
    StreamedRegionTest() {
        camera.set_viewport({0, 0, 1000, 500});
        camera.set_island(100'000, 50'000);
        camera.zoom_at({500, 250}, 100); // of the middle, 1000 px wide
        camera.zoom_at({500, 250}, 1000 / camera.visible().height / 2);
    }
    std::optional<evod::v1::View> update(std::chrono::milliseconds after,
                                         evod::v1::Detail detail = evod::v1::DETAIL_FULL) {
        return region.update(camera, detail, StreamedRegion::Clock::time_point{} + 10s + after);
    }
    static bool covers(const evod::v1::Region& region, const Rectangle& seen) {
        return region.left_px() <= seen.left && region.top_px() <= seen.top &&
               region.left_px() + region.width_px() >= seen.left + seen.width &&
               region.top_px() + region.height_px() >= seen.top + seen.height;
    }
    Camera camera;
    StreamedRegion region;
};

TEST_F(StreamedRegionTest, IsWhatIsSeenAndALittleMore) {
    const auto view = update(0ms);
    ASSERT_TRUE(view);
    EXPECT_EQ(view->detail(), evod::v1::DETAIL_FULL);
    EXPECT_TRUE(covers(view->region(), camera.visible()));
    EXPECT_LE(view->region().width_px(), 2.1 * camera.visible().width);
    EXPECT_FALSE(update(1s));
    camera.pan({100, 0}); // still within
    EXPECT_FALSE(update(2s));
}

TEST_F(StreamedRegionTest, FollowsTheCameraButNotAtEveryPicture) {
    ASSERT_TRUE(update(0ms));
    camera.pan({10'000, 0});
    EXPECT_FALSE(update(StreamedRegion::between / 2));
    camera.pan({10'000, 0});
    const auto view = update(StreamedRegion::between);
    ASSERT_TRUE(view) << "the last place is not forgotten";
    EXPECT_TRUE(covers(view->region(), camera.visible()));
}

TEST_F(StreamedRegionTest, AsksForAnotherDetailAndForLessWhenMuchIsNotSeen) {
    ASSERT_TRUE(update(0ms));
    const auto density = update(1s, evod::v1::DETAIL_DENSITY);
    ASSERT_TRUE(density);
    EXPECT_EQ(density->detail(), evod::v1::DETAIL_DENSITY);
    camera.zoom_at({500, 250}, 2);
    EXPECT_FALSE(update(2s, evod::v1::DETAIL_DENSITY));
    camera.zoom_at({500, 250}, 4);
    const auto less = update(3s, evod::v1::DETAIL_DENSITY);
    ASSERT_TRUE(less);
    EXPECT_LT(less->region().width_px(), density->region().width_px() / 4);
}

// ---- against a server ------------------------------------------------------------------------------------------

struct SightTest : testing::Test {
    SightTest() {
        camera.set_viewport({0, 0, 1000, 1000});
        camera.set_island(1000, 1000);
        Watch::Wanted wanted{.connection = {}, .world = "default", .island = 1};
        wanted.connection = server.options();
        watch.emplace(wanted);
        session.emplace(server.accept_and_welcome());
        for (std::uint32_t id : {6u, 7u}) { // events, pictures
            session->answer_subscription(session->read_request(), id);
        }
        answer_state("default");
    }

    /// Updates until the condition holds; fails if it does not within some seconds.
    template <class Condition>
    void until(Condition condition) {
        ASSERT_TRUE(wait_until(condition, [this] {
            watch->update(std::chrono::steady_clock::now());
            sight.update(*watch, camera, std::chrono::steady_clock::now());
            take_a_nap();
        }));
    }
    /// The next request that the sight makes.
    evod::v1::Request next_request() {
        until([&] { return session->unread_bytes() > 0; });
        return session->read_request();
    }
    void show(std::uint64_t generation, std::uint64_t tick, const std::string& run_id = "\xaa",
              std::uint32_t subscription_id = 7, std::uint32_t born = 3, const std::string& world = "default") {
        evod::v1::SnapshotFrame frame;
        frame.set_width_px(1000);
        frame.set_height_px(1000);
        codec::encode({.organisms = {.id = {0, 1, 2},
                                     .x = {1600, 3200, 4800},
                                     .y = {1600, 3200, 4800},
                                     .width = {160, 160, 160},
                                     .height = {800, 960, 1120}}},
                      frame);
        frame.set_world(world);
        frame.set_run_id(run_id);
        frame.set_subscription_id(subscription_id);
        frame.set_island(1);
        frame.set_island_count(2);
        frame.set_generation(generation);
        frame.set_tick(tick);
        frame.set_simulated_s(static_cast<double>(tick) / 60);
        frame.set_state(evod::v1::RUN_STATE_RUNNING);
        frame.mutable_live()->set_organism_count(born);
        session->send(frame);
        until([&] { return watch->picture() && watch->picture()->about.tick() == tick; });
    }
    /// Answers how things stand.
    void answer_state(const std::string& world) {
        auto request = next_request();
        for (; request.has_unsubscribe(); request = next_request()) { // from what was shown before
            session->answer(request);
        }
        ASSERT_TRUE(request.has_get_statistics()) << request.DebugString();
        evod::v1::ServerMessage message;
        message.mutable_response()->set_request_id(request.request_id());
        auto& told = *message.mutable_response()->mutable_statistics()->mutable_world();
        told.set_name(world);
        told.set_run_id("aa");
        told.set_state(evod::v1::RUN_STATE_RUNNING);
        told.add_gene_names("impulse");
        told.add_gene_names("food_radius");
        session->send(message);
        until([&] { return watch->all_answered() && watch->gene_names().size() == 2; });
    }
    /// Another place with the same run, of which pictures come as subscription 8.
    void look_at_the_past() {
        watch->look_at("default@3", 1);
        for (bool subscribed = false; !subscribed;) {
            const auto request = next_request();
            subscribed = request.subscribe_snapshots().world() == "default@3";
            if (subscribed) {
                EXPECT_FALSE(request.subscribe_snapshots().has_view());
            }
            if (request.has_subscribe_snapshots()) {
                session->answer_subscription(request, subscribed ? 8 : 10);
            }
        }
        answer_state("default@3");
    }
    evod::v1::Request answer_page(std::uint32_t count, std::uint64_t generation) {
        const auto request = next_request();
        EXPECT_TRUE(request.has_get_population()) << request.DebugString();
        EXPECT_EQ(request.get_population().island(), 1u);
        evod::v1::ServerMessage message;
        message.mutable_response()->set_request_id(request.request_id());
        *message.mutable_response()->mutable_population() =
            page_of(request.get_population().first_organism(), count, 3, generation);
        session->send(message);
        return request;
    }

    core::FakeServer server;
    std::optional<Watch> watch; // before the session, which is closed first
    std::optional<core::FakeSession> session;
    Sight sight;
    Camera camera;
};

TEST_F(SightTest, APopulationIsAskedForOnceAGenerationInPagesAndOnlyIfItIsNeeded) {
    show(4, 100);
    sight.shown.colour_by = ColourBy::Gene;
    EXPECT_EQ(answer_page(2, 4).get_population().first_organism(), 0u);
    EXPECT_EQ(sight.population(), nullptr);
    EXPECT_EQ(answer_page(1, 4).get_population().first_organism(), 2u);
    until([&] { return sight.population() != nullptr; });
    EXPECT_EQ(sight.population()->generation(), 4u);
    show(4, 102);
    show(5, 104); // only now something is asked
    EXPECT_EQ(sight.population(), nullptr) << "these are others";
    answer_page(3, 5);
    until([&] { return sight.population() != nullptr; });
    EXPECT_EQ(session->unread_bytes(), 0u);
}

TEST_F(SightTest, APopulationOfWhichTheGenerationEndsBetweenPagesIsBegunAnew) {
    show(4, 100);
    sight.shown.colour_by = ColourBy::Lineage;
    answer_page(2, 4);
    answer_page(1, 5);
    EXPECT_EQ(answer_page(3, 5).get_population().first_organism(), 0u);
    show(5, 101);
    until([&] { return sight.population() != nullptr; });
}

TEST_F(SightTest, ForcesAreAskedForAgainWhileTheWorldGoesOn) {
    show(4, 100);
    sight.shown.forces = true;
    answer_page(3, 4);
    until([&] { return sight.population() != nullptr; });
    show(4, 110);
    answer_page(3, 4);
    sight.shown.forces = false;
}

TEST_F(SightTest, AServerThatDoesNotKnowTheQuestionIsAskedOnce) {
    show(4, 100);
    sight.shown.radii = true;
    session->refuse(next_request().request_id(), evod::v1::CODE_UNIMPLEMENTED, "what?");
    until([&] { return !sight.trouble().empty(); });
    EXPECT_THAT(sight.trouble(), HasSubstr("does not tell of genes"));
    show(5, 200);
    show(6, 300);
    EXPECT_EQ(session->unread_bytes(), 0u);
}

TEST_F(SightTest, AnAnswerThatCannotBeReadIsTold) {
    show(4, 100);
    sight.shown.radii = true;
    const auto request = next_request();
    evod::v1::ServerMessage message;
    message.mutable_response()->set_request_id(request.request_id());
    *message.mutable_response()->mutable_population() = page_of(0, 3, 3);
    message.mutable_response()->mutable_population()->clear_genes();
    session->send(message);
    until([&] { return !sight.trouble().empty(); });
    EXPECT_THAT(sight.trouble(), HasSubstr("population.genes has 0 bytes, not 24"));
}

TEST_F(SightTest, TheSelectedOneIsAskedForAndIsNobodyAnyMoreWhenItsGenerationIsOver) {
    show(4, 100);
    watch->select(2);
    bool asked_population = false, asked_organism = false;
    while (!asked_population || !asked_organism) {
        const auto request = next_request();
        evod::v1::ServerMessage message;
        message.mutable_response()->set_request_id(request.request_id());
        if (request.has_get_population()) {
            asked_population = true;
            *message.mutable_response()->mutable_population() = page_of(0, 3, 3, 4);
        } else {
            asked_organism = true;
            EXPECT_EQ(request.get_organism().organism(), 2u);
            auto& info = *message.mutable_response()->mutable_organism();
            info.set_id(2);
            info.set_generation(4);
            info.set_alive(false);
            info.set_cause_of_death(evod::v1::CAUSE_OF_DEATH_STARVED);
        }
        session->send(message);
    }
    until([&] { return sight.story()->dead() && !sight.story()->ranges().empty(); });
    EXPECT_EQ(sight.story()->health().back().health, 70);
    show(5, 200);
    EXPECT_EQ(watch->selected(), std::nullopt);
    answer_page(3, 5); // page_of: 0 of 1 and 2, 1 of 2 and 3
    until([&] { return sight.story()->children().has_value(); });
    EXPECT_EQ(sight.story()->children()->size(), 2u);
}

TEST_F(SightTest, FollowingKeepsTheSelectedOneInTheMiddleUntilAHandMovesThePicture) {
    show(4, 100);
    sight.toggle_following(*watch);
    EXPECT_FALSE(sight.following()) << "nobody is selected";
    watch->select(2);
    sight.toggle_following(*watch);
    sight.follow(*watch, camera, 1);
    EXPECT_EQ(camera.centre(), (Point{300, 300}));
    camera.zoom_at({0, 0}, 1.5);
    sight.follow(*watch, camera, 1);
    EXPECT_TRUE(sight.following());
    EXPECT_EQ(camera.centre(), (Point{300, 300}));
    camera.pan({10, 0});
    sight.follow(*watch, camera, 1);
    EXPECT_FALSE(sight.following());
    sight.toggle_following(*watch);
    sight.follow(*watch, camera, 1);
    camera.fit();
    sight.follow(*watch, camera, 1);
    EXPECT_FALSE(sight.following());
    EXPECT_TRUE(camera.fitted());
    sight.toggle_following(*watch);
    watch->select(1);
    sight.follow(*watch, camera, 1);
    EXPECT_FALSE(sight.following()) << "somebody else was selected";
}

TEST_F(SightTest, AnotherRunIsKnownNothingOf) {
    show(4, 100);
    sight.shown.colour_by = ColourBy::Gene;
    watch->select(2);
    until([&] { return sight.story() != nullptr; });
    show(1, 5, "b");
    EXPECT_EQ(watch->selected(), std::nullopt);
    EXPECT_EQ(sight.story(), nullptr);
    EXPECT_TRUE(sight.gene_names().empty());
    EXPECT_EQ(sight.shown.colour_by, ColourBy::Gene) << "the switches stay";
}

TEST_F(SightTest, WhatWasAskedOfThePresentIsNotWaitedForInThePast) {
    show(4, 100);
    sight.shown.radii = true;
    const auto unanswered = next_request();
    EXPECT_EQ(unanswered.get_population().world(), "default");
    look_at_the_past();
    show(4, 100, "\xaa", 8, 3, "default@3");
    const auto request = answer_page(3, 4);
    EXPECT_EQ(request.get_population().world(), "default@3");
    until([&] { return sight.population() != nullptr; });
}

TEST_F(SightTest, AlsoThePastOfALargeIslandIsStreamedInPart) {
    show(4, 100, "\xaa", 7, Sight::streamed_in_part_min);
    const auto view_asked = [&](const std::string& world) {
        for (;;) {
            const auto request = next_request();
            if (request.has_subscribe_snapshots() && request.subscribe_snapshots().view().has_region()) {
                EXPECT_EQ(request.subscribe_snapshots().world(), world);
                return session->answer_subscription(request, 9);
            }
            request.has_subscribe_snapshots() ? session->answer_subscription(request, 10) : session->answer(request);
        }
    };
    view_asked("default");
    look_at_the_past();
    show(4, 101, "\xaa", 8, Sight::streamed_in_part_min, "default@3");
    view_asked("default@3");
}

TEST_F(SightTest, SmallIslandsAreShownWholeAndOfLargeOnesWhatIsSeen) {
    show(4, 100);
    EXPECT_EQ(session->unread_bytes(), 0u);
    show(4, 101, "\xaa", 7, Sight::streamed_in_part_min);
    std::optional<evod::v1::View> seen, overview;
    std::uint32_t unsubscribed = 0;
    while (!seen || !overview) {
        const auto request = next_request();
        if (request.has_unsubscribe()) {
            unsubscribed = request.unsubscribe().subscription_id();
            session->answer(request);
        } else if (request.has_subscribe_snapshots()) {
            ASSERT_TRUE(request.subscribe_snapshots().has_view());
            const evod::v1::View& view = request.subscribe_snapshots().view();
            (view.has_region() ? seen : overview) = view;
            session->answer_subscription(request, view.has_region() ? 9 : 10);
        } else {
            session->answer(request);
        }
    }
    EXPECT_EQ(unsubscribed, 7u);
    EXPECT_EQ(seen->detail(), evod::v1::DETAIL_FULL);
    EXPECT_EQ(overview->detail(), evod::v1::DETAIL_DENSITY);
    camera.zoom_at({500, 500}, 10);
    const auto request = next_request();
    ASSERT_TRUE(request.has_set_view()) << request.DebugString();
    EXPECT_EQ(request.set_view().subscription_id(), 9u);
    EXPECT_LT(request.set_view().view().region().width_px(), 300);
}

TEST(Sight, ColoursAreGoneThrough) {
    Sight sight;
    std::vector<ColourBy> seen;
    for (int i = 0; i < 4; ++i) {
        sight.next_colouring();
        seen.push_back(sight.shown.colour_by);
    }
    EXPECT_THAT(seen, testing::ElementsAre(ColourBy::Health, ColourBy::Lineage, ColourBy::Nothing, ColourBy::Health))
        << "genes only where they are known";
}

} // namespace
} // namespace evod::viewer
