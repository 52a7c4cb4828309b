#include "client/viewer/world/server_connection.h"

#include "tests/support/waiting.h"
#include "tests/unit/core/fake_server.h"

#include <gmock/gmock.h>

namespace evod::viewer {
namespace {

using testing::ElementsAre;

struct ServerConnectionTest : testing::Test {
    core::FakeServer server;
    ServerConnection connection{server.options()};
    core::FakeSession session = server.accept_and_welcome(0, evod::v1::ROLE_VIEWER);
    int answered_count = 0;

    void send() {
        evod::v1::Request request;
        request.mutable_list_worlds();
        connection.send(std::move(request), [this](const auto& response) {
            ++answered_count;
            connection.report_if_refused(response);
        });
    }
    template <class Condition>
    void until(Condition condition) {
        ASSERT_TRUE(wait_until(condition, [this] {
            connection.take_answers();
            take_a_nap();
        }));
    }
};

TEST_F(ServerConnectionTest, WelcomesOncePerConnection) {
    until([&] { return connection.take_welcome().has_value(); });
    EXPECT_FALSE(connection.take_welcome());
    EXPECT_TRUE(connection.was_connected());
    EXPECT_TRUE(connection.read_only());
    EXPECT_FALSE(connection.may_create());
}

TEST_F(ServerConnectionTest, CallsTheHandlerOfAnAnswer) {
    until([&] { return connection.take_welcome().has_value(); });
    send();
    EXPECT_FALSE(connection.all_answered());
    session.refuse(session.read_request().request_id(), evod::v1::CODE_NOT_FOUND, "no such world");
    until([&] { return connection.all_answered(); });
    EXPECT_EQ(answered_count, 1);
    EXPECT_THAT(connection.take_notices(), ElementsAre("No such world"));
    EXPECT_THAT(connection.take_notices(), ElementsAre());
}

TEST_F(ServerConnectionTest, DropsAnswers) {
    until([&] { return connection.take_welcome().has_value(); });
    send();
    connection.drop_answers();
    EXPECT_TRUE(connection.all_answered());
    send();
    for (int i = 0; i < 2; ++i) {
        session.answer(session.read_request());
    }
    until([&] { return connection.all_answered(); });
    EXPECT_EQ(answered_count, 1);
}

} // namespace
} // namespace evod::viewer
