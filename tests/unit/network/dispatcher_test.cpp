// The dispatcher between clients on the loopback interface and a mailbox that no simulation thread reads.
#include "server/network/dispatcher.h"

#include "server/protocol/answers.h"
#include "server/protocol/queries.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/waiting.h"
#include "tests/unit/network/loopback.h"

#include <boost/asio/co_spawn.hpp>

#include <chrono>
#include <exception>
#include <fstream>
#include <optional>
#include <string>
#include <utility>

namespace evod::network {
namespace {

using access::Role;

class DispatcherTest : public Loopback {
  protected:
    static constexpr std::size_t mailbox_capacity = 3;

    DispatcherTest() {
        host.handle = [this](Session& session, v1::Request request) { dispatcher.handle(session, std::move(request)); };
        host.ended = [this](Session& ended) {
            dispatcher.forget(ended);
            sessions.erase(ended.number());
            streams.forget(ended);
        };
    }
    void TearDown() override {
        Loopback::TearDown();
        mailbox.drain();
    }

    static v1::Request pause_of(std::uint64_t request_id, const std::string& world = "w") {
        v1::Request request;
        request.set_request_id(request_id);
        request.set_client_key("key");
        request.mutable_pause()->set_world(world);
        return request;
    }
    void ask(Client& client, v1::Request request) {
        v1::ClientMessage message;
        *message.mutable_request() = std::move(request);
        send(client, message);
    }
    /// Removes all mail. Returns the commands in it, and answers the queries with an empty laboratory.
    std::vector<runtime::CommandMail> take_commands() {
        std::vector<runtime::CommandMail> commands;
        for (runtime::Mail& mail : mailbox.drain()) {
            if (auto* command = std::get_if<runtime::CommandMail>(&mail)) {
                commands.push_back(std::move(*command));
            } else if (auto* query = std::get_if<runtime::QueryMail>(&mail)) {
                runtime::QueryDone done{.mail = std::move(*query), .response = {}, .result = {}};
                done.response.set_request_id(done.mail.request->request_id());
                done.result =
                    protocol::answer_query(*done.mail.request, laboratory, done.mail.users_only, done.response);
                outbox.reply(std::move(done));
            }
        }
        dispatcher.deliver(outbox.take().deliveries);
        settle();
        return commands;
    }
    void finish(runtime::CommandMail command, const base::Result<simulation::Applied>& outcome,
                recording::Ticket ticket = 0, std::optional<runtime::ForkFile> fork = {}) {
        const v1::Response answer =
            protocol::answer_of(command.origin.request_id, command.request_name, laboratory, outcome);
        deliver(runtime::CommandDone{.mail = std::move(command),
                                     .outcome = outcome,
                                     .frame = protocol::frame_of(answer),
                                     .ticket = ticket,
                                     .fork = std::move(fork)});
    }
    void deliver(runtime::Reply reply) {
        outbox.reply(std::move(reply));
        dispatcher.deliver(outbox.take().deliveries);
        settle();
    }
    static simulation::Applied applied(std::uint64_t tick) {
        simulation::Applied done;
        done.world = "w";
        done.tick = tick;
        return done;
    }

