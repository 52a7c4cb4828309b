#include "server/simulation/laboratory.h"

#include "server/base/inline_executor.h"
#include "server/simulation/world_name.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include <string>
#include <vector>

namespace evod::simulation {
namespace {

using base::RefusalCode;
using testing::HasSubstr;

class OneWorld : public testing::Test {
  protected:
    OneWorld() {
        parameters.population_size = 10;
        parameters.generation_s = 0.1; // 6 ticks
        EXPECT_TRUE(laboratory.apply(CreateWorld{"w", parameters, base::Seed{1}, RunId{1, 2}}).has_value());
    }
    Entry& entry() { return *laboratory.entries().front(); }
    /// Performs ticks while the world wants them; at most `limit`.
    std::uint64_t run_on(std::uint64_t limit = 1000) {
        std::uint64_t ticks = 0;
        for (; ticks < limit && entry().wants_tick(); ++ticks) {
            laboratory.advance(entry(), executor);
        }
        return ticks;
    }
    RefusalCode code_of(const Command& command) {
        const auto result = laboratory.apply(command);
        EXPECT_FALSE(result.has_value());
        return result ? RefusalCode::Unimplemented : result.error().code;
    }
    SetParameters set(std::vector<parameters::Assignment> assignments) {
        return {.world = "w", .assignments = std::move(assignments), .dry_run = false, .expected_revision = {}};
    }
    template <class Kind>
    std::size_t count_events() {
        std::size_t count = 0;
        for (const Event& event : laboratory.take_events()) {
            count += std::holds_alternative<Kind>(event.kind);
        }
        return count;
    }

