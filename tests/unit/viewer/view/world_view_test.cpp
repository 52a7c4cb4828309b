#include "client/viewer/view/world_view.h"

#include "client/viewer/drawing/window_layout.h"
#include "tests/support/waiting.h"
#include "tests/unit/core/fake_server.h"
#include "tests/unit/viewer/world/population_pages.h"

#include <gmock/gmock.h>

namespace evod::viewer {
namespace {

using testing::HasSubstr;

TEST(WorldView, HasOneTileUntilAllIslandsAreShown) {
    core::FakeServer server;
    WorldView view{{.connection = server.options(), .world = "default", .island = 2}};
    view.lay_out({0, 0, 1000, 600}, true, 1);
    EXPECT_EQ(view.place(), (Rectangle{0, 0, 1000, 600}));
    EXPECT_EQ(view.timeline_place().height, 0) << "a live world has no time line";
    ASSERT_EQ(view.tiles().size(), 1u);
    EXPECT_EQ(view.tiles()[0].island, 2u);
    EXPECT_EQ(view.camera().viewport(), viewport_of(1000, 600));
    EXPECT_EQ(&view.camera_at({500, 300}), &view.camera());
    EXPECT_EQ(&view.camera_at({-5, -5}), &view.camera());
    EXPECT_EQ(&view.island_view_of(view.tiles()[0]), &view.island_view);
}

struct WorldViewTest : testing::Test {
    WorldViewTest() {
        WantedWorld wanted{.connection = {}, .world = "default", .island = 1};
        wanted.connection = server.options();
        view.emplace(wanted);
        view->camera().set_viewport({0, 0, 1000, 1000});
        view->camera().set_island(1000, 1000);
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
            view->world.update(std::chrono::steady_clock::now());
            view->update_island(std::chrono::steady_clock::now());
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
        until([&] { return view->world.feed.snapshot() && view->world.feed.snapshot()->about.tick() == tick; });
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
        until([&] { return view->world.all_answered() && view->world.feed.gene_names().size() == 2; });
    }
    /// Shows a replay of the same run, with number 8 for snapshots.
    void show_replay() {
        view->world.show("default@3", 1);
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
    std::optional<WorldView> view; // declared before the session, which is closed first
    std::optional<core::FakeSession> session;
};

TEST_F(WorldViewTest, RequestsThePopulationOncePerGenerationIfNeeded) {
    show(4, 100);
    view->island_view.options.colour_by = ColourBy::Gene;
    EXPECT_EQ(answer_page(2, 4).get_population().first_organism(), 0u);
    EXPECT_EQ(view->island_data.population(), nullptr);
    EXPECT_EQ(answer_page(1, 4).get_population().first_organism(), 2u);
    until([&] { return view->island_data.population() != nullptr; });
    EXPECT_EQ(view->island_data.population()->generation(), 4u);
    show(4, 102);
    show(5, 104); // only now a request is sent
    EXPECT_EQ(view->island_data.population(), nullptr) << "the population is of another generation";
    answer_page(3, 5);
    until([&] { return view->island_data.population() != nullptr; });
    EXPECT_EQ(session->unread_bytes(), 0u);
}

TEST_F(WorldViewTest, RestartsWhenTheGenerationEndsBetweenPages) {
    show(4, 100);
    view->island_view.options.colour_by = ColourBy::Gene;
    answer_page(2, 4);
    answer_page(1, 5);
    EXPECT_EQ(answer_page(3, 5).get_population().first_organism(), 0u);
    show(5, 101);
    until([&] { return view->island_data.population() != nullptr; });
}

TEST_F(WorldViewTest, RequestsForcesAgainWhileTheWorldRuns) {
    show(4, 100);
    view->island_view.options.forces = Which::All;
    answer_page(3, 4);
    until([&] { return view->island_data.population() != nullptr; });
    show(4, 110);
    answer_page(3, 4);
    view->island_view.options.forces = Which::None;
}

TEST_F(WorldViewTest, RequestsOnceFromAServerWithoutSupport) {
    show(4, 100);
    view->island_view.options.radii = Which::All;
    session->refuse(next_request().request_id(), evod::v1::CODE_UNIMPLEMENTED, "what?");
    until([&] { return !view->island_data.problem().empty(); });
    EXPECT_THAT(view->island_data.problem(), HasSubstr("sends no genes"));
    show(5, 200);
    show(6, 300);
    EXPECT_EQ(session->unread_bytes(), 0u);
}

TEST_F(WorldViewTest, ReportsAnInvalidAnswer) {
    show(4, 100);
    view->island_view.options.radii = Which::All;
    const auto request = next_request();
    evod::v1::ServerMessage message;
    message.mutable_response()->set_request_id(request.request_id());
    *message.mutable_response()->mutable_population() = page_of(0, 3, 3);
    message.mutable_response()->mutable_population()->clear_genes();
    session->send(message);
    until([&] { return !view->island_data.problem().empty(); });
    EXPECT_THAT(view->island_data.problem(), HasSubstr("population.genes has 0 bytes, not 24"));
}

TEST_F(WorldViewTest, TheSelectionReturnsWithItsGeneration) {
    show(4, 100);
    view->world.feed.select(2);
    until([&] { return view->island_data.selected_organism() != nullptr; });
    view->island_data.toggle_following(view->world.feed);
    until([&] { return view->island_data.followed(); });
    show(5, 200);
    EXPECT_EQ(view->world.feed.selected(), std::nullopt);
    show(4, 90); // a seek to an earlier tick
    EXPECT_EQ(view->world.feed.selected(), 2u);
    EXPECT_TRUE(view->island_data.followed());
    view->world.feed.select(std::nullopt); // by a click beside all organisms
    show(5, 201);
    show(4, 91);
    EXPECT_EQ(view->world.feed.selected(), std::nullopt);
}

TEST_F(WorldViewTest, DeselectsTheOrganismWhenItsGenerationEnds) {
    show(4, 100);
    view->world.feed.select(2);
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
    until([&] {
        return view->island_data.selected_organism()->dead() &&
               !view->island_data.selected_organism()->ranges().empty();
    });
    show(5, 200);
    EXPECT_EQ(view->world.feed.selected(), std::nullopt);
}

/// Follows organism 2, which is at (300, 300).
struct FollowTest : WorldViewTest {
    FollowTest() {
        show(4, 100);
        camera().zoom_at({500, 500}, 4);
        view->world.feed.select(2);
        until([&] { return view->island_data.selected_organism() != nullptr; });
        view->island_data.toggle_following(view->world.feed);
        follow();
    }
    void follow() { view->island_view.follow(view->island_data, view->world.feed.view(), camera(), 1); }
    Camera& camera() { return view->camera(); }
    bool follows() { return view->island_data.followed().has_value(); }
};

TEST_F(FollowTest, KeepsTheOrganismCentredUntilTheCameraIsMoved) {
    EXPECT_EQ(camera().centre(), (Point{300, 300}));
    camera().zoom_at({0, 0}, 1.5);
    follow();
    EXPECT_TRUE(follows());
    EXPECT_EQ(camera().centre(), (Point{300, 300}));
    camera().pan({10, 0});
    follow();
    EXPECT_FALSE(follows());
    view->island_data.toggle_following(view->world.feed);
    follow();
    camera().fit();
    follow();
    EXPECT_FALSE(follows());
    EXPECT_TRUE(camera().fitted());
    view->island_data.toggle_following(view->world.feed);
    follow();
    EXPECT_FALSE(camera().fitted()) << "the camera moves closer";
    view->world.feed.select(1);
    follow();
    EXPECT_FALSE(follows()) << "another organism was selected";
    EXPECT_FALSE(camera().fitted());
}

TEST_F(FollowTest, ShowsTheWholeIslandWhenTheOrganismIsGone) {
    show(5, 200); // its generation has ended
    follow();
    EXPECT_FALSE(follows());
    EXPECT_TRUE(camera().fitted());
}

TEST_F(FollowTest, ShowsTheWholeIslandOfAnotherPlace) {
    show_replay();
    follow();
    EXPECT_FALSE(follows());
    EXPECT_TRUE(camera().fitted());
}

TEST_F(WorldViewTest, ForgetsEverythingWithAnotherRun) {
    show(4, 100);
    view->island_view.options.colour_by = ColourBy::Gene;
    view->world.feed.select(2);
    until([&] { return view->island_data.selected_organism() != nullptr; });
    show(1, 5, "b");
    EXPECT_EQ(view->world.feed.selected(), std::nullopt);
    EXPECT_EQ(view->island_data.selected_organism(), nullptr);
    EXPECT_TRUE(view->island_view.gene_names().empty());
    EXPECT_EQ(view->island_view.options.colour_by, ColourBy::Gene) << "the options are kept";
}

TEST_F(WorldViewTest, DropsRequestsOfTheLiveWorldInAReplay) {
    show(4, 100);
    view->island_view.options.radii = Which::All;
    const auto unanswered = next_request();
    EXPECT_EQ(unanswered.get_population().world(), "default");
    show_replay();
    show(4, 100, "\xaa", 8, 3, "default@3");
    const auto request = answer_page(3, 4);
    EXPECT_EQ(request.get_population().world(), "default@3");
    until([&] { return view->island_data.population() != nullptr; });
}

TEST_F(WorldViewTest, StreamsAReplayOfALargeIslandInPart) {
    show(4, 100, "\xaa", 7, StreamedRegion::organisms_min);
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
    show(4, 101, "\xaa", 8, StreamedRegion::organisms_min, "default@3");
    view_asked("default@3");
}

TEST_F(WorldViewTest, StreamsOnlyTheVisiblePartOfLargeIslands) {
    show(4, 100);
    EXPECT_EQ(session->unread_bytes(), 0u);
    show(4, 101, "\xaa", 7, StreamedRegion::organisms_min);
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
    view->camera().zoom_at({500, 500}, 10);
    const auto request = next_request();
    ASSERT_TRUE(request.has_set_view()) << request.DebugString();
    EXPECT_EQ(request.set_view().subscription_id(), 9u);
    EXPECT_LT(request.set_view().view().region().width_px(), 300);
}

TEST_F(WorldViewTest, RequestsRadiiWhileTheMousePointsAtAnOrganism) {
    show(4, 100);
    EXPECT_EQ(session->unread_bytes(), 0u) << "radii are shown, but of no organism";
    view->update_island(std::chrono::steady_clock::now(), true);
    answer_page(3, 4);
    until([&] { return view->island_data.population() != nullptr; });
}

} // namespace
} // namespace evod::viewer