    simulation::Laboratory laboratory;
    runtime::Simulations simulations{false, mailbox_capacity};
    runtime::Mailbox& mailbox = simulations.mailbox_of("");
    runtime::Outbox outbox{[] {}};
    Streams streams{sessions, simulations, memory};
    int shut_downs = 0;
    classes::Registry classes;
    static constexpr std::size_t replays_max = 4;
    Dispatcher dispatcher{context,
                          simulations,
                          outbox,
                          sessions,
                          streams,
                          host,
                          replays_max,
                          classes,
                          [this] { ++shut_downs; },
                          [] { return v1::Metrics{}; }};
};

TEST_F(DispatcherTest, SendsACommandToTheSimulationOnce) {
    Client& client = connect(Role::Controller);
    ask(client, pause_of(7));
    ask(client, pause_of(7));
    const auto waiting = take_commands();
    ASSERT_EQ(waiting.size(), 1u);
    EXPECT_TRUE(std::holds_alternative<simulation::Pause>(waiting[0].command));
    EXPECT_EQ(waiting[0].request_name, "pause");
    EXPECT_EQ(waiting[0].session, 1u);
    EXPECT_EQ(waiting[0].origin.client_key, "key");
    EXPECT_EQ(waiting[0].origin.request_id, 7u);
    v1::Request journaled;
    EXPECT_TRUE(journaled.ParseFromString(waiting[0].origin.request));
    EXPECT_EQ(journaled.pause().world(), "w");
    EXPECT_TRUE(client.responses.empty());
}

TEST_F(DispatcherTest, AnswersEveryCopyOfACommand) {
    Client& client = connect(Role::Controller);
    ask(client, pause_of(7));
    ask(client, pause_of(7));
    finish(take_commands().at(0), applied(42));
    ASSERT_EQ(client.responses.size(), 2u);
    Client& other = connect(Role::Controller);
    ask(other, pause_of(7));
    EXPECT_TRUE(take_commands().empty());
    ASSERT_EQ(other.responses.size(), 1u);
    for (const v1::Response& response : {client.responses[0], client.responses[1], other.responses[0]}) {
        EXPECT_EQ(response.request_id(), 7u);
        EXPECT_EQ(response.applied_tick(), 42u);
    }
}

TEST_F(DispatcherTest, AnswersACommandWhenItIsOnTheDisk) {
    Client& client = connect(Role::Controller);
    ask(client, pause_of(7));
    ask(client, pause_of(8));
    const auto waiting = take_commands();
    finish(waiting.at(0), applied(42), 1);
    finish(waiting.at(1), applied(42), 2);
    ask(client, pause_of(7));
    EXPECT_TRUE(take_commands().empty()) << "the command is not applied again";
    EXPECT_TRUE(client.responses.empty());
    deliver(recording::Receipt{1});
    ASSERT_EQ(client.responses.size(), 2u);
    EXPECT_EQ(client.responses[0].applied_tick(), 42u);
    deliver(recording::Receipt{2, base::refusal(base::RefusalCode::DataLoss, "w.evod is damaged")});
    ASSERT_EQ(client.responses.size(), 3u);
    EXPECT_EQ(client.responses[2].request_id(), 8u);
    EXPECT_EQ(client.responses[2].status().reason(), v1::REASON_WORLD_DAMAGED);
}

TEST_F(DispatcherTest, AnswersAForkWhenItsFileIsReadBack) {
    const support::TemporaryFolder folder;
    const std::string path = folder.path() + "/fork.evod";
    std::ofstream{path} << "not a run file";
    Client& client = connect(Role::Controller);
    ask(client, pause_of(7));
    finish(take_commands().at(0), applied(42), 1, runtime::ForkFile{{path}, {1, 2}, {}});
    deliver(recording::Receipt{1});
    EXPECT_TRUE(client.responses.empty());
    ASSERT_TRUE(wait_until([&] { return outbox.fill().deliveries > 0; }));
    dispatcher.deliver(outbox.take().deliveries);
    settle();
    ASSERT_EQ(client.responses.size(), 1u);
    EXPECT_EQ(client.responses[0].status().code(), v1::CODE_DATA_LOSS);
}

TEST_F(DispatcherTest, RefusesAUsedIdForAnotherRequest) {
    Client& client = connect(Role::Controller);
    ask(client, pause_of(7));
    ask(client, pause_of(7, "another"));
    EXPECT_EQ(take_commands().size(), 1u);
    ASSERT_EQ(client.responses.size(), 1u);
    EXPECT_EQ(client.responses[0].status().reason(), v1::REASON_REQUEST_ID_REUSED);
    ASSERT_EQ(client.responses[0].status().violations_size(), 1);
    EXPECT_EQ(client.responses[0].status().violations(0).field(), "request_id");
}

TEST_F(DispatcherTest, RunsACommandAgainAfterATemporaryRefusal) {
    Client& client = connect(Role::Controller);
    ask(client, pause_of(7));
    finish(take_commands().at(0), base::refusal(base::RefusalCode::Unavailable, "the disk is full"));
    ASSERT_EQ(client.responses.size(), 1u);
    EXPECT_EQ(client.responses[0].status().code(), v1::CODE_UNAVAILABLE);
    ask(client, pause_of(7));
    EXPECT_EQ(take_commands().size(), 1u);
}

TEST_F(DispatcherTest, KeepsAPermanentRefusal) {
    Client& client = connect(Role::Controller);
    ask(client, pause_of(7));
    finish(take_commands().at(0), base::refusal(base::RefusalCode::NotFound, "no such world"));
    ask(client, pause_of(7));
    EXPECT_TRUE(take_commands().empty());
    ASSERT_EQ(client.responses.size(), 2u);
    EXPECT_EQ(client.responses[1].status().code(), v1::CODE_NOT_FOUND);
}

TEST_F(DispatcherTest, RefusesACommandWithoutItsRole) {
    Client& client = connect(Role::Viewer);
    v1::Request creation = pause_of(7);
    creation.mutable_create_world()->set_name("new");
    ask(client, creation);
    EXPECT_TRUE(take_commands().empty());
    ASSERT_EQ(client.responses.size(), 1u);
    EXPECT_EQ(client.responses[0].status().code(), v1::CODE_PERMISSION_DENIED);
}

TEST_F(DispatcherTest, LetsAViewerControlItsOwnReplay) {
    Client& client = connect(Role::Viewer);
    client.session->replays.insert("w");
    ask(client, pause_of(7));
    EXPECT_EQ(take_commands().size(), 1u);
}

TEST_F(DispatcherTest, RequestIdsBeginAt1) {
    Client& client = connect(Role::Controller);
    ask(client, pause_of(0));
    EXPECT_TRUE(take_commands().empty());
    ASSERT_EQ(client.responses.size(), 1u);
    ASSERT_EQ(client.responses[0].status().violations_size(), 1);
    EXPECT_EQ(client.responses[0].status().violations(0).field(), "request_id");
}

TEST_F(DispatcherTest, ACommandMayBeRepeatedAfterAFullMailbox) {
    Client& client = connect(Role::Controller);
    const std::size_t of_one_user = base::Quota{mailbox_capacity}.share();
    for (std::uint64_t id = 1; id <= of_one_user; ++id) {
        ask(client, pause_of(id));
    }
    EXPECT_TRUE(client.responses.empty());
    ask(client, pause_of(9));
    ASSERT_EQ(client.responses.size(), 1u);
    EXPECT_EQ(client.responses[0].request_id(), 9u);
    EXPECT_EQ(client.responses[0].status().reason(), v1::REASON_SERVER_BUSY);
    EXPECT_EQ(counters.count(Limit::MailboxCommands), 1u);
    EXPECT_EQ(take_commands().size(), of_one_user);
    ask(client, pause_of(9));
    EXPECT_EQ(take_commands().size(), 1u);
}

TEST_F(DispatcherTest, HoldsRequestsBackUntilAQueryIsAnswered) {
    Client& client = connect(Role::Controller);
    v1::Request query;
    query.set_request_id(1);
    query.mutable_list_worlds();
    ask(client, query);
    ask(client, pause_of(2));
    EXPECT_TRUE(client.responses.empty());
    EXPECT_TRUE(take_commands().empty()) << "the command came before the answer to the query";
    ASSERT_EQ(client.responses.size(), 1u);
    EXPECT_EQ(client.responses[0].request_id(), 1u);
    EXPECT_EQ(take_commands().size(), 1u);
}

TEST_F(DispatcherTest, CountsTheLimitThatARefusalReports) {
    Client& client = connect(Role::Controller);
    ask(client, pause_of(7));
    finish(take_commands().at(0),
           base::refusal(base::RefusalCode::ResourceExhausted, "too many worlds", base::Reason::WorldsMax));
    EXPECT_EQ(counters.count(Limit::Worlds), 1u);
}

TEST_F(DispatcherTest, AReplayIsTakenBackFromTheUserWithTheMost) {
    std::map<std::string, Client*> of;
    const auto come = [&](const std::string& user) {
        host.admit = [user](const std::string&, const std::string&) {
            return access::AuthenticatedUser{.name = user, .role = Role::Viewer};
        };
        of[user] = &connect(Role::Viewer);
    };
    std::uint64_t opened = 0;
    const auto open = [&](const std::string& user) {
        v1::Request request;
        request.set_request_id(++opened);
        request.mutable_open_replay()->set_world("w");
        ask(*of[user], request);
        std::vector<runtime::Mail> mail = mailbox.drain();
        if (!mail.empty()) {
            auto replay = std::get<runtime::ReplayMail>(std::get<runtime::FindRun>(mail.at(0)).purpose);
            deliver(runtime::ReplayDone{.mail = std::move(replay), .world = "w@" + std::to_string(opened)});
        }
    };
    for (const char* user : {"ada", "bob", "eve"}) {
        come(user);
    }
    streams.subscribe(*of["bob"]->session, EventSubscription{.world = "w@4"});
    for (const char* user : {"eve", "eve", "eve", "bob"}) {
        open(user);
    }
    EXPECT_EQ(of["eve"]->responses.at(2).status().reason(), v1::REASON_REPLAYS_MAX) << "half of the places are taken";
    open("bob");
    EXPECT_TRUE(of["bob"]->events.empty());
    open("ada");
    open("ada");
    EXPECT_EQ(of["ada"]->responses.size(), 2u);
    EXPECT_TRUE(of["bob"]->events.empty()) << "events of the replay may be on their way";
    deliver(runtime::ReplayEnded{"w@4"});
    EXPECT_FALSE(of["ada"]->responses.at(0).has_status());
    EXPECT_EQ(of["ada"]->responses.at(1).status().reason(), v1::REASON_REPLAYS_MAX) << "eve has 2 left, ada 1";
    ASSERT_EQ(of["bob"]->events.size(), 1u);
    EXPECT_TRUE(of["bob"]->events[0].has_world_deleted());
    EXPECT_EQ(of["bob"]->events[0].world(), "w@4");
    EXPECT_EQ(of["bob"]->session->replays, (std::set<std::string>{"w@5"}));
    EXPECT_EQ(of["eve"]->session->replays, (std::set<std::string>{"w@1", "w@2"}));
    EXPECT_EQ(counters.taken_back_count(Limit::Replays), 1u);
    EXPECT_EQ(counters.count(Limit::Replays), 2u);
}

TEST_F(DispatcherTest, RefusesUnknownSubscriptionsByTheirField) {
    Client& client = connect(Role::Viewer);
    v1::Request request;
    request.set_request_id(1);
    request.mutable_unsubscribe()->set_subscription_id(4);
    ask(client, request);
    request.set_request_id(2);
    request.mutable_request_keyframe()->set_subscription_id(4);
    ask(client, request);
    ASSERT_EQ(client.responses.size(), 2u);
    for (const v1::Response& response : client.responses) {
        EXPECT_EQ(response.status().reason(), v1::REASON_SUBSCRIPTION_NOT_FOUND);
    }
    EXPECT_EQ(client.responses[0].status().violations(0).field(), "unsubscribe.subscription_id");
    EXPECT_EQ(client.responses[1].status().violations(0).field(), "request_keyframe.subscription_id");
    EXPECT_EQ(client.responses[1].status().violations(0).got(), "4");
}

TEST_F(DispatcherTest, RefusesEverythingWhileShuttingDown) {
    Client& client = connect(Role::Admin);
    dispatcher.refuse_all();
    ask(client, pause_of(7));
    EXPECT_TRUE(take_commands().empty());
    ASSERT_EQ(client.responses.size(), 1u);
    EXPECT_EQ(client.responses[0].status().reason(), v1::REASON_SERVER_GOING_AWAY);
}

TEST_F(DispatcherTest, AnswersShutDownBeforeItShutsDown) {
    Client& client = connect(Role::Admin);
    v1::Request request;
    request.set_request_id(1);
    request.mutable_shut_down();
    ask(client, request);
    EXPECT_EQ(shut_downs, 1);
    ASSERT_EQ(client.responses.size(), 1u);
    EXPECT_EQ(client.responses[0].status().code(), v1::CODE_UNSPECIFIED);
}

TEST_F(DispatcherTest, AllHealthChecksWaitForOnePong) {
    std::vector<bool> answers;
    for (int i = 0; i < 3; ++i) {
        asio::co_spawn(context, dispatcher.simulation_answers_within(std::chrono::hours{1}),
                       [&](const std::exception_ptr&, bool answered) { answers.push_back(answered); });
    }
    settle();
    const auto waiting = mailbox.drain();
    ASSERT_EQ(waiting.size(), 1u);
    EXPECT_TRUE(std::holds_alternative<runtime::Ping>(waiting[0]));
    EXPECT_TRUE(answers.empty());
    outbox.reply(runtime::Pong{});
    take_commands();
    EXPECT_EQ(answers, (std::vector{true, true, true}));
}

TEST_F(DispatcherTest, AHealthCheckEndsWithoutAPong) {
    std::optional<bool> answer;
    asio::co_spawn(context, dispatcher.simulation_answers_within(std::chrono::hours{1}),
                   [&](const std::exception_ptr&, bool answered) { answer = answered; });
    settle();
    dispatcher.refuse_all();
    settle();
    EXPECT_EQ(answer, false);
}

TEST_F(DispatcherTest, LaterSessionsLearnTheStateOfTheDisk) {
    host.storage = v1::Storage{};
    Client& client = connect(Role::Viewer);
    streams.subscribe(*client.session, EventSubscription{});
    outbox.storage({.storage = {simulation::StorageState::Failing, "of one world"}, .world = "w"});
    outbox.storage({.storage = {simulation::StorageState::Stalled, "of all worlds"}});
    take_commands();
    EXPECT_EQ(host.storage->state(), v1::STORAGE_STATE_STALLED);
    EXPECT_EQ(host.storage->reason(), "of all worlds");
    ASSERT_EQ(client.events.size(), 2u);
    EXPECT_EQ(client.events[0].world(), "w");
    EXPECT_EQ(client.events[1].world(), "");
}

TEST_F(DispatcherTest, EventsAndDamagedWorldsReachSubscribers) {
    Client& client = connect(Role::Viewer);
    streams.subscribe(*client.session, EventSubscription{});
    v1::Event event;
    event.set_world("v");
    event.mutable_extinction()->set_generation(3);
    outbox.event(event);
    outbox.damaged({.name = "w", .run_id = {}, .reason = "cut off"});
    take_commands();
    ASSERT_EQ(client.events.size(), 2u);
    EXPECT_EQ(client.events[0].world(), "v");
    EXPECT_EQ(client.events[0].text(), "all organisms on island 0 have died in generation 3");
    EXPECT_EQ(client.events[1].world(), "w");
    EXPECT_TRUE(client.events[1].has_world_damaged());
}

TEST_F(DispatcherTest, ResultsForEndedSessionsAreDropped) {
    outbox.reply(runtime::ExportPartDone{{.session = 9, .request_id = 1, .export_id = 1}, runtime::ExportPart{}});
    outbox.reply(runtime::ExportPartDone{
        {.session = 9, .request_id = 2, .export_id = 1},
        base::refusal(base::RefusalCode::FailedPrecondition, "the export is over", base::Reason::ExportEnded)});
    take_commands();
    EXPECT_EQ(counters.count(Limit::ExportPatience), 0u) << "the export was cancelled for another reason";
}

TEST_F(DispatcherTest, SendsCommandsOfTheServerItself) {
    v1::Request request;
    request.mutable_run()->set_world("w");
    dispatcher.handle_own(request);
    dispatcher.handle_own(request);
    const auto waiting = take_commands();
    ASSERT_EQ(waiting.size(), 2u) << "each has a request_id of its own";
    EXPECT_EQ(waiting[0].session, 0u);
    EXPECT_EQ(waiting[0].origin.by, base::server_actor());
    EXPECT_NE(waiting[0].origin.request_id, waiting[1].origin.request_id);
}

} // namespace
} // namespace evod::network
