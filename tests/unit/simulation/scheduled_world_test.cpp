// Worlds with schedules and planned changes.

#include "server/base/inline_executor.h"
#include "server/jobs/thread_pool.h"
#include "server/parameters/experiment.h"
#include "server/simulation/laboratory.h"
#include "server/simulation/world.h"
#include "tests/unit/simulation/events.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <utility>
#include <vector>

namespace evod::simulation {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class ScheduleTest : public testing::Test {
  protected:
    /// A world of twelve organisms, with generations of twelve ticks, unless `more` says otherwise.
    static parameters::Experiment read(const std::string& more) {
        std::string text = "{" + more;
        for (const auto& [name, value] :
             {std::pair{"population_size", "12"}, {"generation_s", "0.2"}, {"island_count", "2"}}) {
            if (more.find('"' + std::string{name} + '"') == std::string::npos) {
                text += ", \"" + std::string{name} + "\": " + value;
            }
        }
        const auto experiment = parameters::parse_experiment(text + "}");
        EXPECT_TRUE(experiment) << to_text(experiment.error());
        return experiment ? *experiment : parameters::Experiment{};
    }
    static World make(const parameters::Experiment& experiment, std::uint64_t seed = 5) {
        return {experiment.parameters, base::Seed{seed}, {}, experiment.schedule};
    }
    void advance_to(World& world, std::uint64_t generation, std::uint64_t generation_tick) {
        while (world.moment().generation < generation || world.moment().generation_tick < generation_tick) {
            world.advance_tick(executor);
        }
    }
    void end_generation(World& world, std::uint64_t generation) {
        while (world.moment().generation < generation || !world.generation_over()) {
            world.advance_tick(executor);
        }
    }
    void set(World& world, const std::string& name, parameters::ParameterValue value) {
        const auto requested =
            parameters::request_of(world.parameters(), std::vector{parameters::Assignment{name, std::move(value)}});
        ASSERT_TRUE(requested) << to_text(requested.error());
        world.request_parameters(*requested);
    }

