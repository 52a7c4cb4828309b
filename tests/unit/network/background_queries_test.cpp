#include "server/network/background_queries.h"

#include "tests/support/waiting.h"
#include "tests/unit/network/loopback.h"
#include "tests/unit/recording/recorded_run.h"

#include <optional>

namespace evod::network {
namespace {

using access::Role;

class BackgroundQueriesTest : public Loopback {
  protected:
    BackgroundQueriesTest() {
        host.ended = [this](Session& ended) {
            queries.forget(ended);
            sessions.erase(ended.number());
        };
        recording::StorageThread thread{{}};
        recording::RecordedRun run{data, thread};
        while (run.world().moment().generation <= 3) {
            run.advance(1);
        }
        run.advance(1);
        EXPECT_TRUE(wait_until([&] { return thread.idle(); }));
        stored.emplace(*replay::StoredRun::of_file(data.file_of("w")));
    }

    void begin_export(Client& client, std::uint64_t request_id) {
        ASSERT_TRUE(client.session->requests.admit());
        queries.begin_export(*client.session, request_id, *stored, {.table = replay::RunTable::Generations});
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
        queries.ask_breeding(*client.session, request, {.run = *stored, .generation = 4});
    }
    /// Waits for the results of so many jobs.
    void deliver(std::size_t count) {
        while (count > 0) {
            std::vector<runtime::Delivery> deliveries;
            ASSERT_TRUE(wait_until([&] {
                deliveries = outbox.take().deliveries;
                return !deliveries.empty();
            }));
            ASSERT_LE(deliveries.size(), count);
            count -= deliveries.size();
            for (runtime::Delivery& delivery : deliveries) {
                auto& reply = std::get<runtime::Reply>(delivery);
                if (auto* part = std::get_if<runtime::ExportPartDone>(&reply)) {
                    queries.on_done(std::move(*part));
                } else {
                    queries.on_done(std::get<runtime::BreedingDone>(std::move(reply)));
                }
            }
        }
        settle();
    }

    recording::TemporaryFolder folder;
    run_file::DataFolder data{*run_file::DataFolder::open(folder.path())};
    std::optional<replay::StoredRun> stored;
    runtime::Outbox outbox{[] {}};
    BackgroundQueries queries{outbox, sessions, counters};
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

TEST_F(BackgroundQueriesTest, TheNumberOfExportsIsLimited) {
    for (std::uint32_t i = 0; i < exports_max; ++i) {
        begin_export(connect(Role::Viewer), 1);
    }
    Client& last = connect(Role::Viewer);
    begin_export(last, 2);
    ASSERT_EQ(last.responses.size(), 1u);
    EXPECT_EQ(last.responses[0].status().reason(), v1::REASON_EXPORTS_MAX);
    EXPECT_EQ(counters.count(Limit::Exports), 1u);
    deliver(exports_max);
    for (const auto& client : clients) {
        EXPECT_EQ(client->responses.size(), 1u);
    }
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
