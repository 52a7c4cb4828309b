// The loop's pace with a manual clock, and proof that time does not change what happens.
#include "server/runtime/simulation_loop.h"

#include "evod/v1/session.pb.h"
#include "proto/codec/framing.h"
#include "server/base/inline_executor.h"
#include "server/runtime/simulation_thread.h"
#include "tests/unit/runtime/loop_with_clock.h"

#include <gtest/gtest.h>

#include <future>
#include <optional>

namespace evod::runtime {
namespace {

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

} // namespace
} // namespace evod::runtime
