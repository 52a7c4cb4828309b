#include "client/viewer/island/island_view.h"

#include "tests/support/waiting.h"
#include "tests/unit/core/fake_server.h"
#include "tests/unit/viewer/world/population_pages.h"

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
        camera.zoom_at({500, 250}, 100); // the middle 1000 px
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

TEST_F(StreamedRegionTest, IsLargerThanTheVisiblePart) {
    const auto view = update(0ms);
    ASSERT_TRUE(view);
    EXPECT_EQ(view->detail(), evod::v1::DETAIL_FULL);
    EXPECT_TRUE(covers(view->region(), camera.visible()));
    EXPECT_LE(view->region().width_px(), 2.1 * camera.visible().width);
    EXPECT_FALSE(update(1s));
    camera.pan({100, 0}); // still inside
    EXPECT_FALSE(update(2s));
}

TEST_F(StreamedRegionTest, FollowsTheCameraAtALimitedRate) {
    ASSERT_TRUE(update(0ms));
    camera.pan({10'000, 0});
    EXPECT_FALSE(update(StreamedRegion::interval / 2));
    camera.pan({10'000, 0});
    const auto view = update(StreamedRegion::interval);
    ASSERT_TRUE(view) << "the last position is requested in the end";
    EXPECT_TRUE(covers(view->region(), camera.visible()));
}

TEST_F(StreamedRegionTest, ChangesWithTheDetailAndShrinksAfterZoomingIn) {
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

struct IslandViewTest : testing::Test {
    IslandViewTest() {
        camera.set_viewport({0, 0, 1000, 1000});
        camera.set_island(1000, 1000);
        WantedWorld wanted{.connection = {}, .world = "default", .island = 1};
        wanted.connection = server.options();
        world.emplace(wanted);
        session.emplace(server.accept_and_welcome());
        for (std::uint32_t id : {6u, 7u}) { // events, snapshots
            session->answer_subscription(session->read_request(), id);
        }
        answer_state("default");
    }

    /// Updates until the condition holds; fails after some seconds.
    template <class Condition>
    void until(Condition condition) {
        ASSERT_TRUE(wait_until(condition, [this] {
            world->update(std::chrono::steady_clock::now());
            island_view.update(*world, camera, std::chrono::steady_clock::now());
            take_a_nap();
        }));
    }
    /// The next request of the view.
    evod::v1::Request next_request() {
        until([&] { return session->unread_bytes() > 0; });
        return session->read_request();
    }
    void show(std::uint64_t generation, std::uint64_t tick, const std::string& run_id = "\xaa",
              std::uint32_t subscription_id = 7, std::uint32_t born = 3, const std::string& world_name = "default") {
        evod::v1::SnapshotFrame frame;
        frame.set_width_px(1000);
        frame.set_height_px(1000);
        codec::encode_plain({.organisms = {.id = {0, 1, 2},
                                           .x = {1600, 3200, 4800},
                                           .y = {1600, 3200, 4800},
                                           .width = {160, 160, 160},
                                           .height = {800, 960, 1120}}},
                            frame);
        frame.set_world(world_name);
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
        until([&] { return world->feed.snapshot() && world->feed.snapshot()->about.tick() == tick; });
    }
    /// Answers the query of statistics.
    void answer_state(const std::string& world_name) {
        auto request = next_request();
        for (; request.has_unsubscribe(); request = next_request()) { // of the former subscriptions
            session->answer(request);
        }
        ASSERT_TRUE(request.has_get_statistics()) << request.DebugString();
        evod::v1::ServerMessage message;
        message.mutable_response()->set_request_id(request.request_id());
        auto& info = *message.mutable_response()->mutable_statistics()->mutable_world();
        info.set_name(world_name);
        info.set_run_id("aa");
        info.set_state(evod::v1::RUN_STATE_RUNNING);
        info.add_gene_names("impulse");
        info.add_gene_names("food_radius");
        session->send(message);
        until([&] { return world->all_answered() && world->feed.gene_names().size() == 2; });
    }
    /// Shows a replay of the same run, with number 8 for snapshots.
    void show_replay() {
        world->show("default@3", 1);
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
    std::optional<ViewedWorld> world; // declared before the session, which is closed first
    std::optional<core::FakeSession> session;
    IslandView island_view;
    Camera camera;
};

TEST_F(IslandViewTest, RequestsThePopulationOncePerGenerationIfNeeded) {
    show(4, 100);
    island_view.options.colour_by = ColourBy::Gene;
    EXPECT_EQ(answer_page(2, 4).get_population().first_organism(), 0u);
    EXPECT_EQ(island_view.population(), nullptr);
    EXPECT_EQ(answer_page(1, 4).get_population().first_organism(), 2u);
    until([&] { return island_view.population() != nullptr; });
    EXPECT_EQ(island_view.population()->generation(), 4u);
    show(4, 102);
    show(5, 104); // only now a request is sent
    EXPECT_EQ(island_view.population(), nullptr) << "the population is of another generation";
    answer_page(3, 5);
    until([&] { return island_view.population() != nullptr; });
    EXPECT_EQ(session->unread_bytes(), 0u);
}

TEST_F(IslandViewTest, RestartsWhenTheGenerationEndsBetweenPages) {
    show(4, 100);
    island_view.options.colour_by = ColourBy::Gene;
    answer_page(2, 4);
    answer_page(1, 5);
    EXPECT_EQ(answer_page(3, 5).get_population().first_organism(), 0u);
    show(5, 101);
    until([&] { return island_view.population() != nullptr; });
}

TEST_F(IslandViewTest, RequestsForcesAgainWhileTheWorldRuns) {
    show(4, 100);
    island_view.options.forces = Which::All;
    answer_page(3, 4);
    until([&] { return island_view.population() != nullptr; });
    show(4, 110);
    answer_page(3, 4);
    island_view.options.forces = Which::None;
}

TEST_F(IslandViewTest, RequestsOnceFromAServerWithoutSupport) {
    show(4, 100);
    island_view.options.radii = Which::All;
    session->refuse(next_request().request_id(), evod::v1::CODE_UNIMPLEMENTED, "what?");
    until([&] { return !island_view.problem().empty(); });
    EXPECT_THAT(island_view.problem(), HasSubstr("sends no genes"));
    show(5, 200);
    show(6, 300);
    EXPECT_EQ(session->unread_bytes(), 0u);
}

TEST_F(IslandViewTest, ReportsAnInvalidAnswer) {
    show(4, 100);
    island_view.options.radii = Which::All;
    const auto request = next_request();
    evod::v1::ServerMessage message;
    message.mutable_response()->set_request_id(request.request_id());
    *message.mutable_response()->mutable_population() = page_of(0, 3, 3);
    message.mutable_response()->mutable_population()->clear_genes();
    session->send(message);
    until([&] { return !island_view.problem().empty(); });
    EXPECT_THAT(island_view.problem(), HasSubstr("population.genes has 0 bytes, not 24"));
}

TEST_F(IslandViewTest, TheSelectionReturnsWithItsGeneration) {
    show(4, 100);
    world->feed.select(2);
    until([&] { return island_view.selected_organism() != nullptr; });
    island_view.toggle_following(*world);
    until([&] { return island_view.following(); });
    show(5, 200);
    EXPECT_EQ(world->feed.selected(), std::nullopt);
    show(4, 90); // a seek to an earlier tick
    EXPECT_EQ(world->feed.selected(), 2u);
    EXPECT_TRUE(island_view.following());
    world->feed.select(std::nullopt); // by a click beside all organisms
    show(5, 201);
    show(4, 91);
    EXPECT_EQ(world->feed.selected(), std::nullopt);
}

TEST_F(IslandViewTest, DeselectsTheOrganismWhenItsGenerationEnds) {
    show(4, 100);
    world->feed.select(2);
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
    until(
        [&] { return island_view.selected_organism()->dead() && !island_view.selected_organism()->ranges().empty(); });
    show(5, 200);
    EXPECT_EQ(world->feed.selected(), std::nullopt);
}

TEST_F(IslandViewTest, FollowsTheSelectedOrganismUntilTheCameraIsMoved) {
    show(4, 100);
    island_view.toggle_following(*world);
    EXPECT_FALSE(island_view.following()) << "no organism is selected";
    world->feed.select(2);
    island_view.toggle_following(*world);
    island_view.follow(*world, camera, 1);
    EXPECT_EQ(camera.centre(), (Point{300, 300}));
    camera.zoom_at({0, 0}, 1.5);
    island_view.follow(*world, camera, 1);
    EXPECT_TRUE(island_view.following());
    EXPECT_EQ(camera.centre(), (Point{300, 300}));
    camera.pan({10, 0});
    island_view.follow(*world, camera, 1);
    EXPECT_FALSE(island_view.following());
    island_view.toggle_following(*world);
    island_view.follow(*world, camera, 1);
    camera.fit();
    island_view.follow(*world, camera, 1);
    EXPECT_FALSE(island_view.following());
    EXPECT_TRUE(camera.fitted());
    island_view.toggle_following(*world);
    world->feed.select(1);
    island_view.follow(*world, camera, 1);
    EXPECT_FALSE(island_view.following()) << "another organism was selected";
}

TEST_F(IslandViewTest, ForgetsEverythingWithAnotherRun) {
    show(4, 100);
    island_view.options.colour_by = ColourBy::Gene;
    world->feed.select(2);
    until([&] { return island_view.selected_organism() != nullptr; });
    show(1, 5, "b");
    EXPECT_EQ(world->feed.selected(), std::nullopt);
    EXPECT_EQ(island_view.selected_organism(), nullptr);
    EXPECT_TRUE(island_view.gene_names().empty());
    EXPECT_EQ(island_view.options.colour_by, ColourBy::Gene) << "the options are kept";
}

TEST_F(IslandViewTest, DropsRequestsOfTheLiveWorldInAReplay) {
    show(4, 100);
    island_view.options.radii = Which::All;
    const auto unanswered = next_request();
    EXPECT_EQ(unanswered.get_population().world(), "default");
    show_replay();
    show(4, 100, "\xaa", 8, 3, "default@3");
    const auto request = answer_page(3, 4);
    EXPECT_EQ(request.get_population().world(), "default@3");
    until([&] { return island_view.population() != nullptr; });
}

TEST_F(IslandViewTest, StreamsAReplayOfALargeIslandInPart) {
    show(4, 100, "\xaa", 7, IslandView::streamed_in_part_min);
    const auto view_asked = [&](const std::string& world_name) {
        for (;;) {
            const auto request = next_request();
            if (request.has_subscribe_snapshots() && request.subscribe_snapshots().view().has_region()) {
                EXPECT_EQ(request.subscribe_snapshots().world(), world_name);
                return session->answer_subscription(request, 9);
            }
            request.has_subscribe_snapshots() ? session->answer_subscription(request, 10) : session->answer(request);
        }
    };
    view_asked("default");
    show_replay();
    show(4, 101, "\xaa", 8, IslandView::streamed_in_part_min, "default@3");
    view_asked("default@3");
}

TEST_F(IslandViewTest, StreamsOnlyTheVisiblePartOfLargeIslands) {
    show(4, 100);
    EXPECT_EQ(session->unread_bytes(), 0u);
    show(4, 101, "\xaa", 7, IslandView::streamed_in_part_min);
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

TEST_F(IslandViewTest, RequestsRadiiWhileTheMousePointsAtAnOrganism) {
    show(4, 100);
    EXPECT_EQ(session->unread_bytes(), 0u) << "radii are shown, but of no organism";
    island_view.update(*world, camera, std::chrono::steady_clock::now(), true);
    answer_page(3, 4);
    until([&] { return island_view.population() != nullptr; });
}

TEST(IslandView, TheClassicSkinAddsNothingByDefault) {
    const ViewOptions classic = default_options({Skin::Classic});
    EXPECT_FALSE(classic.trails || classic.flashes);
    EXPECT_EQ(classic.radii, Which::None);
    EXPECT_EQ(classic.forces, Which::None);
    const ViewOptions vivid = default_options({Skin::Vivid, Background::Light});
    EXPECT_EQ(vivid.look, (Look{Skin::Vivid, Background::Light}));
    EXPECT_EQ(default_options({}), ViewOptions{});
}

TEST(IslandView, CyclesThroughTheColourings) {
    IslandView island_view;
    std::vector<ColourBy> seen;
    for (int i = 0; i < 4; ++i) {
        island_view.next_colouring();
        seen.push_back(island_view.options.colour_by);
    }
    EXPECT_THAT(seen, testing::ElementsAre(ColourBy::Health, ColourBy::Nothing, ColourBy::Health, ColourBy::Nothing))
        << "genes only once they are known";
}

} // namespace
} // namespace evod::viewer