    base::InlineExecutor executor;
};

TEST_F(ScheduleTest, AValueHoldsFromTheFirstTickOfItsGeneration) {
    World world =
        make(read(R"("mutation_chance": {"1": 0.2, "3": 0.05}, "food_count": {"3": 7}, "elite_count": {"4": 2})"));
    EXPECT_EQ(world.parameters().active.mutation_chance, 0.2);
    EXPECT_EQ(world.parameters().active.elite_count, 0u) << "the default before the first scheduled value";
    end_generation(world, 2);
    EXPECT_EQ(world.parameters().active.mutation_chance, 0.2);
    world.take_events();

    world.breed_next_generation(executor); // bred with the previous values; the food is already the new amount
    EXPECT_EQ(world.opening().parameters.active.mutation_chance, 0.2);
    EXPECT_EQ(world.opening().parameters.active.food_count, 7u);
    EXPECT_EQ(world.islands()[0].food().size(), 7u);
    world.advance_tick(executor);
    EXPECT_EQ(world.parameters().active.mutation_chance, 0.05);
    const auto changed = events<ParametersChanged>(world);
    ASSERT_EQ(changed.size(), 1u);
    EXPECT_EQ(changed[0].by, base::Actor{});
    EXPECT_THAT(changed[0].names, ElementsAre("food_count", "mutation_chance"));
    EXPECT_EQ(changed[0].revision, 2u);
    EXPECT_EQ(world.parameters().revision, 2u);
    advance_to(world, 4, 1);
    EXPECT_EQ(world.parameters().active.elite_count, 2u);
}

TEST_F(ScheduleTest, EqualsCommandsAtTheSameTicks) {
    World scheduled = make(read(R"("mutation_chance": {"1": 0.9, "3": 0.05}, "food_health": {"1": 25, "2": 90},
                                   "population_size": {"1": 12, "4": 30}, "food_count": {"1": 40, "3": 8})"));
    World commanded = make(read(R"("mutation_chance": 0.9, "food_count": 40)"));
    for (int tick = 0; tick < 12 * 7; ++tick) {
        const Moment& at = commanded.moment();
        // Values for the next generation are set at the end of the one before; values of breeding after its first tick.
        if (at.generation == 1 && commanded.generation_over()) {
            set(commanded, "food_health", 90.0);
        }
        if (at.generation == 2 && commanded.generation_over()) {
            set(commanded, "food_count", 8u);
        }
        if (at.generation == 3 && at.generation_tick == 1) {
            set(commanded, "mutation_chance", 0.05);
        }
        if (at.generation == 3 && commanded.generation_over()) {
            set(commanded, "population_size", 30u);
        }
        scheduled.advance_tick(executor);
        commanded.advance_tick(executor);
        ASSERT_EQ(scheduled.hash(), commanded.hash()) << "states differ at tick " << scheduled.moment().tick;
    }
    EXPECT_EQ(scheduled.islands()[1].born().genes.cols(), 30);
    EXPECT_TRUE(scheduled.parameters().active == commanded.parameters().active);

    World plain = make(read(R"("mutation_chance": 0.9)"));
    end_generation(plain, 7);
    EXPECT_NE(plain.hash(), scheduled.hash());
}

TEST_F(ScheduleTest, IsTheSameOnAnyThreadCount) {
    const parameters::Experiment experiment =
        read(R"("mutation_chance": {"2": 0.5}, "population_size": {"1": 12, "2": 200, "4": 20},
        "body_size_max": {"3": 150}, "selection": {"4": "tournament"})");
    World alone = make(experiment), many = make(experiment);
    jobs::ThreadPool threads{5};
    for (int tick = 0; tick < 12 * 5; ++tick) {
        alone.advance_tick(executor);
        many.advance_tick(threads);
        ASSERT_EQ(alone.hash(), many.hash()) << "states differ at tick " << alone.moment().tick;
    }
    EXPECT_TRUE(alone.parameters().active == many.parameters().active);
}

TEST_F(ScheduleTest, ACommandHoldsUntilTheNextScheduledValue) {
    World world = make(read(R"("mutation_chance": {"2": 0.3, "4": 0.1}, "mutation_step": {"3": 9})"));
    advance_to(world, 2, 5);
    set(world, "mutation_chance", 0.7);
    advance_to(world, 3, 5);
    EXPECT_EQ(world.parameters().active.mutation_chance, 0.7);
    EXPECT_EQ(world.parameters().active.mutation_step, 9);
    advance_to(world, 4, 1);
    EXPECT_EQ(world.parameters().active.mutation_chance, 0.1);
}

TEST_F(ScheduleTest, ReportsValuesThatNoLongerFit) {
    World world = make(read(R"("impulse_min": {"3": 200}, "mutation_step": {"3": 9, "4": 8})"));
    advance_to(world, 2, 1);
    set(world, "impulse_max", 150.0);
    world.take_events();
    advance_to(world, 3, 1);
    const parameters::Parameters& held = world.parameters().active;
    EXPECT_EQ(held.impulse_min, 20);
    EXPECT_EQ(held.mutation_step, 15) << "applied completely or not at all";
    const auto dropped = events<ChangeDropped>(world);
    ASSERT_EQ(dropped.size(), 1u);
    EXPECT_THAT(dropped[0].names, ElementsAre("mutation_step", "impulse_min"));
    ASSERT_EQ(dropped[0].violations.size(), 1u);
    EXPECT_EQ(dropped[0].violations[0].field, "impulse_max");
    advance_to(world, 4, 1);
    EXPECT_EQ(held.mutation_step, 8);
}

TEST_F(ScheduleTest, AForkAtAnOpeningContinuesAlike) {
    World world = make(read(R"("mutation_chance": {"3": 0.6, "5": 0.1}, "population_size": {"1": 12, "3": 20})"));
    end_generation(world, 2);
    world.breed_next_generation(executor);
    World fork = world.at_its_opening(executor), asked = world.at_its_opening(executor);
    set(asked, "mutation_chance", 0.33); // the value scheduled for this generation is already requested
    asked.advance_tick(executor);
    EXPECT_EQ(asked.parameters().active.mutation_chance, 0.33);
    for (int tick = 0; tick < 12 * 4; ++tick) {
        world.advance_tick(executor);
        fork.advance_tick(executor);
        ASSERT_EQ(fork.hash(), world.hash());
    }
    EXPECT_EQ(fork.parameters().active.mutation_chance, 0.1);
}

TEST_F(ScheduleTest, AResetRestartsTheSchedule) {
    World world = make(read(R"("mutation_chance": {"1": 0.3, "2": 0.1}, "generation_limit": 9)"));
    const World first = world.copy(executor);
    advance_to(world, 2, 3);
    set(world, "food_health", 30.0);
    world = world.restarted(base::Seed{5});
    EXPECT_EQ(world.parameters().active.mutation_chance, 0.3);
    EXPECT_EQ(world.parameters().requested.values.mutation_chance, 0.3);
    EXPECT_EQ(world.parameters().active.food_health, 30) << "unscheduled parameters keep their requested values";
    EXPECT_EQ(world.hash(), first.hash());
    advance_to(world, 2, 1);
    EXPECT_EQ(world.parameters().active.mutation_chance, 0.1);
}

TEST_F(ScheduleTest, AResetToInvalidValuesIsRefused) {
    const parameters::Experiment experiment = read(R"("impulse_min": {"1": 100, "2": 20})");
    Laboratory laboratory;
    ASSERT_TRUE(laboratory.apply(CreateWorld{.name = "w",
                                             .parameters = experiment.parameters,
                                             .seed = base::Seed{1},
                                             .run_id = {},
                                             .schedule = experiment.schedule}));
    Entry& entry = **laboratory.find("w");
    advance_to(entry.world, 2, 1);
    ASSERT_TRUE(
        laboratory.apply(SetParameters{.world = "w", .assignments = {{"impulse_max", 50.0}}, .expected_revision = {}}));
    const auto refused = laboratory.apply(ResetWorld{.world = "w", .seed = {}, .run_id = {}}).error();
    EXPECT_EQ(refused.code, base::RefusalCode::FailedPrecondition);
    EXPECT_THAT(refused.message, HasSubstr("generation 1"));
    EXPECT_EQ(entry.world.moment().generation, 2u);
}

TEST_F(ScheduleTest, AppliesToAChromosomeFitnessToo) {
    World world = make(read(R"("fitness": "gene_sum", "mutation_step": {"3": 0}, "reset_chance": {"1": 0.5, "3": 0},
        "crossover": {"3": "none"})"));
    for (int generation = 1; generation <= 3; ++generation) {
        world.advance_tick(executor);
    }
    EXPECT_EQ(world.parameters().active.mutation_step, 0);
    EXPECT_EQ(world.opening().parameters.active.reset_chance, 0.5) << "bred with the previous values";
    world.advance_tick(executor);
    EXPECT_EQ(world.opening().parameters.active.reset_chance, 0);
}

/// A world in a laboratory, for planned changes.
class PlannedTest : public ScheduleTest {
  protected:
    PlannedTest() { create(laboratory, R"("mutation_chance": 0.4)"); }
    static void create(Laboratory& in, const std::string& more) {
        const parameters::Experiment experiment = read(more);
        ASSERT_TRUE(in.apply(CreateWorld{.name = "w",
                                         .parameters = experiment.parameters,
                                         .seed = base::Seed{5},
                                         .run_id = {},
                                         .schedule = experiment.schedule}));
    }
    static World& world_of(Laboratory& in) { return (*in.find("w"))->world; }
    World& world() { return world_of(laboratory); }
    static SetParameters set(std::string name, parameters::ParameterValue value,
                             std::optional<parameters::PlannedMoment> at = {}) {
        return {.world = "w",
                .assignments = {{std::move(name), std::move(value)}},
                .dry_run = false,
                .expected_revision = {},
                .at = at,
                .by = base::client_actor("anna", "evoctl", "127.0.0.1:5000")};
    }
    static parameters::PlannedMoment generation(std::uint64_t generation) {
        return {.generation = generation, .tick = {}};
    }
    static parameters::PlannedMoment tick(std::uint64_t tick) { return {.generation = {}, .tick = tick}; }
    std::uint64_t plan(const SetParameters& command) {
        const auto applied = laboratory.apply(command);
        EXPECT_TRUE(applied) << to_text(applied.error());
        return applied && applied->planned ? applied->planned->id : 0;
    }
    base::Refusal refused(const Command& command) {
        const auto applied = laboratory.apply(command);
        EXPECT_FALSE(applied);
        return applied ? base::Refusal{} : applied.error();
    }

    Laboratory laboratory;
};

TEST_F(PlannedTest, AtAGenerationItEqualsASchedule) {
    Laboratory scheduled;
    create(scheduled, R"("mutation_chance": {"1": 0.4, "3": 0.9}, "population_size": {"1": 12, "4": 30})");
    world().advance_tick(executor);
    world_of(scheduled).advance_tick(executor);
    EXPECT_EQ(plan(set("mutation_chance", 0.9, generation(3))), 1u);
    EXPECT_EQ(plan(set("population_size", 30u, generation(4))), 2u);
    EXPECT_EQ(world().planned().size(), 2u);
    EXPECT_EQ(world().parameters().revision, 1u) << "nothing has changed";
    for (int i = 0; i < 12 * 6; ++i) {
        world().advance_tick(executor);
        world_of(scheduled).advance_tick(executor);
        ASSERT_EQ(world().hash(), world_of(scheduled).hash()) << "states differ at tick " << world().moment().tick;
        ASSERT_TRUE(world().parameters().active == world_of(scheduled).parameters().active);
        ASSERT_EQ(world().parameters().revision, world_of(scheduled).parameters().revision);
    }
    EXPECT_TRUE(world().planned().empty());
    const auto changed = events<ParametersChanged>(world());
    ASSERT_EQ(changed.size(), 2u);
    EXPECT_EQ(changed[0].planned, 1u);
    EXPECT_EQ(changed[0].by.user, "anna");
    EXPECT_THAT(changed[1].names, ElementsAre("population_size"));
}

TEST_F(PlannedTest, AtATickItEqualsACommandThere) {
    for (const std::uint64_t at : {1u, 11u, 12u, 13u, 30u}) { // a generation ends after 12
        for (const auto& [name, value] : {std::pair<std::string, parameters::ParameterValue>{"food_health", 60.0},
                                          {"mutation_chance", 0.0},
                                          {"population_size", 17u}}) {
            Laboratory planned, commanded;
            create(planned, R"("mutation_chance": 0.4)");
            create(commanded, R"("mutation_chance": 0.4)");
            ASSERT_TRUE(planned.apply(set(name, value, tick(at))));
            for (int i = 0; i < 12 * 4; ++i) {
                world_of(planned).advance_tick(executor);
                world_of(commanded).advance_tick(executor);
                if (world_of(commanded).moment().tick == at) {
                    ASSERT_TRUE(commanded.apply(set(name, value)));
                }
                ASSERT_EQ(world_of(planned).hash(), world_of(commanded).hash()) << name << " at " << at;
                ASSERT_TRUE(world_of(planned).parameters().active == world_of(commanded).parameters().active);
                ASSERT_TRUE(world_of(planned).parameters().requested == world_of(commanded).parameters().requested);
                ASSERT_EQ(world_of(planned).parameters().revision, world_of(commanded).parameters().revision);
            }
        }
    }
}

TEST_F(PlannedTest, ChangesDueTogetherFollowTheScheduleInOrder) {
    Laboratory both;
    create(both, R"("mutation_chance": {"2": 0.1}, "mutation_step": {"2": 1})");
    ASSERT_TRUE(both.apply(set("mutation_chance", 0.2, generation(2))));
    ASSERT_TRUE(both.apply(set("mutation_chance", 0.3, generation(2))));
    advance_to(world_of(both), 2, 1);
    EXPECT_EQ(world_of(both).parameters().active.mutation_chance, 0.3);
    EXPECT_EQ(world_of(both).parameters().active.mutation_step, 1);
    std::vector<std::uint64_t> order;
    for (const ParametersChanged& changed : events<ParametersChanged>(world_of(both))) {
        order.push_back(changed.planned);
    }
    EXPECT_THAT(order, ElementsAre(0, 1, 2));
}

TEST_F(PlannedTest, AnInvalidChangeIsDroppedWhenDue) {
    plan(set("impulse_min", 200.0, generation(2)));
    plan(set("impulse_max", 30.0, tick(5)));
    ASSERT_TRUE(laboratory.apply(set("impulse_max", 150.0)));
    ASSERT_TRUE(laboratory.apply(set("impulse_min", 100.0)));
    advance_to(world(), 2, 1);
    EXPECT_EQ(world().parameters().active.impulse_min, 100);
    EXPECT_EQ(world().parameters().active.impulse_max, 150);
    EXPECT_TRUE(world().planned().empty());
    const auto dropped = events<ChangeDropped>(world());
    ASSERT_EQ(dropped.size(), 2u);
    EXPECT_EQ(dropped[0].planned, 2u);
    EXPECT_EQ(dropped[1].planned, 1u);
    EXPECT_EQ(dropped[1].by.user, "anna");
    EXPECT_FALSE(dropped[0].violations.empty());
}

TEST_F(PlannedTest, CanBeCancelledUntilItIsDue) {
    const std::uint64_t first = plan(set("food_health", 1.0, tick(5))), second = plan(set("food_health", 2.0, tick(6)));
    const auto cancelled = laboratory.apply(CancelChange{"w", second});
    ASSERT_TRUE(cancelled) << to_text(cancelled.error());
    EXPECT_EQ(cancelled->planned->id, second);
    EXPECT_EQ(cancelled->planned->assignments[0].value, parameters::ParameterValue{2.0});
    const auto again = refused(CancelChange{"w", second});
    EXPECT_EQ(again.code, base::RefusalCode::NotFound);
    EXPECT_EQ(again.violations[0].allowed, std::to_string(first));
    advance_to(world(), 1, 7);
    EXPECT_EQ(world().parameters().active.food_health, 1);
    EXPECT_EQ(refused(CancelChange{"w", first}).code, base::RefusalCode::NotFound);
    EXPECT_EQ(plan(set("food_health", 3.0, tick(9))), 3u) << "an id is never given twice";
}

TEST_F(PlannedTest, RefusesWhatCannotBePlanned) {
    advance_to(world(), 2, 3); // tick 15
    const auto field = [&](const SetParameters& command) {
        const auto refusal = refused(command);
        EXPECT_TRUE(world().planned().empty());
        return refusal.violations.empty() ? "" : to_text(refusal.violations[0]);
    };
    EXPECT_EQ(field(set("food_health", 1.0, generation(2))), "set_parameters.at_generation: got 2, allowed at least 3");
    EXPECT_EQ(field(set("food_health", 1.0, tick(15))), "set_parameters.at_tick: got 15, allowed at least 16");
    EXPECT_THAT(field(set("food_health", -1.0, tick(16))), HasSubstr("set_parameters.food_health"));
    EXPECT_THAT(field(set("impulse_min", 300.0, tick(16))), HasSubstr("set_parameters.impulse_max"));
    EXPECT_THAT(field(set("island_count", 3u, generation(3))), HasSubstr("set_parameters.island_count"));
    EXPECT_THAT(field(set("no_such", 3u, generation(3))), HasSubstr("set_parameters.no_such"));
    SetParameters other = set("food_health", 1.0, tick(16));
    other.expected_revision = 7;
    EXPECT_EQ(refused(other).code, base::RefusalCode::Aborted);
    other.expected_revision = 1;
    other.dry_run = true;
    EXPECT_EQ(plan(other), 0u) << "would be accepted";
    EXPECT_TRUE(world().planned().empty());
    for (std::size_t i = 0; i < parameters::planned_changes_max; ++i) {
        plan(set("food_health", 1.0, tick(16 + i)));
    }
    EXPECT_EQ(refused(set("food_health", 1.0, tick(16))).code, base::RefusalCode::ResourceExhausted);
}

TEST_F(PlannedTest, IsDroppedByResetAndFork) {
    plan(set("food_health", 1.0, generation(3)));
    ASSERT_TRUE(laboratory.apply(ForkWorld{.world = "w", .name = "fork", .at_generation = {}, .run_id = {}}));
    EXPECT_TRUE((*laboratory.find("fork"))->world.planned().empty());
    EXPECT_EQ(world().planned().size(), 1u);
    EXPECT_TRUE(world().at_its_opening(executor).planned().empty());
    ASSERT_TRUE(laboratory.apply(ResetWorld{.world = "w", .seed = {}, .run_id = {}}));
    EXPECT_TRUE(world().planned().empty());
    EXPECT_EQ(plan(set("food_health", 1.0, generation(3))), 1u) << "ids start again in another run";
}

} // namespace
} // namespace evod::simulation
