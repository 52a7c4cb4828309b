// The loop's pace with a manual clock, and proof that time does not change what happens.
#include "server/runtime/simulation_loop.h"

#include "evod/v1/session.pb.h"
#include "proto/codec/framing.h"
#include "server/base/inline_executor.h"
#include "server/runtime/simulation_thread.h"
#include "tests/support/manual_clock.h"
#include "tests/support/waiting.h"
#include "tests/unit/recording/recorded_run.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <fstream>
#include <functional>
#include <future>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <thread>

namespace evod::runtime {
namespace {

using namespace std::chrono_literals;
using simulation::Laboratory;

simulation::CreateWorld create(const char* name, std::uint64_t seed = 1) {
    simulation::CreateWorld command{.name = name, .parameters = {}, .seed = base::Seed{seed}, .run_id = {seed, 1}};
    command.parameters.tick_s = 0.01; // so that times are round
    command.parameters.population_size = 5;
    return command;
}

/// A query for the list of the worlds.
QueryMail query(std::uint64_t session = 1) {
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

TEST_F(Loop, AnswersEachPing) {
    mailbox.push(Ping{});
    mailbox.push(Ping{});
    loop.pass();
    EXPECT_EQ(pongs, 2);
}

TEST_F(Loop, SleepsUntilMailWhenIdle) {
    EXPECT_FALSE(loop.pass());
    send(create("w"));
    EXPECT_FALSE(loop.pass());
    EXPECT_EQ(tick(), 0);
}

TEST_F(Loop, APacedWorldTakesATickPerTickLength) {
    send(create("w"));
    send(simulation::Run{"w", {}});
    loop.pass();
    EXPECT_EQ(tick(), 1) << "the first tick comes at once";
    live_through(500ms);
    EXPECT_EQ(tick(), 51);
    const auto now = clock.now();
    EXPECT_EQ(loop.pass(), now + 10ms);
}

TEST_F(Loop, TheSpeedFactorScalesThePace) {
    send(create("fast"));
    send(create("slow", 2));
    send(simulation::SetSpeed{"fast", 10.0});
    send(simulation::SetSpeed{"slow", 0.1});
    send(simulation::Run{"fast", {}});
    send(simulation::Run{"slow", {}});
    loop.pass();
    live_through(1000ms);
    EXPECT_EQ(tick("fast"), 1001);
    EXPECT_EQ(tick("slow"), 11);
}

TEST_F(Loop, ALateWorldCatchesUpNoMoreThanTheBound) {
    send(create("w"));
    send(simulation::Run{"w", {}});
    loop.pass();
    clock.advance(10s);
    for (int i = 0; i < 100; ++i) {
        loop.pass();
    }
    // The late tick, the bound's worth of ticks, and the tick that is due now.
    const auto given_back = 1 + 1 + WorldPace::catch_up_max / 10ms + 1;
    EXPECT_EQ(tick(), given_back);
    live_through(100ms);
    EXPECT_EQ(tick(), given_back + 10);
}

TEST_F(Loop, ASlowedWorldReportsItAndSkipsNoTick) {
    send(create("w"));
    send(simulation::Run{"w", {}});
    watch("w", 100, 1);
    const auto slowed = [&] { return (*loop.laboratory().find("w"))->slowed; };
    const auto passes = [&](Clock::duration each) {
        for (Clock::duration passed{}; passed < 2s; passed += each) {
            clock.advance(each);
            loop.pass();
        }
    };
    passes(1ms);
    EXPECT_FALSE(slowed());
    EXPECT_FALSE(snapshots.back()->slowed);
    passes(100ms); // of which it catches up at most 50 ms
    EXPECT_TRUE(slowed());
    EXPECT_TRUE(snapshots.back()->slowed);
    passes(1ms);
    EXPECT_FALSE(slowed());
    EXPECT_FALSE(snapshots.back()->slowed);
    passes(100ms);
    send(simulation::Pause{"w"});
    loop.pass();
    EXPECT_FALSE(slowed()) << "it is idle";
}

TEST_F(Loop, AWorldDoesNotCatchUpAfterAPause) {
    send(create("w"));
    send(simulation::Run{"w", {}});
    loop.pass();
    send(simulation::Pause{"w"});
    loop.pass();
    clock.advance(10s);
    send(simulation::Resume{"w"});
    for (int i = 0; i < 10; ++i) {
        loop.pass();
    }
    EXPECT_EQ(tick(), 2);
}

TEST_F(Loop, FullSpeedRunsInSlices) {
    send(create("w"));
    send(simulation::SetSpeed{"w", {}});
    send(simulation::Run{"w", {}});
    clock.per_look = 100us; // the length of a tick
    EXPECT_TRUE(loop.pass());
    EXPECT_NEAR(static_cast<double>(tick()), Pace::slice / 100us, 3);
}

TEST_F(Loop, ASliceEndsWhenMailArrives) {
    // The clock does not advance, so only mail ends the slice. The events of the first generation send it.
    auto create_other = create("quick", 2);
    create_other.parameters.fitness = parameters::FitnessFunction::GeneSum;
    bool sent = false;
    SimulationLoop other{{mailbox, demand, executor, clock},
                         {.events =
                              [&](const Laboratory&, std::vector<simulation::Event>, const auto&) {
                                  if (!sent) {
                                      send(simulation::Pause{"quick"});
                                  }
                                  sent = true;
                              },
                          .snapshot = {}}};
    mailbox.drain();
    send(create_other);
    send(simulation::SetSpeed{"quick", {}});
    send(simulation::Run{"quick", {}});
    other.pass();
    EXPECT_EQ((*other.laboratory().find("quick"))->world.moment().tick, 1);
}

TEST_F(Loop, APacedWorldKeepsItsPaceBesideAFastOne) {
    send(create("paced"));
    send(create("busy", 2));
    send(simulation::SetSpeed{"busy", {}});
    send(simulation::Run{"paced", {}});
    send(simulation::Run{"busy", {}});
    clock.per_look = 50us;
    const auto began = clock.now();
    while (clock.now() - began < 1s) {
        loop.pass();
    }
    EXPECT_NEAR(static_cast<double>(tick("paced")), 101, 2);
    EXPECT_GT(tick("busy"), 3000);
}

/// Always has a query waiting, each taking 4 ms.
class LoopWithAsker : public Loop {
  protected:
    void begin_asking() {
        on_query = [this](const v1::Response&) {
            ++answered;
            clock.advance(4ms);
            send_queries(1);
        };
        send_queries(1);
    }
    int answered = 0;
};

TEST_F(LoopWithAsker, QueriesGetAllIdleTime) {
    send(create("w"));
    send(simulation::Run{"w", {}});
    loop.pass();
    begin_asking();
    const auto began = clock.now();
    auto next = loop.pass();
    while (clock.now() - began < 2s) {
        if (next && *next > clock.now() && !mailbox.pending()) {
            clock.advance(*next - clock.now());
        }
        next = loop.pass();
    }
    EXPECT_NEAR(static_cast<double>(tick()), 201, 2);
    EXPECT_NEAR(answered, 500, 10) << "no world needed the time";
    EXPECT_FALSE(world().slowed);
}

TEST_F(LoopWithAsker, QueriesCostAFastWorldOnlyAShareOfTheTime) {
    send(create("w"));
    send(simulation::SetSpeed{"w", {}});
    send(simulation::Run{"w", {}});
    clock.per_look = 100us; // the length of a tick
    loop.pass();
    begin_asking();
    const auto began = clock.now();
    while (clock.now() - began < 2s) {
        loop.pass();
    }
    EXPECT_NEAR(answered * 4.0, 2000.0 / Queries::share, 12);
}

TEST_F(Loop, CommandsDoNotWaitForQueries) {
    send(create("w"));
    loop.pass();
    std::vector<bool> running;
    on_query = [&](const v1::Response&) {
        running.push_back(world("w").wants_tick());
        if (running.size() == 1) {
            send(simulation::Run{"w", {}});
        }
    };
    send_queries(2);
    loop.pass();
    EXPECT_EQ(running, (std::vector{false, true}));
}

TEST_F(Loop, FollowsAWorldThatIsCreatedBetweenQueries) {
    send(create("w"));
    watch("late", 60);
    loop.pass();
    on_query = [&](const v1::Response&) { send(create("late", 2)); };
    send_queries(1);
    loop.pass();
    ASSERT_EQ(snapshots.size(), 1u);
    EXPECT_EQ(snapshots[0]->world, "late");
}

TEST_F(Loop, AWakeUpDuringQueriesCausesAnotherPass) {
    send(create("w"));
    send(simulation::Run{"w", {}});
    loop.pass();
    snapshots.clear();
    clock.advance(10ms);
    int answered = 0;
    on_query = [&](const v1::Response& response) {
        if (++answered == 1) {
            clock.advance(40ms); // more than the saved budget, so the next query waits for the due ticks
            return;
        }
        EXPECT_GT(response.worlds().worlds(0).tick(), 1u);
        watch("w", 60);
        mailbox.wake();
    };
    send_queries(2);
    const auto next = loop.pass();
    EXPECT_EQ(answered, 2);
    EXPECT_TRUE(snapshots.empty());
    ASSERT_TRUE(next);
    EXPECT_LE(*next, clock.now());
    loop.pass();
    EXPECT_EQ(snapshots.size(), 1u);
}

TEST_F(Loop, PendingQueriesAreAnsweredAtTheEnd) {
    send(create("w"));
    send(simulation::SetSpeed{"w", {}});
    send(simulation::Run{"w", {}});
    int answered = 0;
    on_query = [&](const v1::Response&) {
        ++answered;
        clock.advance(100ms);
    };
    send_queries(50);
    clock.per_look = 100us;
    loop.pass();
    EXPECT_LT(answered, 50);
    loop.close();
    EXPECT_EQ(answered, 50);
}

TEST_F(Loop, TheQueryOfASessionThatEndedIsDropped) {
    int answered = 0;
    on_query = [&](const v1::Response&) { ++answered; };
    mailbox.push(query(1));
    mailbox.push(query(2));
    mailbox.push(SessionEnded{1});
    loop.pass();
    EXPECT_EQ(answered, 1);
}

TEST_F(Loop, MeasuresTicksPerSecond) {
    send(create("w"));
    send(simulation::Run{"w", {}});
    live_through(300ms);
    EXPECT_NEAR(world().ticks_per_s, 100, 10) << "the first figure comes early";
    live_through(2000ms);
    EXPECT_NEAR(world().ticks_per_s, 100, 2);
    send(simulation::Pause{"w"});
    loop.pass();
    EXPECT_EQ(world().ticks_per_s, 0);
}

TEST_F(Loop, ReadsTheClockRarelyWhenTicksAreShort) {
    send(create("w"));
    send(simulation::SetSpeed{"w", {}});
    send(simulation::Run{"w", {}});
    clock.per_look = 1us;
    loop.pass();
    const std::uint64_t ticks_before = tick("w");
    const auto began = clock.now();
    loop.pass();
    const auto looks = (clock.now() - began) / 1us;
    const std::uint64_t ticks = tick("w") - ticks_before;
    EXPECT_GT(static_cast<double>(ticks), 2.0 * static_cast<double>(looks));
    ASSERT_EQ(counted.list().size(), 1u);
    EXPECT_EQ(counted.list()[0]->tick_time.count(), tick("w")) << "every tick is counted";

    clock.per_look = 50us;
    loop.pass();
    const std::uint64_t before_long_ones = tick("w");
    const auto long_began = clock.now();
    loop.pass();
    EXPECT_LE(tick("w") - before_long_ones, static_cast<std::uint64_t>((clock.now() - long_began) / 50us));

    clock.per_look = 1us;
    loop.pass();
    const std::uint64_t end = tick("w") + 7;
    send(simulation::RunUntilTick{"w", end});
    loop.pass();
    EXPECT_EQ(tick("w"), end) << "the world stops at its goal";
}

TEST_F(Loop, CountsTheTicksOfEachExistingWorld) {
    send(create("a"));
    send(create("b", 2));
    send(simulation::Run{"a", {}});
    loop.pass();
    live_through(1000ms);
    ASSERT_EQ(counted.list().size(), 2u);
    EXPECT_EQ(counted.list()[0]->name, "a");
    EXPECT_EQ(counted.list()[0]->tick_time.count(), tick("a"));
    EXPECT_EQ(counted.list()[0]->ticks_per_s.value(), world("a").ticks_per_s);
    EXPECT_EQ(counted.list()[1]->tick_time.count(), 0u);
    send(simulation::Pause{"a"});
    loop.pass();
    EXPECT_EQ(counted.list()[0]->ticks_per_s.value(), 0);
    send(simulation::DeleteWorld{"a"});
    loop.pass();
    ASSERT_EQ(counted.list().size(), 1u);
    EXPECT_EQ(counted.list()[0]->name, "b");
}

TEST_F(Loop, AnAppliedCommandNamesItsWorld) {
    send(create("only"));
    send(simulation::Run{"", 1});
    loop.pass();
    EXPECT_EQ(std::get<simulation::Run>(answers.back().mail.command).world, "only");
}

TEST_F(Loop, AnAnswerShowsTheStateAfterItsCommand) {
    send(create("w"));
    send(simulation::Run{"w", {}});
    live_through(200ms);
    answers.clear();
    send(simulation::Pause{"w"});
    loop.pass();
    ASSERT_EQ(answers.size(), 1);
    EXPECT_EQ(answers[0].outcome->tick, tick("w"));
    codec::FrameReader reader{codec::client_limits};
    reader.feed(std::as_bytes(std::span{answers[0].frame}));
    const auto message = codec::parse_body<v1::ServerMessage>((**reader.next()).body);
    ASSERT_TRUE(message);
    EXPECT_EQ(message->response().world().state(), v1::RUN_STATE_PAUSED);
    EXPECT_EQ(message->response().world().tick(), tick("w"));
}

TEST_F(Loop, TakesNoSnapshotWithoutAViewer) {
    send(create("w"));
    send(simulation::Run{"w", {}});
    live_through(100ms);
    EXPECT_TRUE(snapshots.empty());
}

TEST_F(Loop, SnapshotsComeAtTheRequestedRate) {
    send(create("w"));
    send(simulation::Run{"w", {}});
    loop.pass();
    watch("w", 25);
    loop.pass();
    snapshots.clear();
    live_through(2000ms);
    EXPECT_NEAR(static_cast<double>(snapshots.size()), 50, 1);
    for (std::size_t i = 1; i < snapshots.size(); ++i) {
        EXPECT_LT(snapshots[i - 1]->moment.tick, snapshots[i]->moment.tick);
    }
}

TEST_F(Loop, NewViewersAndChangesGetASnapshotAtOnce) {
    send(create("w"));
    loop.pass();
    watch("w", 0.001);
    loop.pass();
    ASSERT_EQ(snapshots.size(), 1);
    live_through(100ms);
    EXPECT_EQ(snapshots.size(), 1) << "the world is idle";
    watch("w", 0.001, 2);
    loop.pass();
    EXPECT_EQ(snapshots.size(), 2) << "a new viewer";
    send(simulation::RunUntilTick{"w", 3});
    loop.pass();
    ASSERT_EQ(snapshots.size(), 3) << "Run changed it";
    EXPECT_TRUE(snapshots.back()->after_change);
    live_through(100ms);
    ASSERT_EQ(snapshots.size(), 4) << "it reached its goal";
    EXPECT_EQ(snapshots.back()->moment.tick, 3);
    EXPECT_EQ(snapshots.back()->state, simulation::RunState::Paused);
    EXPECT_EQ(snapshots.back()->hash, world().world.hash());
    send(simulation::ResetWorld{"w", {}, {9, 9}});
    loop.pass();
    EXPECT_EQ(snapshots.size(), 5);
    send(simulation::DeleteWorld{"w"});
    send(create("w", 3));
    loop.pass();
    ASSERT_EQ(snapshots.size(), 6) << "a new world of the same name";
    EXPECT_EQ(snapshots.back()->run_id, (simulation::RunId{3, 1}));
}

TEST_F(Loop, OnlySubscribedIslandsAreCopied) {
    auto command = create("w");
    command.parameters.island_count = 5;
    send(command);
    demand.set({{"w", WorldDemand{.rate_hz = 1, .all_islands = false, .islands = {1, 3, 99}, .newcomers = 1}}});
    loop.pass();
    ASSERT_EQ(snapshots.size(), 1);
    ASSERT_EQ(snapshots[0]->islands.size(), 2);
    EXPECT_EQ(snapshots[0]->islands[1].island, 3);
    EXPECT_EQ(snapshots[0]->island_count, 5);
}

TEST_F(Loop, ASnapshotHasEveryLivingOrganismAndItem) {
    auto command = create("w");
    command.parameters.population_size = 200;
    command.parameters.food_count = 40;
    command.parameters.respawn_s = 10;
    command.parameters.health_loss_per_s = 190; // health is 80 to 120
    send(command);
    send(simulation::Run{"w", {}});
    watch("w", 1000);
    std::size_t seen_void = 0, seen_away = 0;
    for (int i = 0; i < 60; ++i) {
        live_through(10ms);
        ASSERT_FALSE(snapshots.empty());
        const IslandSnapshot& snapshot = snapshots.back()->islands[0];
        const simulation::Island& island = world().world.islands()[0];
        ASSERT_EQ(snapshots.back()->hash, world().world.hash());
        std::size_t alive = 0;
        ASSERT_EQ(snapshot.organisms.place_of.size(), 200);
        for (std::uint32_t id = 0; id < 200; ++id) {
            const std::uint32_t place = snapshot.organisms.place_of[id];
            const auto body = island.body_of(id);
            ASSERT_EQ(place != simulation::Island::no_body, body.has_value());
            if (!body) {
                continue;
            }
            ASSERT_LT(place, snapshot.organisms.x.size());
            EXPECT_EQ(snapshot.organisms.x[place], island.bodies().x[*body]);
            EXPECT_EQ(snapshot.organisms.y[place], island.bodies().y[*body]);
            EXPECT_EQ(snapshot.organisms.radius_px[place], island.bodies().radius[*body]);
            EXPECT_EQ(snapshot.organisms.health[place], island.living().health[*body]);
            ++alive;
        }
        EXPECT_EQ(alive, island.alive_count());
        EXPECT_EQ(snapshot.organisms.alive_count, alive);
        EXPECT_EQ(snapshot.food.all.size(), 40);
        EXPECT_EQ(snapshot.food.present_count,
                  std::ranges::count(snapshot.food.all, 0u, &simulation::Items::Item::due_tick));
        EXPECT_EQ(simulation::mean_health(snapshot.organisms.health, snapshot.organisms.alive_count),
                  island.live_statistics().health_mean);
        seen_void += snapshot.organisms.x.size() - alive;
        seen_away += 40 - snapshot.food.present_count;
    }
    EXPECT_GT(seen_void, 0);
    EXPECT_GT(seen_away, 0);
}

TEST_F(Loop, ASnapshotIsImmutableAndItsMemoryReused) {
    send(create("w"));
    send(simulation::Run{"w", {}});
    watch("w", 1000);
    loop.pass();
    const SnapshotPtr kept = snapshots.front();
    const auto place = kept->islands[0].organisms.x;
    snapshots.clear();
    std::set<const void*> used;
    for (int i = 0; i < 100; ++i) {
        live_through(10ms);
        for (const SnapshotPtr& snapshot : snapshots) {
            used.insert(snapshot.get());
        }
        snapshots.clear();
    }
    EXPECT_EQ(kept->islands[0].organisms.x, place);
    EXPECT_LE(used.size(), 2);
}

TEST_F(Loop, EventsArriveInOrder) {
    auto command = create("w");
    command.parameters.generation_s = 0.05; // 5 ticks
    send(command);
    send(simulation::Run{"w", 2});
    live_through(200ms);
    ASSERT_EQ(events.size(), 3);
    EXPECT_TRUE(std::holds_alternative<simulation::GenerationFinished>(events[0].kind));
    EXPECT_TRUE(std::holds_alternative<simulation::GenerationFinished>(events[1].kind));
    EXPECT_TRUE(std::holds_alternative<simulation::GoalReached>(events[2].kind));
    EXPECT_EQ(events[2].tick, 10);
}

// ---- determinism -----------------------------------------------------------------------------------------------

/// The commands to the worlds below, with their ticks.
parameters::Assignment change_at(std::uint64_t tick) {
    return {tick % 2 ? "food_health" : "mutation_chance", tick % 2 ? 20.0 + static_cast<double>(tick) / 10 : 0.5};
}
constexpr std::uint64_t changes[] = {7, 40, 41, 90};
constexpr std::uint64_t last_tick = 150;

simulation::CreateWorld create_for_comparison() {
    auto command = create("w", 42);
    command.parameters.population_size = 50;
    command.parameters.generation_s = 0.6;
    return command;
}

base::StateHash hash_of_a_world_advanced_directly() {
    base::InlineExecutor executor;
    const auto command = create_for_comparison();
    simulation::World world{command.parameters, command.seed};
    for (const std::uint64_t at : {changes[0], changes[1], changes[2], changes[3], last_tick}) {
        while (world.moment().tick < at) {
            world.advance_tick(executor);
        }
        if (at != last_tick) {
            world.request_parameters(*parameters::assign(world.parameters().requested, std::vector{change_at(at)}));
        }
    }
    return world.hash();
}

TEST_F(Loop, CommandsAtTheirTicksReproduceTheHash) {
    send(create_for_comparison());
    send(simulation::SetSpeed{"w", 3.0});
    watch("w", 77);
    for (const std::uint64_t at : changes) {
        send(simulation::RunUntilTick{"w", at});
        live_through(1000ms);
        ASSERT_EQ(tick(), at);
        send(simulation::SetParameters{"w", {change_at(at)}, false, {}});
    }
    send(simulation::RunUntilTick{"w", last_tick});
    live_through(1000ms);
    EXPECT_EQ(world().world.hash(), hash_of_a_world_advanced_directly());
}

TEST(SimulationThread, ReproducesTheHash) {
    Mailbox mailbox;
    StreamDemand demand;
    demand.set({{"w", WorldDemand{.rate_hz = 100, .all_islands = true, .islands = {}, .newcomers = 1}}});
    base::InlineExecutor executor;
    SteadyClock clock;
    std::optional<std::promise<v1::WorldInfo>> seen; // set before a query is sent
    SimulationThread thread{{},
                            mailbox,
                            std::make_unique<SimulationLoop>(
                                LoopTools{mailbox, demand, executor, clock},
                                LoopOutputs{.events = [](auto&&...) {},
                                            .snapshot = [](SnapshotPtr) {},
                                            .reply =
                                                [&](const Reply& reply) {
                                                    if (const auto* done = std::get_if<CommandDone>(&reply)) {
                                                        EXPECT_TRUE(done->outcome);
                                                    } else {
                                                        seen->set_value(
                                                            std::get<QueryDone>(reply).response.worlds().worlds(0));
                                                    }
                                                }})};
    const auto send = [&](simulation::Command command) {
        ASSERT_TRUE(mailbox.try_push(CommandMail{std::move(command), {}, "command"}, ""));
    };
    const auto look = [&] {
        auto info = seen.emplace().get_future();
        mailbox.push(query());
        return info.get();
    };
    send(create_for_comparison());
    send(simulation::SetSpeed{"w", {}});
    for (const std::uint64_t at : changes) {
        send(simulation::RunUntilTick{"w", at});
        while (look().tick() < at) {
        }
        send(simulation::SetParameters{"w", {change_at(at)}, false, {}});
    }
    send(simulation::RunUntilTick{"w", last_tick});
    while (look().tick() < last_tick) {
    }
    EXPECT_EQ(look().state_hash(), to_text(hash_of_a_world_advanced_directly()));
}

TEST_F(Loop, SlowTicksGetCheckpointsThatChangeNothing) {
    recording::TemporaryFolder folder;
    auto data = run_file::DataFolder::open(folder.path());
    base::StateHash hashes[2];
    for (const auto per_look : {1us, 20'000us}) {
        recording::StorageThread thread{{}};
        recording::Recorder recorder{*data, thread};
        clock.per_look = per_look;
        Mailbox letters;
        SimulationLoop kept{
            {letters, demand, executor, clock}, {.events = [](auto&&...) {}, .snapshot = [](auto&&) {}}, {}, &recorder};
        const auto apply = [&](simulation::Command command) {
            letters.try_push(CommandMail{std::move(command), {}, "command"}, "");
            kept.pass();
        };
        apply(create("w", 3));
        apply(simulation::SetSpeed{"w", std::nullopt});
        apply(simulation::RunUntilTick{"w", 1000});
        const simulation::World& run = (*kept.laboratory().find("w"))->world;
        while (run.moment().tick < 1000) {
            kept.pass();
        }
        ASSERT_TRUE(wait_until([&] { return thread.idle(); }));
        const auto file = run_file::RunFile::open_read_only(data->file_of("w"));
        ASSERT_TRUE(file) << to_text(file.error());
        const auto checkpoints = (*file)->checkpoints().read(0, run.moment().tick);
        ASSERT_TRUE(checkpoints) << to_text(checkpoints.error());
        EXPECT_EQ(checkpoints->empty(), per_look == 1us);
        hashes[per_look != 1us] = run.hash();
        recorder.end("w", {3, 1}, {.tick = run.moment().tick});
        ASSERT_TRUE(wait_until([&] { return thread.idle(); }));
        std::filesystem::remove(data->ended_file_of("w", {3, 1}));
    }
    EXPECT_EQ(hashes[0], hashes[1]);
}

TEST_F(Loop, AWorldIsRefusedIfItsFileExists) {
    recording::TemporaryFolder folder;
    auto data = run_file::DataFolder::open(folder.path());
    recording::StorageThread thread{{}};
    recording::Recorder recorder{*data, thread};
    Mailbox letters;
    std::string said; // of the last command; refusals come at once, on this thread
    const auto on_reply = [&](const Reply& reply) {
        if (const auto* done = std::get_if<CommandDone>(&reply); done && !done->outcome) {
            said = to_text(done->outcome.error());
        }
    };
    SimulationLoop kept{{letters, demand, executor, clock},
                        {.events = [](auto&&...) {}, .snapshot = [](auto&&) {}, .reply = on_reply},
                        {},
                        &recorder};
    const auto apply = [&](simulation::Command command) {
        said.clear();
        letters.try_push(CommandMail{std::move(command), {}, "command"}, "");
        kept.pass();
    };
    const std::string taken = data->file_of("taken");
    std::ofstream{taken} << "another program's";
    apply(create("taken"));
    EXPECT_THAT(said, testing::HasSubstr("the run would be stored in " + taken + ", which exists already"));
    std::ofstream{run_file::DataFolder::next_file_of(data->file_of("next"))} << "another program's";
    apply(create("next"));
    EXPECT_THAT(said, testing::HasSubstr("next.evod-next, which exists already"));
    EXPECT_TRUE(kept.laboratory().entries().empty());
    apply(create("w"));
    EXPECT_EQ(said, "");
    apply(create("w"));
    EXPECT_THAT(said, testing::HasSubstr("a world with that name already exists"));
    apply(simulation::ForkWorld{.world = "w", .name = "taken", .at_generation = {}, .run_id = {4, 4}});
    EXPECT_THAT(said, testing::HasSubstr(taken));
    // A name is free at once, although its file may still exist.
    for (int i = 0; i < 20; ++i) {
        apply(simulation::DeleteWorld{"w"});
        EXPECT_EQ(said, "");
        apply(create("w", static_cast<std::uint64_t>(i) + 10));
        EXPECT_EQ(said, "");
    }
    EXPECT_FALSE(recorder.trouble());
    ASSERT_TRUE(wait_until([&] { return thread.idle(); }));
    EXPECT_TRUE(run_file::RunFile::open_read_only(data->file_of("w")));
    std::filesystem::remove(taken);
    apply(create("taken", 99));
    EXPECT_EQ(said, "");
}

} // namespace
} // namespace evod::runtime
