#include "client/viewer/world/mouse_tool.h"

#include "tests/unit/viewer/world/viewed_world_fixture.h"

namespace evod::viewer {
namespace {

using testing::ElementsAre;
using Kind = MouseTool::Kind;

const MouseTool::Target empty{.island = 2, .generation = 7, .x_px = 30, .y_px = 40.5};

TEST(MouseTool, PlacesFoodPoisonAndOrganisms) {
    MouseTool tool;
    for (const auto& [kind, item] :
         {std::pair{Kind::Food, evod::v1::ITEM_KIND_FOOD}, {Kind::Poison, evod::v1::ITEM_KIND_POISON}}) {
        tool.choose(kind);
        const auto request = tool.request("w", empty);
        ASSERT_TRUE(request);
        EXPECT_EQ(request->place().world(), "w");
        EXPECT_EQ(request->place().island(), 2u);
        ASSERT_EQ(request->place().items_size(), 1);
        EXPECT_EQ(request->place().items(0).kind(), item);
        EXPECT_EQ(request->place().items(0).x_px(), 30);
        EXPECT_EQ(request->place().items(0).y_px(), 40.5);
        EXPECT_EQ(request->place().organisms_size(), 0);
    }
    EXPECT_EQ(tool.hint(empty), "Place poison");
    tool.place({"fast", {1, 2, 3, 4, 5, 6}});
    EXPECT_EQ(tool.kind(), Kind::Organism);
    EXPECT_EQ(tool.hint(empty), "Place fast");
    const auto request = tool.request("w", empty);
    ASSERT_EQ(request->place().organisms_size(), 1);
    EXPECT_THAT(request->place().organisms(0).genes(), ElementsAre(1, 2, 3, 4, 5, 6));
    EXPECT_EQ(request->place().organisms(0).y_px(), 40.5);
}

TEST(MouseTool, RemovesWhatIsUnderTheMouse) {
    MouseTool tool;
    tool.choose(Kind::Remove);
    EXPECT_FALSE(tool.request("w", empty));
    EXPECT_EQ(tool.hint(empty), "Nothing to remove here");
    MouseTool::Target target = empty;
    target.poison = 5;
    EXPECT_EQ(tool.hint(target), "Remove poison");
    EXPECT_THAT(tool.request("w", target)->remove().poison(), ElementsAre(5));
    target.food = 6;
    EXPECT_EQ(tool.hint(target), "Remove food");
    EXPECT_THAT(tool.request("w", target)->remove().food(), ElementsAre(6));
    target.organism = 12;
    EXPECT_EQ(tool.hint(target), "Remove organism 12");
    const auto request = tool.request("w", target);
    EXPECT_THAT(request->remove().organisms(), ElementsAre(12));
    EXPECT_EQ(request->remove().food_size() + request->remove().poison_size(), 0);
    EXPECT_EQ(request->remove().generation(), 7u) << "the ids belong to it";
    EXPECT_EQ(request->remove().island(), 2u);
}

TEST(MouseTool, ADragPlacesOnceWhereItEnds) {
    MouseTool tool;
    EXPECT_FALSE(tool.take_drop());
    tool.drag({"fast", {1}});
    EXPECT_TRUE(tool.dragging());
    EXPECT_FALSE(tool.take_drop());
    EXPECT_TRUE(tool.dragging()) << "still";
    tool.drop();
    EXPECT_FALSE(tool.dragging());
    EXPECT_TRUE(tool.take_drop());
    EXPECT_FALSE(tool.take_drop());
}

struct MouseToolInWorldTest : ViewedWorldTest {
    /// Welcomes the viewer like begin(), with these features.
    core::FakeSession begin_with(ViewedWorld& world, std::vector<std::string> features,
                                 evod::v1::Role role = evod::v1::ROLE_CONTROLLER) {
        core::FakeSession session = server.accept();
        session.welcome(0, role, std::move(features));
        session.answer_subscription(session.read_request(), 6);
        session.answer_subscription(session.read_request(), 7);
        show_first_snapshot(world, session, 50);
        return session;
    }
    MouseTool tool;
};

TEST_F(MouseToolInWorldTest, IsDisabledWhereTheServerLacksTheFeature) {
    ViewedWorld world{wanted()};
    auto session = begin_with(world, {"codec:plain"});
    EXPECT_EQ(tool.problem(Kind::Select, world), "");
    EXPECT_THAT(tool.problem(Kind::Food, world), testing::HasSubstr("a newer version of evod can"));
    tool.choose(Kind::Food);
    tool.click(world, empty);
    EXPECT_TRUE(world.all_answered()) << "nothing was sent";
    EXPECT_THAT(world.server.take_notices(), ElementsAre(tool.problem(Kind::Food, world)));
}

TEST_F(MouseToolInWorldTest, SendsTheRequestAndNoticesARefusal) {
    ViewedWorld world{wanted()};
    auto session = begin_with(world, {"codec:plain", "place"});
    EXPECT_EQ(tool.problem(Kind::Remove, world), "");
    EXPECT_THAT(tool.problem(Kind::Organism, world), testing::StartsWith("Select an organism"));
    tool.choose(Kind::Food);
    tool.click(world, empty);
    const auto place = session.read_request();
    EXPECT_EQ(place.place().world(), "default");
    session.refuse(place.request_id(), evod::v1::CODE_FAILED_PRECONDITION, "the generation is over");
    until(world, [&] { return !notices.empty(); });
    EXPECT_THAT(notices, ElementsAre("The generation is over"));
    tool.choose(Kind::Remove);
    tool.click(world, empty);
    EXPECT_TRUE(world.all_answered());
    EXPECT_THAT(world.server.take_notices(), ElementsAre("Nothing to remove here"));
}

TEST_F(MouseToolInWorldTest, OnlyChangesByOthersCauseANotice) {
    ViewedWorld world{wanted()};
    auto session = begin_with(world, {"codec:plain", "place"});
    tool.choose(Kind::Food);
    tool.click(world, empty);
    evod::v1::ServerMessage answer;
    answer.mutable_response()->set_request_id(session.read_request().request_id());
    answer.mutable_response()->mutable_placed()->set_island(1);
    answer.mutable_response()->mutable_placed()->add_food(25);
    session.send(answer);
    evod::v1::ServerMessage message;
    message.mutable_event()->set_world("default");
    evod::v1::Placed& placed = *message.mutable_event()->mutable_placed();
    placed = answer.response().placed();
    placed.mutable_by()->set_user("me");
    session.send(message);
    placed.mutable_by()->set_user("anna");
    placed.set_food(0, 26);
    message.mutable_event()->set_text("anna placed 1 food on island 1");
    session.send(message);
    until(world, [&] { return !notices.empty(); });
    EXPECT_THAT(notices, ElementsAre("Anna placed 1 food on island 1"));
}

TEST_F(MouseToolInWorldTest, AViewerCannotPlace) {
    ViewedWorld world{wanted()};
    auto session = begin_with(world, {"place"}, evod::v1::ROLE_VIEWER);
    EXPECT_EQ(tool.problem(Kind::Food, world), world.commands.read_only_reason());
}

} // namespace
} // namespace evod::viewer
