// ViewedWorldTest: a ViewedWorld against a fake server whose session the test plays.
#pragma once

#include "client/viewer/world/viewed_world.h"
#include "tests/support/waiting.h"
#include "tests/unit/core/fake_server.h"

#include <gmock/gmock.h>

#include <string>
#include <utility>
#include <vector>

namespace evod::viewer {

struct ViewedWorldTest : testing::Test {
    WantedWorld wanted() const { return {.connection = server.options(), .world = "default", .island = 1}; }

    /// Updates until the condition holds; fails after some seconds.
    template <class Condition>
    void until(ViewedWorld& world, Condition condition) {
        ASSERT_TRUE(wait_until(condition, [&] {
            world.update(std::chrono::steady_clock::now());
            for (std::string& notice : world.server.take_notices()) {
                notices.push_back(std::move(notice));
            }
            take_a_nap();
        }));
    }

    /// Welcomes the viewer and answers its subscriptions, with number 7 for snapshots. Its first query comes next.
    core::FakeSession begin(ViewedWorld&, evod::v1::Role role = evod::v1::ROLE_UNSPECIFIED) {
        core::FakeSession session = server.accept_and_welcome(0, role);
        const auto events = session.read_request();
        EXPECT_TRUE(events.has_subscribe_events());
        session.answer_subscription(events, 6);
        const auto snapshots = session.read_request();
        EXPECT_EQ(snapshots.subscribe_snapshots().world(), "default");
        EXPECT_EQ(snapshots.subscribe_snapshots().island(), 1u);
        session.answer_subscription(snapshots, 7);
        return session;
    }

    static void send_snapshot(core::FakeSession& session, std::uint32_t subscription_id, std::uint32_t island,
                              std::uint64_t tick, const std::string& world = "default", std::uint64_t sequence = 0) {
        evod::v1::SnapshotFrame frame;
        frame.set_width_px(100);
        frame.set_height_px(100);
        codec::encode_plain({}, frame);
        frame.set_world(world);
        frame.set_run_id("\xaa");
        frame.set_subscription_id(subscription_id);
        frame.set_island(island);
        frame.set_island_count(3);
        frame.set_tick(tick);
        frame.set_sequence(sequence); // 0: not acknowledged
        frame.set_state(evod::v1::RUN_STATE_RUNNING);
        session.send(frame);
    }

    static evod::v1::WorldInfo info(const std::string& name, evod::v1::RunState state) {
        evod::v1::WorldInfo world;
        world.set_name(name);
        world.set_run_id("aa");
        world.set_state(state);
        for (const char* gene :
             {"normal_speed", "impulse", "body_size", "base_health", "food_radius", "poison_radius"}) {
            world.add_gene_names(gene);
        }
        return world;
    }

    static void answer_statistics(core::FakeSession& session, const evod::v1::Request& question) {
        EXPECT_TRUE(question.has_get_statistics());
        evod::v1::ServerMessage message;
        message.mutable_response()->set_request_id(question.request_id());
        auto& statistics = *message.mutable_response()->mutable_statistics();
        *statistics.mutable_world() = info("default", evod::v1::RUN_STATE_RUNNING);
        for (std::uint32_t island = 0; island < 3; ++island) {
            statistics.add_last()->set_island(island);
            statistics.mutable_last(static_cast<int>(island))->set_fitness_best(100 + island);
        }
        session.send(message);
    }

    /// Sends a snapshot of island 1, and answers the query that it causes.
    void show_first_snapshot(ViewedWorld& world, core::FakeSession& session, std::uint64_t tick) {
        send_snapshot(session, 7, 1, tick);
        until(world, [&] { return world.feed.snapshot() != nullptr; });
        answer_statistics(session, session.read_request());
        until(world, [&] { return world.all_answered(); });
    }

    core::FakeServer server;
    std::vector<std::string> notices;
};

} // namespace evod::viewer
