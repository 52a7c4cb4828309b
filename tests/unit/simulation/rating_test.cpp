#include "server/simulation/rating.h"

#include "server/base/inline_executor.h"
#include "server/simulation/fitness.h"
#include "server/simulation/laboratory.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace evod::simulation {
namespace {

using testing::HasSubstr;

/// Two islands with five organisms each.
parameters::Parameters rated_world(bool bodies) {
    parameters::Parameters parameters;
    parameters.fitness = parameters::FitnessFunction::External;
    parameters.external_bodies = bodies;
    parameters.population_size = 5;
    parameters.island_count = 2;
    parameters.generation_s = 0.5;
    parameters.migration = evolution::Topology::Ring;
    return parameters;
}

std::vector<double> gene_sums(const Island& island) {
    std::vector<double> sums;
    for (const auto& genes : island.born().genes.colwise()) {
        sums.push_back(gene_sum(genes));
    }
    return sums;
}

class RatingTest : public testing::Test {
  protected:
    void create(const parameters::Parameters& parameters, const std::string& name = "w") {
        ASSERT_TRUE(laboratory.apply(CreateWorld{name, parameters, base::Seed{5}, {}}));
        ASSERT_TRUE(laboratory.apply(simulation::Run{name, {}}));
    }
    Entry& entry(const std::string& name = "w") { return **laboratory.find(name); }
    World& world(const std::string& name = "w") { return entry(name).world; }
    void advance(const std::string& name = "w") { laboratory.advance(entry(name), executor); }
    /// Advances to the end of the generation.
    void advance_to_rating() {
        do {
            advance();
        } while (!world().awaits_fitness());
    }
    base::Result<Applied> rate(std::uint32_t island, std::vector<double> fitness, std::uint32_t first = 0,
                               std::vector<float> genes = {}) {
        return laboratory.apply(
            SetFitness{"w", world().moment().generation, island, first, std::move(fitness), std::move(genes)});
    }
    template <class Kind>
    std::size_t count(const std::vector<Event>& events) {
        return static_cast<std::size_t>(
            std::ranges::count_if(events, [](const Event& event) { return std::holds_alternative<Kind>(event.kind); }));
    }

