#include "server/network/background_queries.h"

#include "tests/support/waiting.h"
#include "tests/unit/network/loopback.h"
#include "tests/unit/recording/recorded_run.h"

#include <algorithm>
#include <optional>

namespace evod::network {
namespace {

using access::Role;

class BackgroundQueriesTest : public Loopback {
  protected:
    BackgroundQueriesTest() {
        host.admit = [this](const std::string&, const std::string&) {
            return access::AuthenticatedUser{.name = user, .role = role};
        };
        host.ended = [this](Session& ended) {
            queries.forget(ended);
            sessions.erase(ended.number());
        };
        record(data, 3);
    }

    /// Records so many generations and one tick, for the following requests.
    void record(run_file::DataFolder& to, std::uint64_t generations, std::uint64_t keep_every = 1) {
        run_file::RunFile::Options options;
        options.keep_every = keep_every;
        recording::StorageThread thread{options};
        recording::RecordedRun run{to, thread};
        while (run.world().moment().generation <= generations) {
            run.advance(1);
        }
        run.advance(1);
        ASSERT_TRUE(wait_until([&] { return thread.idle(); }));
        stored.emplace(*replay::StoredRun::of_file(to.file_of("w")));
    }
    /// A session of a user. Without a name, the user is known by the address.
    Client& connect_as(const std::string& name) {
        user = name;
        return connect(Role::Viewer);
    }
    void begin_export(Client& client, std::uint64_t request_id) {
        ASSERT_TRUE(client.session->requests.admit());
        queries.begin_export(*client.session, request_id, *stored, {.table = table});
        settle();
    }
    void continue_export(Client& client, std::uint64_t request_id, std::uint64_t export_id) {
        ASSERT_TRUE(client.session->requests.admit());
        v1::ContinueExport request;
        request.set_export_id(export_id);
        queries.send_next_part(*client.session, request_id, request);
        settle();
    }
    void ask_breeding(Client& client, std::uint64_t request_id) {
        ASSERT_TRUE(client.session->requests.admit());
        v1::Request request;
        request.set_request_id(request_id);
        request.mutable_get_breeding()->set_world("w");
        if (generation) {
            request.mutable_get_breeding()->set_generation(*generation);
        }
        queries.ask_breeding(*client.session, request, {.run = *stored, .generation = 4});
    }
    /// Waits for the results of so many jobs.
    void deliver(std::size_t count) {
        while (count > 0) {
            const std::size_t delivered = deliver_some();
            ASSERT_TRUE(delivered > 0 && delivered <= count);
            count -= delivered;
        }
        settle();
    }
    /// Waits for results, and delivers them. Returns their number; 0 if none came.
    std::size_t deliver_some() {
        std::vector<runtime::Delivery> deliveries;
        wait_until([&] {
            deliveries = outbox.take().deliveries;
            return !deliveries.empty();
        });
        for (runtime::Delivery& delivery : deliveries) {
            auto& reply = std::get<runtime::Reply>(delivery);
            if (auto* part = std::get_if<runtime::ExportPartDone>(&reply)) {
                queries.on_done(std::move(*part));
            } else {
                queries.on_done(std::get<runtime::BreedingDone>(std::move(reply)));
            }
        }
        return deliveries.size();
    }

