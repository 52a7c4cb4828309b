// Replays and seeks, next to live worlds.
#include "server/runtime/replay_loop.h"

#include "tests/unit/runtime/loops_with_disk.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace evod::runtime {
namespace {

TEST_F(LoopsWithDisk, ReplaysBeingOpenedCloseWithTheirOwner) {
    ask_create("w");
    ask_run("w");
    pass_until([&] { return tick("w") > 300; });
    std::size_t answered = 0, opened = 0;
    const auto open = [&](std::uint64_t owner) {
        const replay::WantedMoment at{.generation = {}, .tick = 290};
        ask(OpenReplay{.world = "w", .at = at}, owner, [&](const base::Result<std::string>& name) {
            ++answered;
            opened += name ? 1 : 0;
        });
    };
    constexpr std::size_t replays = 4;
    open(1); // ends while its run is being found
    loops.simulations.forget(1);
    for (std::size_t i = 0; i < replays; ++i) {
        open(2);
    }
    pass_until([&] { return answered == replays; });
    EXPECT_EQ(opened, replays);
    EXPECT_EQ(loops.replays.laboratory().entries().size(), replays);
    loops.simulations.forget(2);
    loops.pass();
    EXPECT_TRUE(loops.replays.laboratory().entries().empty());
}

TEST_F(LoopsWithDisk, AReplayThatHasLostItsPlaceEnds) {
    ask_create("w");
    ask_run("w");
    pass_until([&] { return tick("w") > 300; });
    const std::string open = open_replay("w");
    loops.simulations.end_replay({.name = open});
    loops.pass();
    EXPECT_TRUE(loops.replays.laboratory().entries().empty());
    std::optional<base::RefusalCode> refused;
    ask(OpenReplay{.world = "w", .at = replay::WantedMoment{.generation = {}, .tick = 290}}, 1,
        [&](const base::Result<std::string>& name) { refused = name.error().code; });
    const std::uint64_t request = requests;
    pass_until([&] {
        loops.simulations.end_replay({.session = 1, .request_id = request}); // until its run is found, it has no seek
        return refused.has_value();
    });
    EXPECT_EQ(refused, base::RefusalCode::ResourceExhausted);
    EXPECT_TRUE(loops.replays.laboratory().entries().empty());
}

TEST_F(LoopsWithDisk, ReplaysBeginAtTheWantedMoment) {
    ask_create("w");
    ask_run("w");
    pass_until([&] { return tick("w") > 300; });
    ask_pause("w");
    const auto opened_at = [&](std::optional<replay::WantedMoment> at) {
        std::string replay;
        ask(OpenReplay{.world = "w", .at = at}, 1, [&](const base::Result<std::string>& name) { replay = *name; });
        pass_until([&] { return !replay.empty(); });
        return tick(replay);
    };
    EXPECT_EQ(opened_at(std::nullopt), 0u);
    EXPECT_EQ(opened_at(replay::WantedMoment{.generation = {}, .tick = 290}), 290u);
    EXPECT_EQ(opened_at(replay::WantedMoment{}), tick("w")) << "without fields, it is the last moment";
}

/// The world begins a generation every six ticks and changes constantly, so that both happen while a seek waits for the
/// disk.
TEST_F(LoopsWithDisk, SeeksToTheEndOfARunShowItsState) {
    v1::Request create;
    create.mutable_create_world()->set_name("quick");
    const auto set = [&](v1::Request& request, const std::string& name) {
        auto& assignment = request.has_create_world() ? *request.mutable_create_world()->add_parameters()
                                                      : *request.mutable_set_parameters()->add_parameters();
        assignment.set_name(name);
        return assignment.mutable_value();
    };
    set(create, "population_size")->set_count(5);
    set(create, "generation_s")->set_real(0.1);
    ask(std::move(create));
    v1::Request speed;
    speed.mutable_set_speed()->set_world("quick");
    speed.mutable_set_speed()->mutable_speed()->set_max(true);
    ask(std::move(speed));
    ask_run("quick");
    pass_until([&] { return tick("quick") > 30; });
    std::string look;
    ask(OpenReplay{.world = "quick", .at = {}}, 1, [&](const base::Result<std::string>& name) { look = *name; });
    pass_until([&] { return !look.empty(); });

    struct Shown {
        simulation::Moment moment;
        base::StateHash hash;
    };
    const auto shown_at = [&](const replay::WantedMoment& to, bool and_change) {
        std::optional<base::Result<std::string>> answer;
        ask(Seek{.world = look, .to = to}, 1, [&](const base::Result<std::string>& name) { answer = name; });
        if (and_change) {
            v1::Request change;
            change.mutable_set_parameters()->set_world("quick");
            set(change, "force_per_unit")->set_real(1.0 + 0.01 * static_cast<double>(requests));
            ask(std::move(change));
        }
        pass_until([&] { return answer.has_value(); });
        EXPECT_TRUE(answer && *answer) << (answer ? to_text(answer->error()) : "no answer");
        const simulation::World& world = entry(look).world;
        return Shown{world.moment(), world.hash()};
    };
    std::vector<Shown> seen;
    while (seen.size() < 20 && !HasFatalFailure()) {
        seen.push_back(shown_at({}, true));
    }
    ask_pause("quick");
    pass_until([&] { return thread.idle(); });
    for (const Shown& then : seen) {
        const Shown again =
            shown_at({.generation = then.moment.generation, .tick = then.moment.generation_tick}, false);
        EXPECT_EQ(again.hash, then.hash) << "generation " << then.moment.generation << ", tick " << then.moment.tick;
    }
}

TEST_F(LoopsWithDisk, SeeksEndWithTheirOwnerOrReplay) {
    const std::string look = look_at_the_past_of_a_run();
    std::vector<base::Result<std::string>> outcomes;
    const auto seek = [&](std::uint64_t session, std::uint64_t tick) {
        ask(Seek{.world = look, .to = {.generation = {}, .tick = tick}}, session,
            [&](const base::Result<std::string>& name) { outcomes.push_back(name); });
    };
    seek(2, 299);
    loops.simulations.forget(2);
    seek(1, 7);
    pass_until([&] { return outcomes.size() == 1; });
    EXPECT_TRUE(outcomes[0]);
    EXPECT_EQ(tick(look), 7u) << "the first seek ended with its owner";
    seek(1, 299);
    ask(CloseReplay{look}, 1, [](const base::Result<std::string>&) {});
    pass_until([&] { return outcomes.size() == 2; });
    EXPECT_EQ(outcomes[1].error().code, base::RefusalCode::NotFound);
}

TEST_F(LoopsWithDisk, APacedReplayKeepsItsPaceDuringSeeks) {
    const std::string look = look_at_the_past_of_a_run(), paced = open_replay("long");
    clock.per_look = 50us;
    ask_speed(paced, 0.05); // 3 ticks a second: it does not reach its end while the files are read
    ask_run(paced);
    pass_until([&] { return tick(paced) > 0; });
    const auto began = clock.now();
    const std::uint64_t first = tick(paced);
    int seeks = 0;
    bool on_the_way = false;
    while (seeks < 4 || on_the_way || clock.now() - began < 5s) {
        if (!on_the_way) {
            on_the_way = true;
            ask(Seek{.world = look, .to = {.generation = {}, .tick = ++seeks % 2 == 1 ? 299u : 0u}}, 1,
                [&](const base::Result<std::string>& there) {
                    EXPECT_TRUE(there);
                    on_the_way = false;
                });
        }
        loops.pass();
        std::this_thread::sleep_for(100us);
    }
    const std::chrono::duration<double> passed = clock.now() - began;
    EXPECT_NEAR(static_cast<double>(tick(paced) - first), passed.count() * 3, 2);
    EXPECT_FALSE(entry(paced).slowed);
}

TEST_F(LoopsWithDisk, SeeksDoNotChangeLiveWorlds) {
    const std::string look = look_at_the_past_of_a_run();
    ask_create("w");
    ask_run("w");
    bool there = false;
    ask(Seek{.world = look, .to = {.generation = {}, .tick = 299}}, 1, [&](const auto&) { there = true; });
    pass_until([&] { return there && tick("w") > 100; });
    const simulation::World& lived = entry("w").world;
    simulation::World alone{lived.parameters().active, lived.seed()};
    while (alone.moment().tick < lived.moment().tick) {
        alone.advance_tick(executor);
    }
    EXPECT_EQ(alone.hash(), lived.hash());
    EXPECT_EQ(entry(look).world.moment().tick, 299u);
}

/// The number of ticks that replays of each user make at full speed.
TEST_F(LoopsWithDisk, UsersGetEqualTimeWhateverTheyOpen) {
    ask_create("w");
    ask_speed("w", {});
    ask_run("w");
    pass_until([&] { return tick("w") > 20'000; });
    ask_pause("w");
    std::vector<std::string> of_eve;
    for (std::uint64_t session = 2; session < 5; ++session) {
        for (int i = 0; i < 4; ++i) {
            of_eve.push_back(open_replay("w", {}, session, "eve"));
        }
    }
    const std::string of_ada = open_replay("w", {}, 1, "ada");
    for (const std::string& replay : of_eve) {
        ask_speed(replay, {});
        ask_run(replay);
    }
    ask_speed(of_ada, {});
    ask_run(of_ada);
    const auto together = [&] {
        std::uint64_t ticks = 0;
        for (const std::string& replay : of_eve) {
            ticks += tick(replay);
        }
        return ticks;
    };
    pass_until([&] { return tick(of_ada) > 0 && together() > 0; });
    const std::uint64_t eve = together(), ada = tick(of_ada);
    pass_until([&] { return tick(of_ada) > ada + 3'000; });
    EXPECT_NEAR(static_cast<double>(together() - eve) / static_cast<double>(tick(of_ada) - ada), 1, 0.1);
}

TEST_F(LoopsWithDisk, SlowedReplaysLeaveOthersTheirTime) {
    ask_create("w");
    ask_speed("w", {});
    ask_run("w");
    pass_until([&] { return tick("w") > 20'000; });
    ask_pause("w");
    const std::vector<std::string> of_eve{open_replay("w", {}, 2, "eve"), open_replay("w", {}, 2, "eve"),
                                          open_replay("w", {}, 2, "eve")};
    const std::string of_ada = open_replay("w", {}, 1, "ada");
    for (const std::string& replay : {of_eve[0], of_eve[1], of_eve[2], of_ada}) {
        ask_speed(replay, 10'000.0); // more than the processor can do
        ask_run(replay);
    }
    pass_until([&] { return entry(of_eve[0]).slowed && entry(of_ada).slowed; });
    const auto together = [&] { return tick(of_eve[0]) + tick(of_eve[1]) + tick(of_eve[2]); };
    const std::uint64_t eve = together(), ada = tick(of_ada);
    pass_until([&] { return tick(of_ada) > ada + 2'000; });
    EXPECT_NEAR(static_cast<double>(together() - eve) / static_cast<double>(tick(of_ada) - ada), 1, 0.15);
}

TEST_F(LoopsWithDisk, ReplaysAndEarlierGenerationsCanBeForked) {
    v1::Request create;
    create.mutable_create_world()->set_name("w");
    auto& seconds = *create.mutable_create_world()->add_parameters();
    seconds.set_name("generation_s");
    seconds.mutable_value()->set_real(0.5);
    ask(std::move(create));
    ask_run("w");
    pass_until([&] { return tick("w") > 100; }); // in generation 4
    ask_pause("w");
    const auto fork = [&](const std::string& of, const std::string& name, std::optional<std::uint64_t> generation) {
        ask_fork(of, name, generation);
        return answer_of_last();
    };
    const std::string look = open_replay("w", replay::WantedMoment{.generation = {}, .tick = 75});
    ASSERT_TRUE(fork(look, "of_replay", {}));
    EXPECT_EQ(entry("of_replay").world.hash(), entry(look).world.hash());
    EXPECT_EQ(tick("of_replay"), 75u);
    ASSERT_TRUE(fork("w", "of_generation", 2));
    ASSERT_TRUE(fork(look, "of_replay_at_generation", 2));
    EXPECT_EQ(entry("of_generation").world.moment().generation, 2u);
    EXPECT_EQ(entry("of_generation").world.hash(), entry("of_replay_at_generation").world.hash());
    const auto refused = fork("w", "of_nothing", 9);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().violations.at(0).field, "at_generation");
    EXPECT_EQ(fork("w@77", "of_nothing", {}).error().message, "there is no such replay");
    EXPECT_EQ(fork(look, "of_replay", {}).error().code, base::RefusalCode::AlreadyExists);
}

/// The outcomes of commands that are sent together.
TEST_F(LoopsWithDisk, CommandsAfterAForkFindIt) {
    const std::string look = look_at_the_past_of_a_run();
    const auto outcome = [&](std::uint64_t request) { return answered.at(request); };
    const std::uint64_t before = requests;
    ask_fork(look, "first");
    ask_run("first");
    ask_fork(look, "second");
    ask_create("second");
    ask_fork("long", "third", 1);
    ask_run("third");
    ask_fork(look, "last");
    ask(CloseReplay{look}, 1, [](const base::Result<std::string>&) {});
    pass_until([&] { return answered.size() >= before + 5 && waiting.empty(); });
    EXPECT_TRUE(outcome(before + 1));
    EXPECT_TRUE(outcome(before + 2)) << "the fork is run";
    EXPECT_TRUE(outcome(before + 3));
    EXPECT_EQ(outcome(before + 4).error().code, base::RefusalCode::AlreadyExists);
    pass_until([&] { return answered.contains(before + 6) && answered.contains(before + 7); });
    EXPECT_TRUE(outcome(before + 5));
    EXPECT_TRUE(outcome(before + 6));
    EXPECT_TRUE(outcome(before + 7)) << "the replay was closed after the fork";
}

TEST_F(LoopsWithDisk, AReplayMayCloseWhenItsSeekHasJustEnded) {
    const std::string first = look_at_the_past_of_a_run();
    ask(CloseReplay{first}, 1, [](const base::Result<std::string>&) {});
    for (int passes = 0; passes < 60; ++passes) {
        const std::string look = open_replay("long");
        ask(Seek{.world = look, .to = {.generation = {}, .tick = 299}}, 1, [](const base::Result<std::string>&) {});
        for (int step = 0; step < 2; ++step) { // its run is found, then the file is read
            loops.pass();
            ASSERT_TRUE(wait_until([&] { return loops.simulations.mailbox_of(look).pending(); },
                                   [&] {
                                       loops.handle_replies();
                                       take_a_nap();
                                   }));
        }
        for (int pass = 0; pass < passes; ++pass) {
            loops.pass();
        }
        passes % 2 == 0 ? loops.simulations.forget(1)
                        : ask(CloseReplay{look}, 1, [](const base::Result<std::string>&) {});
        loops.pass();
        loops.pass();
        EXPECT_TRUE(loops.replays.laboratory().entries().empty()) << passes << " passes";
    }
}

TEST_F(LoopsWithDisk, TimeAloneIsNotHeldAgainstAUser) {
    ask_create("w");
    ask_speed("w", {});
    ask_run("w");
    pass_until([&] { return tick("w") > 50'000; });
    ask_pause("w");
    const std::string of_eve = open_replay("w", {}, 2, "eve"), of_ada = open_replay("w", {}, 1, "ada");
    for (const std::string& replay : {of_eve, of_ada}) {
        ask_speed(replay, 10'000.0); // more than the processor can do
    }
    ask_run(of_eve);
    pass_until([&] { return tick(of_eve) > 10'000; });
    ask_run(of_ada);
    pass_until([&] { return tick(of_ada) > 0; });
    const std::uint64_t eve = tick(of_eve), ada = tick(of_ada);
    pass_until([&] { return tick(of_ada) > ada + 2'000; });
    EXPECT_NEAR(static_cast<double>(tick(of_eve) - eve) / static_cast<double>(tick(of_ada) - ada), 1, 0.15);
}

TEST_F(LoopsWithDisk, AReplayAtTheStartOfTroubleShowsWhatIsWritten) {
    take_away();
    // Sent in one mailbox, so that the replay is requested before the failure is detected.
    ask_create("other");
    ask_create("another");
    bool answered = false;
    ask(OpenReplay{.world = "other", .at = {}}, 1, [&](const base::Result<std::string>& name) {
        EXPECT_FALSE(name) << "its file could not be created";
        answered = true;
    });
    pass_until([&] { return answered; });
    EXPECT_EQ(state(), simulation::StorageState::Failing);
    // Two files that cannot be created are one failure, however often the disk is retried.
    for (int pass = 0; pass < 50; ++pass) {
        loops.pass();
        std::this_thread::sleep_for(1ms);
    }
    EXPECT_EQ(news, 1);
    EXPECT_EQ(reported, std::vector{simulation::StorageState::Failing});
}

} // namespace
} // namespace evod::runtime