    parameters::Parameters parameters;
    Laboratory laboratory;
    base::InlineExecutor executor;
};

TEST_F(OneWorld, WaitsAtItsFirstMomentAfterCreation) {
    EXPECT_EQ(entry().state(), RunState::Waiting);
    EXPECT_FALSE(entry().wants_tick());
    EXPECT_EQ(entry().world.moment().tick, 0u);
    EXPECT_EQ(entry().world.moment().generation, 1u);
    EXPECT_EQ(entry().world.alive_count(), 10u);
    EXPECT_EQ(entry().run_id, (RunId{1, 2}));
}

TEST_F(OneWorld, RunsTheRequestedGenerations) {
    ASSERT_TRUE(laboratory.apply(simulation::Run{"w", 3}).has_value());
    EXPECT_EQ(entry().state(), RunState::Running);
    EXPECT_EQ(run_on(), 18u);
    EXPECT_EQ(entry().state(), RunState::Waiting);
    EXPECT_TRUE(entry().world.generation_over());
    EXPECT_EQ(count_events<GoalReached>(), 1u);
    ASSERT_TRUE(laboratory.apply(simulation::Run{"w", 1}).has_value());
    EXPECT_EQ(run_on(4), 4u);
    ASSERT_TRUE(laboratory.apply(simulation::Run{"w", 1}).has_value())
        << "again, within a generation: that generation counts";
    EXPECT_EQ(run_on(), 2u);
    EXPECT_EQ(entry().world.moment().generation, 4u);
}

TEST_F(OneWorld, RunsWithoutEndIfNoNumberIsGiven) {
    ASSERT_TRUE(laboratory.apply(simulation::Run{"w", {}}).has_value());
    EXPECT_EQ(run_on(), 1000u);
    ASSERT_TRUE(laboratory.apply(simulation::Run{"w", ~std::uint64_t{0}}).has_value()) << "more than can be counted";
    EXPECT_EQ(run_on(100), 100u);
}

TEST_F(OneWorld, ADamagedWorldKeepsItsNameAndPlace) {
    laboratory.adopt({.name = "broken", .run_id = {}, .reason = "broken.evod is damaged"});
    const auto refused = laboratory.find("broken");
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, RefusalCode::FailedPrecondition);
    EXPECT_EQ(refused.error().reason, base::Reason::WorldDamaged);
    EXPECT_EQ(refused.error().message, "the world does not run: broken.evod is damaged");
    EXPECT_EQ(code_of(Pause{"broken"}), RefusalCode::FailedPrecondition);
    EXPECT_EQ(code_of(CreateWorld{"broken", parameters, base::Seed{1}, RunId{3, 4}}), RefusalCode::AlreadyExists);
    EXPECT_EQ(code_of(ForkWorld{.world = "w", .name = "broken", .at_generation = {}, .run_id = {3, 4}}),
              RefusalCode::AlreadyExists);
    EXPECT_THAT(laboratory.find("").error().message, HasSubstr("w, broken")) << "there are two worlds";
    EXPECT_TRUE(laboratory.apply(DeleteWorld{"broken"}));
    EXPECT_TRUE(laboratory.damaged().empty());
    EXPECT_TRUE(laboratory.find("")) << "now there is one";
}

TEST_F(OneWorld, TheOnlyWorldMayBeDamaged) {
    laboratory.adopt({.name = "broken", .run_id = {}, .reason = "broken.evod is damaged"});
    ASSERT_TRUE(laboratory.apply(DeleteWorld{"w"}));
    EXPECT_EQ(laboratory.find("").error().reason, base::Reason::WorldDamaged);
    ASSERT_NE(laboratory.find_damaged(""), nullptr);
    EXPECT_EQ(laboratory.find_damaged("")->name, "broken");
}

TEST_F(OneWorld, ResumesWhereItWasPaused) {
    ASSERT_TRUE(laboratory.apply(simulation::Run{"w", 2}).has_value());
    EXPECT_EQ(run_on(5), 5u);
    ASSERT_TRUE(laboratory.apply(Pause{"w"}).has_value());
    EXPECT_EQ(entry().state(), RunState::Paused);
    EXPECT_EQ(run_on(), 0u);
    ASSERT_TRUE(laboratory.apply(Pause{"w"}).has_value()) << "a second pause has no effect";
    ASSERT_TRUE(laboratory.apply(Resume{"w"}).has_value());
    EXPECT_EQ(run_on(), 7u);
}

TEST_F(OneWorld, CannotResumeWithoutAGoal) {
    EXPECT_EQ(code_of(Resume{"w"}), RefusalCode::FailedPrecondition);
    ASSERT_TRUE(laboratory.apply(Pause{"w"}).has_value());
    EXPECT_EQ(entry().state(), RunState::Paused);
    EXPECT_EQ(code_of(Resume{"w"}), RefusalCode::FailedPrecondition);
    EXPECT_EQ(entry().state(), RunState::Paused) << "the refusal has changed nothing";
}

TEST_F(OneWorld, StepsUntilATickThenIsPaused) {
    const auto stepping = laboratory.apply(RunUntilTick{"w", 4});
    ASSERT_TRUE(stepping.has_value());
    EXPECT_EQ(stepping->tick, 0u);
    EXPECT_EQ(entry().state(), RunState::Running);
    EXPECT_EQ(run_on(), 4u);
    EXPECT_EQ(entry().state(), RunState::Paused);
    EXPECT_EQ(count_events<GoalReached>(), 1u);
    ASSERT_TRUE(laboratory.apply(RunUntilTick{"w", 4}).has_value()) << "an earlier tick";
    EXPECT_EQ(run_on(), 0u);
    ASSERT_TRUE(laboratory.apply(RunUntilTick{"w", 9}).has_value());
    EXPECT_EQ(run_on(), 5u);
    EXPECT_EQ(entry().world.moment().generation, 2u);
}

TEST_F(OneWorld, KeepsItsGoalWhileItIsStepped) {
    ASSERT_TRUE(laboratory.apply(simulation::Run{"w", 2}).has_value());
    EXPECT_EQ(run_on(2), 2u);
    ASSERT_TRUE(laboratory.apply(RunUntilTick{"w", 3}).has_value());
    EXPECT_EQ(run_on(), 1u);
    EXPECT_EQ(entry().state(), RunState::Paused);
    ASSERT_TRUE(laboratory.apply(Resume{"w"}).has_value());
    EXPECT_EQ(run_on(), 9u);
}

TEST_F(OneWorld, IsLeasedForAStepOnlyIfItRan) {
    ASSERT_TRUE(laboratory.apply(RunUntilTick{"w", 1}).has_value());
    EXPECT_FALSE(entry().control.leased) << "it waited";
    ASSERT_TRUE(laboratory.apply(simulation::Run{"w", {}}).has_value());
    ASSERT_TRUE(laboratory.apply(Pause{"w"}).has_value());
    ASSERT_TRUE(laboratory.apply(RunUntilTick{"w", 2}).has_value());
    EXPECT_FALSE(entry().control.leased) << "it was paused";
    ASSERT_TRUE(laboratory.apply(ReleaseLease{"w"}).has_value());
    EXPECT_EQ(run_on(), 2u) << "no client gives it back";
    EXPECT_EQ(entry().state(), RunState::Paused);
}

TEST_F(OneWorld, ResumesItsGoalWhenALeaseEnds) {
    ASSERT_TRUE(laboratory.apply(simulation::Run{"w", 2}).has_value());
    for (const std::uint64_t tick : {3, 5}) {
        ASSERT_TRUE(laboratory.apply(RunUntilTick{"w", tick}).has_value());
        run_on();
        EXPECT_TRUE(entry().control.leased && entry().state() == RunState::Paused);
    }
    ASSERT_TRUE(laboratory.apply(RunUntilTick{"w", 1000}).has_value());
    EXPECT_EQ(run_on(2), 2u);
    ASSERT_TRUE(laboratory.apply(ReleaseLease{"w"}).has_value()) << "before the step is over";
    EXPECT_FALSE(entry().control.leased);
    EXPECT_EQ(run_on(), 5u);
    EXPECT_EQ(entry().state(), RunState::Waiting);
}

TEST_F(OneWorld, KeepsItsLeaseWhenAnEarlierOneEnds) {
    ASSERT_TRUE(laboratory.apply(simulation::Run{"w", {}}).has_value());
    ASSERT_TRUE(laboratory.apply(RunUntilTick{"w", 3}).has_value());
    const std::uint64_t first = entry().control.lease;
    ASSERT_TRUE(laboratory.apply(RunUntilTick{"w", 5}).has_value());
    const auto refused = laboratory.apply(ReleaseLease{"w", first});
    ASSERT_FALSE(refused.has_value());
    EXPECT_EQ(refused.error().reason, base::Reason::NoLease);
    EXPECT_EQ(run_on(), 5u) << "it still steps";
    ASSERT_TRUE(laboratory.apply(ReleaseLease{"w", entry().control.lease}).has_value());
    EXPECT_FALSE(entry().control.leased);
}

TEST_F(OneWorld, AnOldLeaseDoesNotEndANewOneAfterAReset) {
    const auto grant = [&] {
        EXPECT_TRUE(laboratory.apply(simulation::Run{"w", {}}).has_value());
        EXPECT_TRUE(laboratory.apply(RunUntilTick{"w", 3}).has_value());
        return entry().control.lease;
    };
    const std::uint64_t first = grant();
    ASSERT_TRUE(laboratory.apply(ResetWorld{"w", {}, {}}).has_value());
    EXPECT_NE(grant(), first);
    EXPECT_FALSE(laboratory.apply(ReleaseLease{"w", first}).has_value());
    EXPECT_TRUE(entry().control.leased);
}

TEST_F(OneWorld, LosesItsLeaseWhenRunControlChanges) {
    for (const Command& command : {Command{simulation::Run{"w", {}}}, Command{Pause{"w"}}, Command{Resume{"w"}},
                                   Command{ResetWorld{.world = "w", .seed = {}, .run_id = {}}}}) {
        ASSERT_TRUE(laboratory.apply(simulation::Run{"w", {}}).has_value());
        ASSERT_TRUE(laboratory.apply(RunUntilTick{"w", 0}).has_value());
        ASSERT_TRUE(entry().control.leased);
        ASSERT_TRUE(laboratory.apply(SetSpeed{"w", 2.0}).has_value());
        EXPECT_TRUE(entry().control.leased) << "whatever its speed";
        ASSERT_TRUE(laboratory.apply(command).has_value());
        EXPECT_FALSE(entry().control.leased);
        const RunState state = entry().state();
        ASSERT_TRUE(laboratory.apply(ReleaseLease{"w"}).has_value());
        EXPECT_EQ(entry().state(), state);
    }
}

TEST_F(OneWorld, DropsAStepWhenPausedOrResumed) {
    ASSERT_TRUE(laboratory.apply(RunUntilTick{"w", 50}).has_value());
    EXPECT_EQ(run_on(3), 3u);
    ASSERT_TRUE(laboratory.apply(Pause{"w"}).has_value());
    EXPECT_EQ(run_on(), 0u);
}

TEST_F(OneWorld, IsTerminatedByACriterionUntilChangedOrReset) {
    ASSERT_TRUE(laboratory.apply(set({{"generation_limit", std::uint32_t{2}}})).has_value());
    ASSERT_TRUE(laboratory.apply(simulation::Run{"w", {}}).has_value());
    EXPECT_EQ(run_on(), 12u);
    EXPECT_EQ(entry().state(), RunState::Terminated);
    EXPECT_EQ(count_events<RunTerminated>(), 1u);
    const auto refused = laboratory.apply(simulation::Run{"w", 1});
    ASSERT_FALSE(refused.has_value());
    EXPECT_EQ(refused.error().code, RefusalCode::FailedPrecondition);
    EXPECT_THAT(refused.error().message, HasSubstr("generation_limit"));
    EXPECT_EQ(code_of(Resume{"w"}), RefusalCode::FailedPrecondition);
    EXPECT_EQ(code_of(RunUntilTick{"w", 13}), RefusalCode::FailedPrecondition);
    EXPECT_TRUE(laboratory.apply(Pause{"w"}).has_value());
    EXPECT_EQ(run_on(), 0u);

    ASSERT_TRUE(laboratory.apply(set({{"generation_limit", std::uint32_t{3}}})).has_value());
    EXPECT_NE(entry().state(), RunState::Terminated);
    ASSERT_TRUE(laboratory.apply(simulation::Run{"w", {}}).has_value());
    EXPECT_EQ(run_on(), 6u);
    ASSERT_TRUE(laboratory.apply(ResetWorld{"w", {}, RunId{3, 4}}).has_value());
    EXPECT_EQ(entry().state(), RunState::Waiting);
    EXPECT_EQ(entry().run_id, (RunId{3, 4}));
    EXPECT_EQ(entry().world.moment().tick, 0u);
}

TEST_F(OneWorld, ResetKeepsSpeedSeedAndRequestedParameters) {
    ASSERT_TRUE(laboratory.apply(SetSpeed{"w", 8.0}).has_value());
    ASSERT_TRUE(laboratory.apply(set({{"population_size", std::uint32_t{12}}, {"island_count", std::uint32_t{2}}}))
                    .has_value());
    ASSERT_TRUE(laboratory.apply(simulation::Run{"w", {}}).has_value());
    run_on(20);
    ASSERT_TRUE(laboratory.apply(ResetWorld{"w", {}, {}}).has_value());
    EXPECT_EQ(entry().control.speed, 8.0);
    EXPECT_FALSE(entry().control.endless);
    EXPECT_EQ(entry().world.seed(), base::Seed{1});
    EXPECT_EQ(entry().world.alive_count(), 24u);
    EXPECT_TRUE(entry().world.history().empty());
    ASSERT_TRUE(laboratory.apply(ResetWorld{"w", base::Seed{77}, {}}).has_value());
    EXPECT_EQ(entry().world.seed(), base::Seed{77});
}

TEST_F(OneWorld, ResetUsesTheFirstPopulationWhileItIsValid) {
    const auto population = std::make_shared<const std::vector<evolution::GeneMatrix>>(
        1, evolution::initial_population(10, parameters, base::Seed{99}, 0));
    ASSERT_TRUE(laboratory.apply(CreateWorld{"given", parameters, base::Seed{1}, {}, population}).has_value());
    World& world = laboratory.entries().back()->world;
    const auto begins_with_it = [&] {
        return (world.islands()[0].born().genes == population->front()).all() && world.moment().tick == 0;
    };
    EXPECT_TRUE(begins_with_it());
    EXPECT_NE(world.hash(), entry().world.hash());
    for (int tick = 0; tick < 20; ++tick) {
        world.advance_tick(executor);
    }
    EXPECT_FALSE(begins_with_it());
    ASSERT_TRUE(laboratory.apply(ResetWorld{"given", base::Seed{2}, {}}).has_value());
    EXPECT_TRUE(begins_with_it());

    const auto set_population = [&](std::uint32_t size) {
        return laboratory.apply(SetParameters{
            .world = "given", .assignments = {{"population_size", size}}, .dry_run = false, .expected_revision = {}});
    };
    ASSERT_TRUE(set_population(11).has_value());
    const auto refused = laboratory.apply(ResetWorld{"given", {}, {}});
    ASSERT_FALSE(refused.has_value());
    EXPECT_EQ(refused.error().code, RefusalCode::FailedPrecondition);
    EXPECT_THAT(to_text(refused.error()),
                HasSubstr("population[0]: got 10 organisms, allowed 11 organisms (population_size)"));
    ASSERT_TRUE(set_population(10).has_value());
    EXPECT_TRUE(laboratory.apply(ResetWorld{"given", {}, {}}).has_value());
}

TEST_F(OneWorld, RefusedParametersChangeNothing) {
    const auto before = entry().world.parameters().requested;
    EXPECT_EQ(code_of(set({{"food_health", 30.0}, {"mutation_chance", 2.0}})), RefusalCode::InvalidArgument);
    SetParameters stale = set({{"food_health", 30.0}});
    stale.expected_revision = 5;
    EXPECT_EQ(code_of(stale), RefusalCode::Aborted);
    EXPECT_TRUE(entry().world.parameters().requested == before);
    EXPECT_EQ(entry().world.parameters().revision, 1u);
}

TEST_F(OneWorld, ADryRunReturnsTheResultAndChangesNothing) {
    SetParameters dry = set({{"food_health", 30.0}, {"population_size", std::uint32_t{20}}});
    dry.dry_run = true;
    dry.expected_revision = 1;
    const auto answer = laboratory.apply(dry);
    ASSERT_TRUE(answer.has_value());
    EXPECT_EQ(answer->parameters->requested.values.population_size, 20u);
    EXPECT_EQ(answer->parameters->active.population_size, 10u);
    EXPECT_EQ(answer->parameters->active.food_health, 30);
    EXPECT_EQ(entry().world.parameters().requested.values.food_health, 25);
    EXPECT_EQ(entry().world.parameters().revision, 1u);
}

TEST_F(OneWorld, RefusesParametersInvalidUntilTheReset) {
    // The fitness changes at the reset, the population at the next generation: until then there are bodies without
    // room.
    EXPECT_EQ(code_of(set({{"fitness", std::string{"gene_sum"}}, {"population_size", std::uint32_t{5000}}})),
              RefusalCode::InvalidArgument);
    EXPECT_TRUE(laboratory.apply(set({{"fitness", std::string{"gene_sum"}}})).has_value());
    EXPECT_EQ(code_of(set({{"population_size", std::uint32_t{5000}}})), RefusalCode::InvalidArgument);
    ASSERT_TRUE(laboratory.apply(ResetWorld{"w", {}, {}}).has_value());
    EXPECT_TRUE(laboratory.apply(set({{"population_size", std::uint32_t{5000}}})).has_value());
    ASSERT_TRUE(laboratory.apply(simulation::Run{"w", 3}).has_value());
    EXPECT_EQ(run_on(), 3u) << "a generation is a tick";
}

TEST_F(OneWorld, ReportsEachGeneration) {
    ASSERT_TRUE(laboratory.apply(simulation::Run{"w", 2}).has_value());
    run_on();
    std::vector<std::uint64_t> ticks;
    for (const Event& event : laboratory.take_events()) {
        EXPECT_EQ(event.world, "w");
        EXPECT_EQ(event.run_id, (RunId{1, 2}));
        if (const auto* finished = std::get_if<GenerationFinished>(&event.kind)) {
            ticks.push_back(event.tick);
            EXPECT_EQ(finished->statistics.size(), 1u);
        }
    }
    EXPECT_THAT(ticks, testing::ElementsAre(6, 12));
    EXPECT_TRUE(laboratory.take_events().empty());
}

TEST(Laboratory, CreatesWorldsUpToItsLimitAndDeletesThem) {
    constexpr std::size_t worlds_max = 5;
    Laboratory laboratory;
    laboratory.set_worlds_max(worlds_max);
    parameters::Parameters small;
    small.population_size = 1;
    const auto create = [&](const std::string& name) {
        return laboratory.apply(CreateWorld{name, small, base::Seed{1}, {}});
    };
    for (std::size_t i = 0; i < worlds_max; ++i) {
        ASSERT_TRUE(create("w" + std::to_string(i)).has_value());
    }
    EXPECT_EQ(create("w0").error().code, RefusalCode::AlreadyExists);
    EXPECT_EQ(create("one_more").error().code, RefusalCode::ResourceExhausted);
    EXPECT_EQ(laboratory.entries().size(), worlds_max);
    ASSERT_TRUE(laboratory.apply(DeleteWorld{"w3"}).has_value());
    EXPECT_EQ(laboratory.apply(DeleteWorld{"w3"}).error().code, RefusalCode::NotFound);
    EXPECT_EQ(laboratory.entries().size(), worlds_max - 1);
    EXPECT_TRUE(create("one_more").has_value());
}

TEST(Laboratory, FindsTheOnlyWorldOrDefaultForAnEmptyName) {
    Laboratory laboratory;
    const auto create = [&](const char* name) {
        ASSERT_TRUE(laboratory.apply(CreateWorld{name, {}, base::Seed{1}, {}}).has_value());
    };
    EXPECT_THAT(laboratory.find("").error().message, HasSubstr("no world"));
    create("a");
    EXPECT_EQ((*laboratory.find(""))->name, "a");
    create("b");
    EXPECT_THAT(laboratory.find("").error().message, HasSubstr("a, b"));
    EXPECT_THAT(to_text(laboratory.find("c").error()), HasSubstr("a, b"));
    create("default");
    EXPECT_EQ((*laboratory.find(""))->name, "default");
    EXPECT_EQ((*laboratory.find("b"))->name, "b");
}

TEST(Laboratory, RefusesEveryCommandToAMissingWorld) {
    Laboratory laboratory;
    ASSERT_TRUE(laboratory.apply(CreateWorld{"a", {}, base::Seed{1}, {}}).has_value());
    ASSERT_TRUE(laboratory.apply(CreateWorld{"b", {}, base::Seed{1}, {}}).has_value());
    for (const Command& command :
         {Command{DeleteWorld{"x"}}, Command{ResetWorld{"x", {}, {}}}, Command{simulation::Run{"x", 1}},
          Command{RunUntilTick{"x", 1}}, Command{ReleaseLease{"x"}}, Command{Pause{"x"}}, Command{Resume{"x"}},
          Command{SetSpeed{"x", 1.0}}, Command{SetParameters{"x", {}, false, {}}}}) {
        const auto refused = laboratory.apply(command);
        ASSERT_FALSE(refused.has_value());
        EXPECT_EQ(refused.error().code, RefusalCode::NotFound);
    }
}

TEST(Laboratory, SurvivesAcceptedParametersAtAnyTick) {
    // Random values of random parameters. An accepted value must not stop a world, whatever the combination of effects.
    base::InlineExecutor executor;
    std::uint64_t accepted = 0, refused = 0;
    for (std::uint64_t seed = 1; seed <= 60; ++seed) {
        base::RandomStream random{base::RandomKey{base::Seed{seed}, base::Purpose::ScenarioTest, 0, 0}, 0};
        Laboratory laboratory;
        parameters::Parameters p;
        p.population_size = 12;
        p.generation_s = 0.2;
        p.island_count = 1 + random.below(2);
        ASSERT_TRUE(laboratory.apply(CreateWorld{"w", p, base::Seed{seed}, {}}).has_value());
        ASSERT_TRUE(laboratory.apply(simulation::Run{"w", {}}).has_value());
        Entry& entry = *laboratory.entries().front();
        for (int tick = 0; tick < 200; ++tick) {
            std::vector<parameters::Assignment> assignments;
            for (std::uint32_t i = 0; i < random.below(4); ++i) {
                const auto& description = parameters::parameter_registry()[random.below(
                    static_cast<std::uint32_t>(parameters::parameter_registry().size()))];
                if (description.name == "island_count" || description.name == "generation_s") {
                    continue; // such values only take long
                }
                parameters::ParameterValue value;
                if (const auto* real = std::get_if<parameters::RealParameter>(&description.kind)) {
                    const double now = real->get(entry.world.parameters().requested.values);
                    const double any = random.uniform(real->range.min, real->range.max);
                    value = random.chance(0.1)
                                ? any
                                : std::clamp(now * random.uniform(0.5, 2), real->range.min, real->range.max);
                } else if (const auto* count = std::get_if<parameters::CountParameter>(&description.kind)) {
                    value = std::clamp(random.below(40), count->range.min, count->range.max);
                } else if (std::holds_alternative<parameters::FlagParameter>(description.kind)) {
                    value.emplace<bool>(random.chance(0.5));
                } else {
                    const auto names = std::get<parameters::ChoiceParameter>(description.kind).names;
                    value = std::string{names[random.below(static_cast<std::uint32_t>(names.size()))]};
                }
                assignments.push_back({std::string{description.name}, std::move(value)});
            }
            ++(laboratory.apply(SetParameters{"w", assignments, false, {}}).has_value() ? accepted : refused);
            if (random.chance(0.01)) {
                ASSERT_TRUE(laboratory.apply(ResetWorld{"w", {}, {}}).has_value());
                ASSERT_TRUE(laboratory.apply(simulation::Run{"w", {}}).has_value());
            }
            if (entry.wants_tick()) {
                laboratory.advance(entry, executor);
            }
            for (const Island& island : entry.world.islands()) {
                for (std::size_t i = 0; i < island.bodies().size(); ++i) {
                    if (island.bodies().is_void(i)) {
                        continue;
                    }
                    ASSERT_TRUE(std::isfinite(island.bodies().velocity_x[i])) << "seed " << seed << ", tick " << tick;
                    ASSERT_GE(island.bodies().x[i], 0);
                    ASSERT_LE(island.bodies().x[i], island.area().width);
                }
            }
            laboratory.take_events();
        }
    }
    EXPECT_GT(accepted, 3000u);
    EXPECT_GT(refused, 100u);
}

TEST(WorldNames, HaveFewKindsOfCharactersAndALimit) {
    for (const char* good : {"a", "A-z_09", "default"}) {
        EXPECT_TRUE(is_world_name(good)) << good;
    }
    for (const std::string& bad :
         {std::string{}, std::string(65, 'a'), std::string{"a b"}, std::string{"ä"}, std::string{"a\0b", 3}}) {
        EXPECT_FALSE(is_world_name(bad)) << bad;
    }
}

TEST(LaboratoryDamage, ALiveWorldBecomesADamagedWorld) {
    Laboratory laboratory;
    ASSERT_TRUE(laboratory.apply(CreateWorld{.name = "w", .parameters = {}, .seed = base::Seed{1}, .run_id = {1, 1}}));
    laboratory.replace_with_damaged({.name = "w", .run_id = RunId{1, 1}, .reason = "the file is bad"});
    EXPECT_TRUE(laboratory.entries().empty());
    ASSERT_TRUE(laboratory.find_damaged("w"));
    EXPECT_EQ(laboratory.find("w").error().message, "the world does not run: the file is bad");
    EXPECT_TRUE(laboratory.apply(DeleteWorld{"w"}));
    EXPECT_TRUE(laboratory.damaged().empty());
}

} // namespace
} // namespace evod::simulation
