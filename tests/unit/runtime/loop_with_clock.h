// Loop: a simulation loop with a manual clock, for the tests of the loop. It keeps what the loop reports.
#pragma once

#include "server/runtime/simulation_loop.h"

#include "evod/v1/session.pb.h"
#include "server/base/inline_executor.h"
#include "tests/support/manual_clock.h"

#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <memory>
#include <string_view>
#include <variant>
#include <vector>

namespace evod::runtime {

using namespace std::chrono_literals;
using simulation::Laboratory;

inline simulation::CreateWorld create(const char* name, std::uint64_t seed = 1) {
    simulation::CreateWorld command{.name = name, .parameters = {}, .seed = base::Seed{seed}, .run_id = {seed, 1}};
    command.parameters.tick_s = 0.01; // so that times are round
    command.parameters.population_size = 5;
    return command;
}

/// A query for the list of the worlds.
inline QueryMail query(std::uint64_t session = 1) {
    v1::Request request;
    request.set_request_id(1);
    request.mutable_list_worlds();
    return {.session = session, .request = std::make_shared<const v1::Request>(std::move(request))};
}

class Loop : public testing::Test {
  protected:
    Loop()
        : loop{{mailbox, demand, executor, clock},
               {.events = [this](const Laboratory&, std::vector<simulation::Event> reported,
                                 const auto&) { events.insert(events.end(), reported.begin(), reported.end()); },
                .snapshot = [this](SnapshotPtr snapshot) { snapshots.push_back(std::move(snapshot)); },
                .reply =
                    [this](Reply reply) {
                        if (auto* done = std::get_if<CommandDone>(&reply)) {
                            EXPECT_TRUE(done->outcome) << to_text(done->outcome.error());
                            answers.push_back(std::move(*done));
                        } else if (const auto* answered = std::get_if<QueryDone>(&reply)) {
                            on_query(answered->response);
                        }
                        pongs += std::holds_alternative<Pong>(reply);
                    },
                .counted = &counted}} {}

    void send(simulation::Command command) { mailbox.try_push(CommandMail{std::move(command), {}, "command"}, ""); }
    /// Sends queries. The simulation calls on_query() while it answers them.
    void send_queries(int count) {
        for (int i = 0; i < count; ++i) {
            mailbox.push(query());
        }
    }
    const simulation::Entry& world(std::string_view name = "") { return **loop.laboratory().find(name); }
    std::uint64_t tick(std::string_view name = "") { return world(name).world.moment().tick; }
    void watch(const char* name, double rate_hz, std::uint64_t newcomers = 1) {
        demand.set(
            {{name, WorldDemand{.rate_hz = rate_hz, .all_islands = true, .islands = {}, .newcomers = newcomers}}});
    }
    /// Time passes in steps of 1 ms, with a pass after each.
    void live_through(std::chrono::milliseconds time) {
        for (auto passed = 0ms; passed < time; passed += 1ms) {
            clock.advance(1ms);
            loop.pass();
        }
    }

    Mailbox mailbox;
    StreamDemand demand;
    base::InlineExecutor executor;
    support::ManualClock clock;
    std::vector<simulation::Event> events;
    std::vector<SnapshotPtr> snapshots;
    std::vector<CommandDone> answers;
    int pongs = 0;
    std::function<void(const v1::Response&)> on_query = [](const v1::Response&) {};
    metrics::Worlds counted;
    SimulationLoop loop;
};

} // namespace evod::runtime