    recording::TemporaryFolder folder;
    run_file::DataFolder data{*run_file::DataFolder::open(folder.path())};
    recording::TemporaryFolder folder_of_long;
    run_file::DataFolder data_of_long{*run_file::DataFolder::open(folder_of_long.path())};
    std::optional<replay::StoredRun> stored;
    replay::RunTable table = replay::RunTable::Generations;
    std::optional<std::uint64_t> generation; // whose breeding is asked for
    std::string user;                        // of the next client
    runtime::Outbox outbox{[] {}};
    runtime::SteadyClock steady;
    runtime::JobTurns turns{1, steady};
    const std::stop_token never;
    // A test under a sanitizer, or next to other work, may take longer than the patience of a server.
    BackgroundQueries queries{outbox, turns, sessions, counters, std::chrono::hours{1}};
};

TEST_F(BackgroundQueriesTest, AnExportAnswersWithItsParts) {
    Client& client = connect(Role::Viewer);
    begin_export(client, 5);
    EXPECT_TRUE(client.responses.empty());
    deliver(1);
    ASSERT_EQ(client.responses.size(), 1u);
    EXPECT_EQ(client.responses[0].request_id(), 5u);
    const v1::ExportPart& part = client.responses[0].export_part();
    EXPECT_EQ(part.export_id(), 1u);
    EXPECT_TRUE(part.last());
    EXPECT_TRUE(part.text().starts_with("generation,")) << part.text();
    continue_export(client, 6, 1);
    ASSERT_EQ(client.responses.size(), 2u);
    EXPECT_EQ(client.responses[1].status().reason(), v1::REASON_EXPORT_NOT_FOUND) << "it has ended";
}

TEST_F(BackgroundQueriesTest, OnePartIsRequestedAtATime) {
    Client& client = connect(Role::Viewer);
    begin_export(client, 5);
    continue_export(client, 6, 1);
    ASSERT_EQ(client.responses.size(), 1u);
    EXPECT_EQ(client.responses[0].request_id(), 6u);
    EXPECT_EQ(client.responses[0].status().reason(), v1::REASON_EXPORT_ENDED);
    deliver(1);
    EXPECT_EQ(client.responses.back().request_id(), 5u);
}

TEST_F(BackgroundQueriesTest, ASecondExportReplacesTheFirst) {
    Client& client = connect(Role::Viewer);
    begin_export(client, 5);
    begin_export(client, 6);
    deliver(2);
    ASSERT_EQ(client.responses.size(), 2u) << "each request is answered";
    const bool first_is_5 = client.responses[0].request_id() == 5;
    EXPECT_EQ(client.responses[first_is_5 ? 1 : 0].export_part().export_id(), 2u);
}

TEST_F(BackgroundQueriesTest, AUserHasHalfOfTheExports) {
    runtime::JobTurns::Turn holds_all{turns, "test", never};
    for (std::uint32_t i = 0; i < exports_max / 2; ++i) {
        begin_export(connect_as("eve"), 1);
    }
    Client& last = connect_as("eve");
    begin_export(last, 2);
    ASSERT_EQ(last.responses.size(), 1u);
    EXPECT_EQ(last.responses[0].status().reason(), v1::REASON_EXPORTS_MAX);
    EXPECT_EQ(counters.count(Limit::Exports), 1u);
    EXPECT_EQ(counters.count(Limit::Exports), 1u);
    Client& ada = connect_as("ada");
    begin_export(ada, 3);
    holds_all.give_back();
    deliver(exports_max / 2 + 1);
    for (const auto& client : clients) {
        EXPECT_EQ(client->responses.size(), 1u);
    }
    EXPECT_TRUE(ada.responses[0].export_part().last());
}

TEST_F(BackgroundQueriesTest, SessionsWithoutATokenShareAnAddress) {
    runtime::JobTurns::Turn holds_all{turns, "test", never};
    for (std::uint32_t i = 0; i < exports_max / 2; ++i) {
        begin_export(connect_as(""), 1);
    }
    Client& last = connect_as("");
    begin_export(last, 2);
    ASSERT_EQ(last.responses.size(), 1u);
    EXPECT_EQ(last.responses[0].status().reason(), v1::REASON_EXPORTS_MAX);
    holds_all.give_back();
    deliver(exports_max / 2);
}

TEST_F(BackgroundQueriesTest, ASessionKeepsItsOnlyExport) {
    runtime::JobTurns::Turn holds_all{turns, "test", never};
    for (std::uint32_t i = 0; i < exports_max / 2; ++i) {
        begin_export(connect_as("eve"), 1);
        begin_export(connect_as("bob"), 1);
    }
    begin_export(*clients[0], 2); // replaces that of its session
    EXPECT_EQ(queries.exports().held("eve"), 4u);
    EXPECT_EQ(counters.taken_back_count(Limit::Exports), 0u);
    holds_all.give_back();
    deliver(exports_max + 1);
}

TEST_F(BackgroundQueriesTest, TheUserWithMostExportsLosesTheOldest) {
    runtime::JobTurns::Turn holds_all{turns, "test", never};
    for (std::uint32_t i = 0; i < exports_max / 2; ++i) {
        begin_export(connect_as("eve"), 1);
    }
    for (std::uint32_t i = 0; i < exports_max / 2; ++i) {
        begin_export(connect_as("bob"), 1);
    }
    Client& ada = connect_as("ada");
    begin_export(ada, 3); // takes the place of bob's oldest, which is asked for a part
    EXPECT_EQ(counters.taken_back_count(Limit::Exports), 1u);
    EXPECT_EQ(queries.exports().held("ada"), 1u);
    EXPECT_EQ(queries.exports().held("bob"), 3u);
    Client& bob = *clients[exports_max / 2];
    deliver(1);
    ASSERT_EQ(bob.responses.size(), 1u);
    EXPECT_EQ(bob.responses[0].request_id(), 1u);
    EXPECT_EQ(bob.responses[0].status().code(), v1::CODE_RESOURCE_EXHAUSTED);
    EXPECT_EQ(bob.responses[0].status().reason(), v1::REASON_EXPORTS_MAX);
    EXPECT_NE(bob.responses[0].status().message().find("another user"), std::string::npos);
    begin_export(bob, 4);
    ASSERT_EQ(bob.responses.size(), 2u);
    EXPECT_EQ(bob.responses[1].status().reason(), v1::REASON_EXPORTS_MAX) << "it does not take the place back";
    holds_all.give_back();
    deliver(exports_max);
    EXPECT_TRUE(ada.responses.at(0).has_export_part());
    EXPECT_EQ(queries.exports().held(), 0u);
}

TEST_F(BackgroundQueriesTest, ALostExportIsRefusedAtItsNextPart) {
    record(data_of_long, 300); // its table has more than one part
    table = replay::RunTable::Organisms;
    for (std::uint32_t i = 0; i < exports_max; ++i) {
        begin_export(connect_as(i % 2 == 0 ? "eve" : "bob"), 1);
        deliver(1);
        ASSERT_FALSE(clients.back()->responses.at(0).export_part().last());
    }
    begin_export(connect_as("ada"), 2);
    deliver(1);
    EXPECT_TRUE(clients.back()->responses.at(0).has_export_part());
    for (int i = 0; i < 2; ++i) {
        Client& bob = *clients[1];
        continue_export(bob, 5, bob.responses[0].export_part().export_id());
        EXPECT_EQ(bob.responses.back().status().reason(), v1::REASON_EXPORTS_MAX);
    }
    Client& eve = *clients[0];
    continue_export(eve, 5, eve.responses[0].export_part().export_id());
    deliver(1);
    EXPECT_TRUE(eve.responses.at(1).has_export_part());
}

TEST_F(BackgroundQueriesTest, AnAbandonedExportFreesItsPlace) {
    record(data_of_long, 300); // its table has more than one part
    BackgroundQueries impatient{outbox, turns, sessions, counters, std::chrono::milliseconds{1}};
    Client& eve = connect_as("eve");
    ASSERT_TRUE(eve.session->requests.admit());
    impatient.begin_export(*eve.session, 1, *stored, {.table = replay::RunTable::Organisms});
    EXPECT_EQ(impatient.exports().held("eve"), 1u);
    EXPECT_TRUE(wait_until([&] { return impatient.exports().held("eve") == 0; }));
    for (runtime::Delivery& delivery : outbox.take().deliveries) {
        impatient.on_done(std::get<runtime::ExportPartDone>(std::get<runtime::Reply>(std::move(delivery))));
    }
    ASSERT_TRUE(eve.session->requests.admit());
    v1::ContinueExport request;
    request.set_export_id(1);
    impatient.send_next_part(*eve.session, 2, request);
    for (runtime::Delivery& delivery : outbox.take().deliveries) {
        impatient.on_done(std::get<runtime::ExportPartDone>(std::get<runtime::Reply>(std::move(delivery))));
    }
    settle();
    ASSERT_EQ(eve.responses.size(), 2u);
    EXPECT_TRUE(eve.responses[0].has_export_part());
    EXPECT_EQ(eve.responses[1].status().reason(), v1::REASON_EXPORT_ENDED);
    EXPECT_EQ(counters.count(Limit::ExportPatience), 1u);
    EXPECT_EQ(impatient.exports().held(), 0u);
}

TEST_F(BackgroundQueriesTest, ASessionHasOneRunningBreeding) {
    Client &first = connect(Role::Viewer), &second = connect(Role::Viewer);
    ask_breeding(first, 1);
    const std::size_t one = first.session->requests.held_bytes();
    EXPECT_GT(one, 0u) << "the request is counted";
    EXPECT_LT(one, 2000u);
    ask_breeding(first, 2);
    EXPECT_EQ(first.session->requests.held_bytes(), 2 * one);
    ask_breeding(second, 3);
    EXPECT_EQ(second.session->requests.held_bytes(), one);
    deliver(3);
    ASSERT_EQ(first.responses.size(), 2u);
    EXPECT_EQ(first.responses[0].request_id(), 1u);
    EXPECT_EQ(first.responses[1].request_id(), 2u);
    ASSERT_EQ(second.responses.size(), 1u);
    EXPECT_EQ(second.responses[0].breeding().generation(), 3u) << second.responses[0].ShortDebugString();
    EXPECT_GT(second.responses[0].breeding().contenders_size(), 0);
    EXPECT_EQ(first.session->requests.held_bytes() + second.session->requests.held_bytes(), 0u);
}

TEST_F(BackgroundQueriesTest, AUserHasHalfOfTheRunningBreedings) {
    runtime::JobTurns::Turn holds_all{turns, "test", never};
    for (int i = 0; i < 6; ++i) {
        ask_breeding(connect_as("eve"), 1);
    }
    EXPECT_EQ(queries.breedings().held("eve"), breedings_max / 2);
    Client& ada = connect_as("ada");
    ask_breeding(ada, 1);
    EXPECT_EQ(queries.breedings().held("ada"), 1u) << "eve's queries wait";
    holds_all.give_back();
    deliver(7);
    for (const auto& client : clients) {
        EXPECT_TRUE(client->responses.at(0).has_breeding());
    }
    EXPECT_EQ(queries.breedings().held(), 0u);
}

TEST_F(BackgroundQueriesTest, ABreedingThatLosesItsPlaceBeginsAgain) {
    runtime::JobTurns::Turn holds_all{turns, "test", never};
    for (const char* name : {"eve", "eve", "bob", "bob", "ada", "cid", "dan"}) {
        ask_breeding(connect_as(name), 1);
    }
    EXPECT_EQ(counters.taken_back_count(Limit::RunningBreedings), 2u) << "one of eve, one of bob";
    for (const char* name : {"eve", "bob", "ada", "cid"}) {
        EXPECT_EQ(queries.breedings().held(name), 1u) << name;
    }
    EXPECT_EQ(queries.breedings().held("dan"), 0u) << "waits";
    holds_all.give_back();
    // One that loses its place again, while it is computed, holds none until its result arrives.
    while (std::ranges::any_of(clients, [](const auto& client) { return client->responses.empty(); })) {
        ASSERT_GT(deliver_some(), 0u);
        settle();
    }
    for (const auto& client : clients) {
        ASSERT_EQ(client->responses.size(), 1u);
        EXPECT_TRUE(client->responses[0].has_breeding()) << client->responses[0].ShortDebugString();
        EXPECT_EQ(client->session->requests.held_bytes(), 0u);
    }
    EXPECT_EQ(queries.breedings().held(), 0u);
}

TEST_F(BackgroundQueriesTest, WaitingBreedingsOfAUserAreBounded) {
    runtime::JobTurns::Turn holds_all{turns, "test", never};
    Client &first = connect_as("eve"), &second = connect_as("eve"), &third = connect_as("eve");
    std::uint64_t asked = 0;
    for (Client* client : {&first, &second, &third}) {
        for (std::uint32_t i = 0; i < requests_in_flight_max; ++i, ++asked) {
            ask_breeding(*client, asked + 1);
        }
    }
    settle();
    const std::size_t answered = breedings_waiting_max + breedings_max / 2;
    ASSERT_EQ(third.responses.size(), asked - answered);
    EXPECT_EQ(third.responses[0].status().reason(), v1::REASON_SERVER_BUSY);
    EXPECT_EQ(counters.count(Limit::RunningBreedings), asked - answered);
    ask_breeding(connect_as("ada"), 1);
    EXPECT_EQ(queries.breedings().held("ada"), 1u) << "she is not concerned";
    holds_all.give_back();
    deliver(answered + 1);
}

TEST_F(BackgroundQueriesTest, PlacesAreFreeSoonAfterTheSessionEnds) {
    record(data_of_long, 1'000, 1'000'000);
    generation = 990; // is simulated again
    Client& eve = connect_as("eve");
    ask_breeding(eve, 1);
    table = replay::RunTable::Lineage;
    begin_export(eve, 2);
    EXPECT_EQ(queries.exports().held(), 1u);
    eve.session->close();
    settle();
    EXPECT_EQ(queries.exports().held(), 0u);
    deliver(2); // each request is answered, although the session has ended
    EXPECT_EQ(queries.breedings().held(), 0u);
    EXPECT_TRUE(wait_until([&] { return queries.cancelled_count() == 0; }));
}

TEST_F(BackgroundQueriesTest, EndedSessionsGetNothing) {
    Client &first = connect(Role::Viewer), &second = connect(Role::Viewer);
    ask_breeding(first, 1);
    ask_breeding(first, 2);
    begin_export(first, 3);
    first.session->close();
    settle();
    ASSERT_EQ(sessions.size(), 1u);
    ask_breeding(second, 4);
    deliver(3); // the breeding of the first session that waited does not run
    EXPECT_TRUE(first.responses.empty());
    EXPECT_EQ(second.responses.size(), 1u);
}

} // namespace
} // namespace evod::network
