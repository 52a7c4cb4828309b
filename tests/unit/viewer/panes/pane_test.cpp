#include "client/viewer/panes/pane.h"

#include "tests/support/waiting.h"
#include "tests/unit/core/fake_server.h"

#include <gmock/gmock.h>

namespace evod::viewer {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

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

TEST_F(PanesTest, DoesNotShowTheOnlyWorldTwice) {
    panes.toggle_beside();
    answer_worlds(session.read_request(), {"default"});
    until([&] { return !notices.empty(); });
    EXPECT_THAT(notices, ElementsAre(HasSubstr("evoctl create NAME")));
    EXPECT_EQ(panes.size(), 1u);
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