    Laboratory laboratory;
    base::InlineExecutor executor;
};

TEST_F(RatingTest, DiversityCountsTheGenesThatAreRated) {
    parameters::Parameters parameters = rated_world(false);
    parameters.free_genes = 2;
    parameters.island_count = 1;
    parameters.population_size = 500;
    create(parameters);
    advance();
    ASSERT_TRUE(rate(0, std::vector<double>(500, 1.0)));
    advance();
    const GenerationStatistics& statistics = world().history().front()[0];
    ASSERT_EQ(statistics.genes.size(), 2u);
    EXPECT_NEAR(statistics.genes[1].mean, 0.5, 0.06);
    EXPECT_DOUBLE_EQ(statistics.diversity, (statistics.genes[0].deviation + statistics.genes[1].deviation) / 2);
    EXPECT_NEAR(statistics.diversity, 0.289, 0.02); // 1/√12, of uniform numbers
    const std::optional<evolution::SelectionAccount>& account = world().island(0).born().account;
    ASSERT_EQ(account->size(), 2u);
    EXPECT_NEAR((*account)[1].change, world().island(0).born().genes.row(1).mean() - statistics.genes[1].mean, 1e-6);
}

TEST_F(RatingTest, AWorldWaitsUntilAllIslandsAreRated) {
    create(rated_world(false));
    advance();
    EXPECT_TRUE(world().awaits_fitness());
    EXPECT_FALSE(entry().wants_tick());
    EXPECT_EQ(entry().state(), RunState::Running); // it continues towards its goal when it is rated
    EXPECT_EQ(count<FitnessAwaited>(laboratory.take_events()), 1u);
    ASSERT_TRUE(rate(1, {1, 2, 3, 4, 5}));
    EXPECT_TRUE(world().awaits_fitness());
    EXPECT_TRUE(world().history().empty());
    EXPECT_TRUE(world().is_rated(1));
    EXPECT_FALSE(world().is_rated(0));
    ASSERT_TRUE(rate(0, {-7, 9, 0, 0, 0}));
    EXPECT_FALSE(world().awaits_fitness());
    EXPECT_TRUE(world().generation_over());
    EXPECT_TRUE(entry().wants_tick());
    EXPECT_EQ(count<GenerationFinished>(laboratory.take_events()), 1u);
    EXPECT_EQ(world().history().back()[0].fitness_best, 9);
    EXPECT_EQ(world().history().back()[0].best_organism, 1u);
    EXPECT_EQ(world().history().back()[1].fitness_mean, 3);
    advance();
    EXPECT_EQ(world().moment().generation, 2u);
}

TEST_F(RatingTest, NumbersMayComeInPartsAndBeginAgain) {
    create(rated_world(false));
    advance();
    ASSERT_TRUE(rate(0, {1, 2}));
    ASSERT_TRUE(rate(0, {3}, 2));
    const auto gap = rate(0, {4}, 4);
    ASSERT_FALSE(gap);
    EXPECT_EQ(gap.error().violations.at(0).field, "set_fitness.first_organism");
    EXPECT_EQ(gap.error().violations.at(0).allowed, "0 or 3");
    ASSERT_TRUE(rate(0, {10, 20, 30, 40}));
    ASSERT_TRUE(rate(0, {50}, 4));
    EXPECT_THAT(world().ratings()[0].fitness, testing::ElementsAre(10, 20, 30, 40, 50));
}

TEST_F(RatingTest, WrongCommandsAreRefused) {
    create(rated_world(true));
    const auto reason = [](const base::Result<Applied>& result) {
        return result ? base::Reason::Unspecified : result.error().reason;
    };
    const auto field = [](const base::Result<Applied>& result) { return result.error().violations.at(0).field; };
    advance();
    EXPECT_EQ(reason(rate(0, {1})), base::Reason::FitnessNotAwaited); // the generation has not ended
    advance_to_rating();
    const base::StateHash before = world().hash();
    const auto other_generation = laboratory.apply(SetFitness{"w", 2, 0, 0, {1}});
    EXPECT_EQ(reason(other_generation), base::Reason::GenerationChanged);
    EXPECT_EQ(field(other_generation), "set_fitness.generation");
    EXPECT_EQ(reason(rate(2, {1})), base::Reason::IslandNotFound);
    const auto too_many = rate(0, {1, 2, 3, 4, 5, 6});
    EXPECT_EQ(field(too_many), "set_fitness.fitness");
    EXPECT_THAT(too_many.error().violations.at(0).allowed, HasSubstr("5 numbers"));
    EXPECT_EQ(world().hash(), before);
    ASSERT_TRUE(rate(0, {1, 2, 3, 4, 5}));
    EXPECT_EQ(reason(rate(0, {1, 2, 3, 4, 5})), base::Reason::FitnessNotAwaited); // the island is rated
    ASSERT_TRUE(rate(1, {1, 2, 3, 4, 5}));
    EXPECT_EQ(reason(rate(1, {1, 2, 3, 4, 5})), base::Reason::FitnessNotAwaited); // the generation is over
    const auto placed = laboratory.apply(PlaceEntities{"w", 0, {{ItemKind::Food, 50, 50}}, {}});
    EXPECT_EQ(reason(placed), base::Reason::GenerationOver);

    create(parameters::Parameters{}, "other");
    EXPECT_EQ(reason(laboratory.apply(SetFitness{"other", 1, 0, 0, {1}})), base::Reason::FitnessNotAwaited);
}

TEST_F(RatingTest, EqualsABuiltInFunctionBitForBit) {
    create(rated_world(false));
    parameters::Parameters built_in = rated_world(false);
    built_in.fitness = parameters::FitnessFunction::GeneSum;
    create(built_in, "sum");
    for (int generation = 1; generation <= 12; ++generation) {
        advance();
        advance("sum");
        ASSERT_EQ(world().hash(), world("sum").hash()) << generation;
        ASSERT_TRUE(rate(0, gene_sums(world().islands()[0])));
        ASSERT_TRUE(rate(1, gene_sums(world().islands()[1])));
        EXPECT_EQ(world().history().back()[0].fitness_mean, world("sum").history().back()[0].fitness_mean);
    }
}

TEST_F(RatingTest, EqualsFitnessOfLifeBitForBit) {
    create(rated_world(true));
    parameters::Parameters life = rated_world(true);
    life.fitness = parameters::FitnessFunction::Life;
    create(life, "life");
    for (int tick = 0; tick < 100; ++tick) {
        advance();
        advance("life");
        ASSERT_EQ(world().hash(), world("life").hash()) << tick;
        for (const Island& island : world().islands()) {
            std::vector<double> fitness;
            for (std::uint32_t id = 0; world().awaits_fitness() && id < 5; ++id) {
                const auto its = island.life(id, static_cast<std::uint32_t>(world().moment().generation_tick));
                fitness.push_back(its.lived_ticks * rated_world(true).tick_s + static_cast<double>(its.health));
            }
            if (!fitness.empty()) {
                ASSERT_TRUE(rate(island.index(), fitness));
            }
        }
    }
    EXPECT_EQ(world().moment().generation, 4u);
}

TEST_F(RatingTest, TheStateHashCoversTheNumbers) {
    create(rated_world(false));
    advance();
    const base::StateHash unrated = world().hash();
    ASSERT_TRUE(rate(0, {1, 2, 3, 4, 5}));
    const base::StateHash rated = world().hash();
    EXPECT_NE(rated, unrated);
    World other = world().at_its_opening(executor);
    other.advance_tick(executor);
    EXPECT_EQ(other.hash(), unrated);
    other.set_fitness({"w", 1, 0, 0, {1, 2, 3, 5, 4}});
    EXPECT_NE(other.hash(), rated);
}

TEST_F(RatingTest, AGoalIsReachedWhenTheLastIslandIsRated) {
    create(rated_world(false));
    ASSERT_TRUE(laboratory.apply(simulation::Run{"w", 1}));
    advance();
    EXPECT_EQ(count<GoalReached>(laboratory.take_events()), 0u);
    ASSERT_TRUE(rate(0, {1, 2, 3, 4, 5}));
    ASSERT_TRUE(rate(1, {1, 2, 3, 4, 5}));
    EXPECT_EQ(count<GoalReached>(laboratory.take_events()), 1u);
    EXPECT_EQ(entry().state(), RunState::Waiting);
}

TEST_F(RatingTest, ATerminationCriterionUsesTheNumbers) {
    parameters::Parameters parameters = rated_world(false);
    parameters.stop_at_target_fitness = true;
    parameters.target_fitness = 42;
    create(parameters);
    advance();
    ASSERT_TRUE(rate(0, {1, 2, 3, 4, 5}));
    ASSERT_TRUE(rate(1, {1, 2, 42, 4, 5}));
    EXPECT_EQ(entry().state(), RunState::Terminated);
    EXPECT_EQ(count<RunTerminated>(laboratory.take_events()), 1u);
}

TEST_F(RatingTest, SeveralObjectivesAreRankedByFrontAndCrowding) {
    parameters::Parameters parameters = rated_world(false);
    parameters.objectives = 2;
    parameters.island_count = 1;
    parameters.population_model = evolution::PopulationModel::Nsga2;
    parameters.survivors = 0.6;
    parameters.selection = evolution::SelectionMethod::Tournament;
    create(parameters);
    advance();
    EXPECT_THAT(base::to_text(rate(0, {1, 2, 3}).error()), HasSubstr("2 numbers for each organism (objectives)"));
    EXPECT_THAT(base::to_text(rate(0, std::vector<double>(12)).error()), HasSubstr("10 numbers, 2 for each organism"));
    // Organisms 1 and 3 are dominated; 0, 2 and 4 are the first front.
    ASSERT_TRUE(rate(0, {0, 9, 0, 8, 9, 0}));
    EXPECT_THAT(base::to_text(rate(0, {0, 0}, 2).error()), HasSubstr("0 or 3"));
    EXPECT_FALSE(world().is_rated(0));
    ASSERT_TRUE(rate(0, {8, 0, 5, 5}, 3));
    EXPECT_EQ(world().history().back()[0].fitness_best, 9); // the first objective
    EXPECT_EQ(world().history().back()[0].best_organism, 2u);
    EXPECT_THAT(world().outcomes()[0].objectives, testing::ElementsAre(0, 9, 0, 8, 9, 0, 8, 0, 5, 5));
    World again = world().at_its_opening(executor);
    ASSERT_TRUE(again.restore(world().state(executor), executor));
    again.advance_tick(executor);
    advance();
    EXPECT_EQ(again.hash(), world().hash());
    std::vector<std::uint32_t> survivors;
    for (std::uint32_t i = 0; i < 3; ++i) {
        survivors.push_back(world().islands().island(0).born().parents[i].first);
    }
    EXPECT_THAT(survivors, testing::UnorderedElementsAre(0, 2, 4));
}

TEST_F(RatingTest, RepairedChromosomesBreed) {
    parameters::Parameters parameters = rated_world(true);
    parameters.elite_count = 1;
    create(parameters);
    advance_to_rating();
    const std::vector<float> repaired{100, 101, 102, 103, 104, 105};
    EXPECT_THAT(base::to_text(rate(1, {1}, 0, {1, 2}).error()), HasSubstr("6 numbers, 6 for each rated organism"));
    EXPECT_THAT(base::to_text(rate(1, {1}, 0, {100, 101, 900, 103, 104, 105}).error()),
                HasSubstr("set_fitness.organism[0].body_size"));
    const base::StateHash before = world().hash();
    ASSERT_TRUE(rate(1, {5, 4}));
    ASSERT_TRUE(rate(1, {9}, 2, repaired));
    EXPECT_NE(world().hash(), before);
    World again = world().at_its_opening(executor);
    ASSERT_TRUE(again.restore(world().state(executor), executor));
    EXPECT_EQ(again.hash(), world().hash());
    ASSERT_TRUE(rate(1, {3, 2}, 3));
    ASSERT_TRUE(rate(0, {0, 0, 0, 0, 1}));
    const auto genes_of = [&](std::uint32_t organism) {
        const auto column = evolution::column(world().islands().island(1).born().genes, organism);
        return std::vector<float>{column.begin(), column.end()};
    };
    const std::vector<float> last = genes_of(4);
    EXPECT_NE(genes_of(2), repaired) << "the organisms that have lived do not change";
    advance();
    EXPECT_EQ(genes_of(0), repaired) << "the elite";
    EXPECT_NE(last, repaired);
}

TEST_F(RatingTest, ARestoredWorldContinues) {
    create(rated_world(true));
    advance_to_rating();
    for (int rated = 0; rated <= 3; ++rated) {
        World again = world().at_its_opening(executor);
        const auto restored = again.restore(world().state(executor), executor);
        ASSERT_TRUE(restored) << restored.error().message;
        EXPECT_EQ(again.hash(), world().hash()) << rated;
        EXPECT_EQ(again.awaits_fitness(), rated < 3);
        EXPECT_EQ(again.ratings()[1], world().ratings()[1]);
        if (rated == 0) {
            ASSERT_TRUE(rate(1, {5, 4}));
        } else if (rated == 1) {
            ASSERT_TRUE(rate(1, {3, 2, 1}, 2));
        } else if (rated == 2) {
            ASSERT_TRUE(rate(0, {0, 0, 0, 0, 1}));
        } else {
            again.advance_tick(executor);
            advance();
            EXPECT_EQ(again.hash(), world().hash());
        }
    }
}

TEST_F(RatingTest, ImpossibleStatesAreRefused) {
    create(rated_world(true));
    advance();
    const WorldState within = world().state(executor);
    advance_to_rating();
    ASSERT_TRUE(rate(1, {5, 4}));
    const WorldState sound = world().state(executor);
    const auto refused = [&](auto&& damage, WorldState state) {
        damage(state);
        World again = world().at_its_opening(executor);
        return !again.restore(state, executor);
    };
    EXPECT_FALSE(refused([](WorldState&) {}, sound));
    EXPECT_FALSE(refused([](WorldState&) {}, within));
    EXPECT_TRUE(refused([](WorldState& s) { s.ratings.clear(); }, sound));
    EXPECT_TRUE(refused([](WorldState& s) { s.ratings.resize(1); }, sound));
    EXPECT_TRUE(refused([](WorldState& s) { s.ratings[0].fitness.resize(6); }, sound));
    EXPECT_TRUE(
        refused([](WorldState& s) { s.ratings[1].fitness[0] = std::numeric_limits<double>::quiet_NaN(); }, sound));
    EXPECT_TRUE(refused([](WorldState& s) { s.ratings[1].fitness[0] = -1.1e100; }, sound));
    EXPECT_TRUE(refused([](WorldState& s) { s.ratings = {{{1, 2, 3, 4, 5}}, {{1, 2, 3, 4, 5}}}; }, sound));
    EXPECT_TRUE(refused([](WorldState& s) { s.ratings.resize(2); }, within));
    EXPECT_TRUE(refused([](WorldState& s) { s.ratings[1].genes = {1, 2, 3}; }, sound));
    EXPECT_TRUE(refused([](WorldState& s) { s.ratings[1].genes.assign(12, 1e9F); }, sound));
    EXPECT_FALSE(refused([](WorldState& s) { s.ratings[1].genes.assign(12, 100); }, sound));
}

TEST_F(RatingTest, RemovalOfTheLastOrganismStillEndsInRating) {
    create(rated_world(true));
    advance();
    for (const std::uint32_t island : {0u, 1u}) {
        ASSERT_TRUE(laboratory.apply(RemoveEntities{"w", island, {}, {}, {}, {0, 1, 2, 3, 4}}));
    }
    World before = world().at_its_opening(executor);
    ASSERT_TRUE(before.restore(world().state(executor), executor));
    EXPECT_FALSE(before.awaits_fitness());
    advance();
    EXPECT_TRUE(world().awaits_fitness());
    World after = world().at_its_opening(executor);
    ASSERT_TRUE(after.restore(world().state(executor), executor));
    EXPECT_TRUE(after.awaits_fitness());
}

TEST_F(RatingTest, AReplayTakesNoFitness) {
    create(rated_world(false));
    advance();
    entry().replay.emplace();
    const auto refused = rate(0, {1});
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().reason, base::Reason::WorldIsReplay);
}

} // namespace
} // namespace evod::simulation
