#include "client/viewer/panes/pane.h"

#include "tests/support/waiting.h"
#include "tests/unit/core/fake_server.h"

#include <gmock/gmock.h>

namespace evod::viewer {
namespace {

/// One pane with the server's choice of a world, which is "default".
struct PanesTest : testing::Test {
    PanesTest() {
        session.answer_subscription(session.read_request(), 6); // to events
        const auto snapshots = session.read_request();
        session.answer_subscription(snapshots, 7);
        until([&] { return panes[0].world.server.connected(); });
        panes.update(std::chrono::steady_clock::now()); // requests statistics
        const auto question = session.read_request();
        EXPECT_TRUE(question.has_get_statistics());
        evod::v1::ServerMessage message;
        message.mutable_response()->set_request_id(question.request_id());
        message.mutable_response()->mutable_statistics()->mutable_world()->set_name("default");
        session.send(message);
        until([&] { return panes[0].world.all_answered() && panes[0].world.feed.control().known(); });
    }

    template <class Condition>
    void until(Condition condition) {
        ASSERT_TRUE(wait_until(condition, [&] {
            panes.update(std::chrono::steady_clock::now());
            for (std::string& notice : panes.focused().world.server.take_notices()) {
                notices.push_back(std::move(notice));
            }
            take_a_nap();
        }));
    }

    void answer_worlds(const evod::v1::Request& question, std::initializer_list<const char*> names) {
        EXPECT_TRUE(question.has_list_worlds());
        evod::v1::ServerMessage message;
        message.mutable_response()->set_request_id(question.request_id());
        for (const char* name : names) {
            message.mutable_response()->mutable_worlds()->add_worlds()->set_name(name);
        }
        session.send(message);
    }

    core::FakeServer server;
    std::vector<std::string> notices;
    Panes panes{{.connection = server.options(), .world = ""}};
    core::FakeSession session = server.accept_and_welcome();
};

TEST_F(PanesTest, ShowsTheOtherWorldBeside) {
    panes.toggle_beside();
    answer_worlds(session.read_request(), {"default", "omega"});
    until([&] { return panes.size() == 2; });
    EXPECT_EQ(panes[0].world.feed.name(), "default");
    EXPECT_EQ(panes[1].world.feed.world(), "omega");
    EXPECT_THAT(notices, testing::IsEmpty());
}

TEST_F(PanesTest, OffersASecondWorldWhereThereIsOne) {
    panes.toggle_beside();
    answer_worlds(session.read_request(), {"default"});
    until([&] { return panes[0].world.take_new_world_offer(); });
    EXPECT_FALSE(panes[0].world.take_new_world_offer()) << "once";
    EXPECT_EQ(panes.size(), 1u) << "the only world is not shown twice";
}

TEST_F(PanesTest, ShowsACreatedWorldBeside) {
    for (const char* name : {"first", "second"}) {
        evod::v1::Request create;
        create.mutable_create_world()->set_name(name);
        panes[0].world.create(std::move(create), true, [](const std::string& refusal) { EXPECT_EQ(refusal, ""); });
        evod::v1::Request request = session.read_request();
        while (!request.has_create_world()) { // statistics of the viewed world
            request = session.read_request();
        }
        evod::v1::ServerMessage message;
        message.mutable_response()->set_request_id(request.request_id());
        message.mutable_response()->mutable_world()->set_name(name);
        session.send(message);
        until([&] { return panes.size() == 2 && panes[1].world.feed.world() == name; });
        EXPECT_EQ(panes[0].world.feed.name(), "default");
    }
}

TEST_F(PanesTest, OnlyTheNewestAnswerOpensAPane) {
    panes.toggle_beside();
    panes.toggle_beside();
    answer_worlds(session.read_request(), {"default", "alpha"});
    answer_worlds(session.read_request(), {"default", "omega"});
    until([&] { return panes.size() == 2 && panes[0].world.all_answered(); });
    EXPECT_EQ(panes[1].world.feed.world(), "omega");
    panes.toggle_beside();
    EXPECT_EQ(panes.size(), 1u);
}

} // namespace
} // namespace evod::viewer
