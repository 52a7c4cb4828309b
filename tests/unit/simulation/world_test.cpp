#include "server/simulation/world.h"

#include "server/base/inline_executor.h"
#include "server/evolution/fitness_shuffle.h"
#include "server/evolution/migration.h"
#include "server/jobs/thread_pool.h"
#include "server/simulation/fitness.h"
#include "tests/unit/simulation/events.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <utility>
#include <vector>

namespace evod::simulation {
namespace {

using testing::ElementsAre;

class WorldTest : public testing::Test {
  protected:
    WorldTest() {
        parameters.population_size = 12;
        parameters.generation_s = 0.2; // 12 ticks
    }
    World make() const { return {parameters, base::Seed{5}}; }
    void run_generation(World& world) {
        do {
            world.advance_tick(executor);
        } while (!world.generation_over());
    }
    void request(World& world, std::vector<parameters::Assignment> assignments) {
        const auto requested = parameters::assign(world.parameters().requested, assignments);
        ASSERT_TRUE(requested.has_value()) << to_text(requested.error());
        world.request_parameters(*requested);
    }

    parameters::Parameters parameters;
    base::InlineExecutor executor;
};

TEST_F(WorldTest, EndsAGenerationExactlyOnTime) {
    for (const auto& [generation_s, tick_s, ticks] : {std::tuple{0.2, 1.0 / 60, 12u},
                                                      {40.0, 1.0 / 60, 2400u},
                                                      {1.0, 0.1, 10u},
                                                      {0.3, 0.1, 3u},
                                                      {7.0, 0.07, 100u},
                                                      {0.001, 0.001, 1u},
                                                      {0.9, 0.3, 3u}}) {
        parameters.generation_s = generation_s;
        parameters.tick_s = tick_s;
        parameters.health_loss_per_s = 0;
        parameters.poison_count = 0;
        World world = make();
        run_generation(world);
        EXPECT_EQ(world.moment().tick, ticks) << generation_s << " s of " << tick_s << " s";
        EXPECT_NEAR(world.moment().simulated_s, generation_s, 1e-9);
    }
}

TEST_F(WorldTest, WaitsAtTheEndOfAGeneration) {
    World world = make();
    run_generation(world);
    EXPECT_EQ(world.moment().generation, 1u);
    EXPECT_EQ(world.moment().generation_tick, 12u);
    EXPECT_EQ(world.history().size(), 1u);
    EXPECT_EQ(events<GenerationFinished>(world).size(), 1u);
    world.advance_tick(executor);
    EXPECT_FALSE(world.generation_over());
    EXPECT_EQ(world.moment().generation, 2u);
    EXPECT_EQ(world.moment().generation_tick, 1u);
    EXPECT_EQ(world.moment().tick, 13u);
}

TEST_F(WorldTest, TurnOverEqualsThatOfTheNextTick) {
    World at_once = make(), in_two = make();
    run_generation(at_once);
    run_generation(in_two);
    in_two.breed_next_generation(executor);
    EXPECT_EQ(in_two.moment().generation, 2u);
    EXPECT_EQ(in_two.moment().generation_tick, 0u);
    in_two.breed_next_generation(executor); // no generation has ended
    EXPECT_EQ(in_two.moment().generation, 2u);
    at_once.advance_tick(executor);
    in_two.advance_tick(executor);
    EXPECT_EQ(in_two.hash(), at_once.hash());
}

TEST_F(WorldTest, EndsAGenerationWhenAllIslandsAreDead) {
    parameters.island_count = 3;
    parameters.generation_s = 1000;
    parameters.health_loss_per_s = 100;
    parameters.respawn = false;
    World world = make();
    std::vector<base::StateHash> frozen(3);
    std::vector<bool> dead(3, false);
    while (!world.generation_over()) {
        world.advance_tick(executor);
        for (std::size_t i = 0; i < 3; ++i) {
            ASSERT_TRUE(!dead[i] || world.islands()[i].hash() == frozen[i]) << "an island that has died out waits";
            dead[i] = world.islands()[i].alive_count() == 0;
            frozen[i] = world.islands()[i].hash();
        }
    }
    EXPECT_EQ(world.alive_count(), 0u);
    std::vector<std::uint32_t> extinct;
    std::uint64_t longest = 0;
    for (const Extinction& extinction : events<Extinction>(world)) {
        extinct.push_back(extinction.island);
    }
    EXPECT_THAT(extinct, testing::UnorderedElementsAre(0, 1, 2));
    for (const Island& island : world.islands()) {
        for (const std::uint32_t ticks : island.life_records().lived_ticks) {
            longest = std::max<std::uint64_t>(longest, ticks);
        }
    }
    EXPECT_EQ(world.moment().generation_tick, longest);
    world.advance_tick(executor);
    EXPECT_EQ(world.alive_count(), 36u) << "and everything is replaced";
}

TEST_F(WorldTest, AppliesParametersAtTickOrGeneration) {
    World world = make();
    world.advance_tick(executor);
    request(world, {{"food_health", 0.0},
                    {"population_size", std::uint32_t{20}},
                    {"food_count", std::uint32_t{3}},
                    {"generation_s", 0.1}});
    EXPECT_EQ(world.parameters().active.food_health, 0);
    EXPECT_EQ(world.parameters().active.population_size, 12u);
    run_generation(world);
    EXPECT_EQ(world.moment().generation_tick, 12u);
    EXPECT_EQ(world.islands()[0].food().size(), 25u);
    run_generation(world);
    EXPECT_EQ(world.moment().generation_tick, 6u);
    EXPECT_EQ(world.islands()[0].food().size(), 3u);
    EXPECT_EQ(world.history().back()[0].organism_count, 20u);
}

TEST_F(WorldTest, GrowsAndShrinksWithEveryModelAndSelection) {
    for (const char* model : {"hybrid", "generational", "steady_state"}) {
        for (const char* selection : {"roulette", "stochastic_universal", "tournament", "random", "truncation"}) {
            World world = make();
            request(world, {{"population_model", std::string{model}}, {"selection", std::string{selection}}});
            for (const std::uint32_t size : {1u, 2u, 60u, 3u, 31u, 1u, 1u}) {
                run_generation(world);
                request(world, {{"population_size", size}});
                world.advance_tick(executor);
                ASSERT_EQ(world.islands()[0].life_records().cause.size(), size) << model << ", " << selection;
                ASSERT_EQ(world.islands()[0].bodies().size(), size) << model << ", " << selection;
            }
        }
    }
}

TEST_F(WorldTest, MigratesExactlyOncePerEpoch) {
    parameters.island_count = 3;
    parameters.migration = evolution::Topology::Ring;
    parameters.migration_epoch = 2;
    parameters.migrant_count = 2;
    World world = make();
    std::vector<std::uint64_t> generations;
    for (int generation = 1; generation <= 6; ++generation) {
        run_generation(world);
        world.breed_next_generation(executor);
        for (const MigrationHappened& happened : events<MigrationHappened>(world)) {
            generations.push_back(happened.generation);
            ASSERT_EQ(happened.edges.size(), 3u);
            for (const auto& edge : happened.edges) {
                EXPECT_EQ(edge.to, (edge.from + 1) % 3);
                EXPECT_EQ(edge.migrant_count, 2u);
            }
        }
    }
    EXPECT_THAT(generations, ElementsAre(2, 4, 6));
}

TEST_F(WorldTest, CarriesTheBestChromosomeRoundTheRing) {
    // Only the first island can have large genes; without migration no other island would ever have them.
    parameters.island_count = 2;
    parameters.fitness = parameters::FitnessFunction::GeneSum;
    parameters.migration = evolution::Topology::Ring;
    parameters.migration_epoch = 1;
    parameters.mutation_chance = 0;
    parameters.selection = evolution::SelectionMethod::Truncation;
    parameters.crossover = evolution::CrossoverMethod::None;
    World world = make();
    double best = 0;
    world.advance_tick(executor);
    for (const GenerationStatistics& s : world.history().back()) {
        best = std::max(best, s.fitness_best);
    }
    for (int generation = 0; generation < 20; ++generation) {
        world.advance_tick(executor);
    }
    for (const GenerationStatistics& s : world.history().back()) {
        EXPECT_EQ(s.fitness_best, best);
        EXPECT_EQ(s.fitness_worst, best) << "copies of the best take over both islands";
    }
}

TEST_F(WorldTest, AccountsForTheChangeOfGeneMeans) {
    // With enough organisms to divide an island among threads, and changing numbers.
    parameters.island_count = 2;
    parameters.population_size = 20'000;
    parameters.fitness = parameters::FitnessFunction::GeneSum;
    parameters.selection = evolution::SelectionMethod::Truncation;
    parameters.migration = evolution::Topology::Ring;
    parameters.migrant_count = 500;
    parameters.migration_epoch = 2;
    jobs::ThreadPool many{3};
    World world = make(), again = make();
    for (unsigned generation = 1; generation <= 6; ++generation) {
        for (World* each : {&world, &again}) {
            request(*each, {{"population_size", std::array{20'000u, 23'000u, 17'000u}[generation % 3]}});
        }
        world.advance_tick(executor);
        again.advance_tick(many);
        for (std::size_t island = 0; island < 2; ++island) {
            const GenerationStatistics& now = world.history().back()[island];
            ASSERT_EQ(now.account, again.history().back()[island].account);
            ASSERT_EQ(now.account.has_value(), generation > 1);
            if (generation == 1) {
                continue;
            }
            const GenerationStatistics& before = world.history()[generation - 2][island];
            for (unsigned gene = 0; gene < evolution::body_gene_count; ++gene) {
                const evolution::GeneAccount& account = (*now.account)[gene];
                EXPECT_NEAR(account.change, now.genes[gene].mean - before.genes[gene].mean, 1e-10);
                EXPECT_NEAR(account.selection + account.transmission + account.migration, account.change,
                            1e-9 * std::abs(account.change));
                EXPECT_GT(account.selection, 0) << "greater genes are fitter";
                EXPECT_EQ(account.migration != 0, generation % 2 == 1) << "after each second generation";
            }
        }
    }
}

TEST_F(WorldTest, BreedsByShuffledFitnessAndReportsTheTrueOne) {
    parameters.island_count = 3;
    parameters.elite_count = 2;
    parameters.migration = evolution::Topology::Ring;
    parameters.migration_epoch = 1;
    parameters.food_count = 100; // so that they differ
    World plain = make();
    parameters.shuffle_fitness = true;
    World world = make();
    run_generation(plain);
    run_generation(world);
    ASSERT_EQ(world.hash(), plain.hash());
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_EQ(world.outcomes()[i].fitness, plain.outcomes()[i].fitness);
        EXPECT_EQ(world.history()[0][i].fitness_best, plain.history()[0][i].fitness_best);
    }
    // The same, step by step: shuffle, migration, breeding.
    std::vector<std::vector<double>> fitness;
    for (const IslandOutcome& outcome : world.outcomes()) {
        fitness.push_back(outcome.fitness);
    }
    std::vector<evolution::GeneMatrix> genes;
    std::vector<evolution::IslandPopulation> populations;
    for (std::uint32_t i = 0; i < 3; ++i) {
        evolution::shuffle_fitness(fitness[i], {.seed = base::Seed{5}, .island = i, .generation = 1}, executor);
        EXPECT_NE(fitness[i], world.outcomes()[i].fitness);
        genes.push_back(world.islands()[i].born().genes);
    }
    for (std::uint32_t i = 0; i < 3; ++i) {
        populations.push_back({&genes[i], fitness[i]});
    }
    const std::vector<std::span<const double>> spans(fitness.begin(), fitness.end());
    evolution::migrate(evolution::choose_migrants(spans, parameters, base::Seed{5}, 1), populations);
    world.breed_next_generation(executor);
    plain.breed_next_generation(executor);
    for (std::uint32_t i = 0; i < 3; ++i) {
        const auto expected = evolution::next_generation(
            fitness[i], genes[i], parameters, 12, {.seed = base::Seed{5}, .island = i, .generation = 1}, executor);
        const evolution::NextGeneration& born = world.islands()[i].born();
        EXPECT_EQ(born.parents, expected.parents);
        EXPECT_TRUE((born.genes == expected.genes).all());
        EXPECT_NE(plain.islands()[i].born().parents, expected.parents);
    }
}

TEST_F(WorldTest, FindsFoundersAcrossIslands) {
    // All organisms survive and no chromosome changes, so every organism has that of a founder.
    parameters.island_count = 3;
    parameters.fitness = parameters::FitnessFunction::GeneSum;
    parameters.migration = evolution::Topology::Ring;
    parameters.migration_epoch = 2;
    parameters.mutation_chance = 0;
    parameters.survivors = 1;
    World world = make();
    std::vector<evolution::BodyGenes> first;
    for (const Island& island : world.islands()) {
        for (std::uint32_t id = 0; id < 12; ++id) {
            EXPECT_EQ(world.islands().founders(island.index())[id], first.size());
            first.emplace_back(island.born().genes.col(id));
        }
    }
    bool came_from_elsewhere = false;
    const auto expect_founders = [&](const World& of) {
        for (const Island& island : of.islands()) {
            ASSERT_EQ(of.islands().founders(island.index()).size(), 12u);
            for (std::uint32_t id = 0; id < 12; ++id) {
                const std::uint32_t founder = of.islands().founders(island.index())[id];
                EXPECT_TRUE((island.born().genes.col(id) == first[founder]).all())
                    << "organism " << id << " of generation " << of.moment().generation;
                came_from_elsewhere |= founder / 12 != island.index();
            }
        }
    };
    for (int generation = 0; generation < 8; ++generation) {
        world.advance_tick(executor);
        expect_founders(world);
    }
    EXPECT_TRUE(came_from_elsewhere);
    expect_founders(world.at_its_opening(executor));

    std::vector<evolution::NextGeneration> born;
    for (const Island& island : world.islands()) {
        born.push_back(island.born());
    }
    World later{base::Seed{5}, world.opening(), {std::move(born), {}}, {}, executor};
    later.advance_tick(executor);
    later.breed_next_generation(executor);
    EXPECT_TRUE(later.islands().founders(0).empty()) << "unknown without the first generation";
    later = later.restarted(base::Seed{6});
    EXPECT_EQ(later.islands().founders(2)[11], 35u);
}

TEST_F(WorldTest, WithoutCrossoverGenesEqualTheFounders) {
    parameters.population_size = 50;
    parameters.island_count = 2;
    parameters.fitness = parameters::FitnessFunction::GeneSum;
    parameters.migration = evolution::Topology::Ring;
    parameters.migration_epoch = 3;
    parameters.mutation_chance = 0;
    parameters.crossover_chance = 0;
    parameters.replaced_count = 30;
    for (const auto model : {evolution::PopulationModel::Hybrid, evolution::PopulationModel::Generational,
                             evolution::PopulationModel::SteadyState}) {
        parameters.population_model = model;
        World world = make();
        std::vector<evolution::BodyGenes> first;
        for (const Island& island : world.islands()) {
            for (std::uint32_t id = 0; id < 50; ++id) {
                first.emplace_back(island.born().genes.col(id));
            }
        }
        while (world.moment().generation < 30) {
            world.advance_tick(executor);
            for (const Island& island : world.islands()) {
                for (std::uint32_t id = 0; id < 50; ++id) {
                    ASSERT_TRUE(
                        (island.born().genes.col(id) == first[world.islands().founders(island.index())[id]]).all())
                        << "organism " << id << " of generation " << world.moment().generation;
                }
            }
        }
    }
}

TEST_F(WorldTest, ChildrenHaveHalfTheirGenesFromTheFounder) {
    parameters.population_size = 2'000;
    parameters.fitness = parameters::FitnessFunction::GeneSum;
    parameters.mutation_chance = 0;
    for (const double chance : {0.0, 0.5, 1.0}) {
        parameters.crossover_chance = chance;
        World world = make();
        const evolution::GeneMatrix first = world.islands()[0].born().genes;
        world.advance_tick(executor);
        world.breed_next_generation(executor);
        const Island& island = world.islands()[0];
        for (std::uint32_t id = 0; id < 2'000; ++id) {
            EXPECT_GE((island.born().genes.col(id) == first.col(world.islands().founders(island.index())[id])).count(),
                      3)
                << id;
        }
    }
}

/// docs/MODEL.md states these figures.
TEST_F(WorldTest, FloatHealthDelaysStarvingByOneTick) {
    parameters.generation_s = 40;
    parameters.food_count = parameters.poison_count = 0;
    for (const auto& [base_health, tick] : {std::pair{80, 801u}, {100, 1001u}, {120, 1201u}}) {
        parameters.initial_gene_min = parameters.initial_gene_max = base_health;
        World world = make();
        run_generation(world);
        EXPECT_EQ(world.alive_count(), 0u);
        EXPECT_EQ(world.moment().generation_tick, tick);
    }
}

/// docs/MODEL.md states these figures.
TEST_F(WorldTest, SurvivorsHealthHasAnErrorBelowAFiftieth) {
    // The health of a survivor in exact numbers: its base health, its meals, and a tenth less for each of 2,400 ticks.
    parameters.population_size = 500;
    parameters.scale_with_population = true;
    parameters.reference_population = 50;
    parameters.generation_s = 40;
    World world = make();
    run_generation(world);
    const LifeRecords life_records = world.state(executor).islands[0].life_records;
    const Island& island = world.islands()[0];
    int survivors = 0;
    bool rounded = false;
    for (std::uint32_t id = 0; id < 500; ++id) {
        if (life_records.lived_ticks[id] != 0) {
            continue;
        }
        const double exact = 40 + double{island.born().genes(evolution::BaseHealth, id)} +
                             25.0 * life_records.food_eaten[id] - 40.0 * life_records.poison_eaten[id] - 240;
        EXPECT_NEAR(world.outcomes()[0].fitness[id], exact, 0.02) << "organism " << id;
        rounded |= std::abs(world.outcomes()[0].fitness[id] - exact) > 0.005;
        ++survivors;
    }
    EXPECT_GT(survivors, 100);
    EXPECT_TRUE(rounded);
}

TEST_F(WorldTest, LimitsTheStatisticsKept) {
    EXPECT_EQ(history_generations_kept_of(1), history_generations_kept);
    EXPECT_EQ(history_generations_kept_of(4096), 32u);
    EXPECT_EQ(history_generations_kept_of(10 * history_rows_kept), 1u);
    parameters.fitness = parameters::FitnessFunction::GeneSum;
    parameters.population_size = 2;
    parameters.island_count = 2048;
    World world = make();
    while (world.moment().generation < 70 || !world.generation_over()) {
        world.advance_tick(executor);
    }
    EXPECT_EQ(world.history().size(), 64u);
    EXPECT_EQ(world.history().front().front().generation, 7u);
}

TEST_F(WorldTest, AForkDropsOldStatistics) {
    parameters.fitness = parameters::FitnessFunction::GeneSum;
    World world = make();
    while (world.moment().generation < 1'005 || !world.generation_over()) {
        world.advance_tick(executor);
    }
    world.become_fork();
    EXPECT_EQ(world.history().size(), history_generations_inherited + 1) << "and its own first";
    EXPECT_EQ(world.history().front().front().generation, 5u);
    world.become_fork();
    EXPECT_EQ(world.history().front().front().generation, 5u);
}

TEST_F(WorldTest, EndsByEachCriterionAndReportsIt) {
    const auto outcome_with = [&](std::vector<parameters::Assignment> assignments) {
        World world{*parameters::assign(parameters, assignments), base::Seed{5}};
        for (int generation = 0; generation < 50 && world.outcome() == evolution::Outcome::Running; ++generation) {
            run_generation(world);
        }
        const auto terminated = events<RunTerminated>(world);
        EXPECT_EQ(terminated.size(), world.outcome() == evolution::Outcome::Running ? 0u : 1u);
        return std::pair{world.outcome(), world.moment().generation};
    };
    using evolution::Outcome;
    EXPECT_EQ(outcome_with({}).first, Outcome::Running);
    EXPECT_EQ(outcome_with({{"generation_limit", std::uint32_t{4}}}),
              (std::pair{Outcome::GenerationLimit, std::uint64_t{4}}));
    EXPECT_EQ(outcome_with({{"stop_at_target_fitness", true}, {"target_fitness", 10.0}}),
              (std::pair{Outcome::TargetFitness, std::uint64_t{1}}));
    EXPECT_EQ(outcome_with({{"stop_at_extinction", true}, {"health_loss_per_s", 10'000.0}, {"food_health", 0.0}}),
              (std::pair{Outcome::Extinction, std::uint64_t{1}}));
    EXPECT_EQ(outcome_with({{"stagnation_limit", std::uint32_t{3}},
                            {"mutation_chance", 0.0},
                            {"fitness", std::string{"gene_sum"}},
                            {"crossover", std::string{"none"}},
                            {"elite_count", std::uint32_t{1}}}),
              (std::pair{Outcome::Stagnation, std::uint64_t{4}}));
}

TEST_F(WorldTest, TakesOneTickForAChromosomeFitness) {
    parameters.fitness = parameters::FitnessFunction::Rastrigin;
    World world = make();
    for (std::uint64_t tick = 1; tick <= 20; ++tick) {
        world.advance_tick(executor);
        ASSERT_TRUE(world.generation_over());
        ASSERT_EQ(world.moment().generation, tick);
        ASSERT_EQ(world.history().size(), tick);
    }
    EXPECT_FALSE(world.has_bodies());
}

TEST_F(WorldTest, ResetGivesTheSameHashesAgain) {
    World world = make();
    std::vector<base::StateHash> hashes{world.hash()};
    for (int tick = 0; tick < 30; ++tick) {
        world.advance_tick(executor);
        hashes.push_back(world.hash());
    }
    world = world.restarted(base::Seed{5});
    EXPECT_TRUE(world.history().empty());
    EXPECT_EQ(world.hash(), hashes[0]);
    for (std::size_t tick = 1; tick <= 30; ++tick) {
        world.advance_tick(executor);
        ASSERT_EQ(world.hash(), hashes[tick]) << "tick " << tick;
    }
    world = world.restarted(base::Seed{6});
    EXPECT_NE(world.hash(), hashes[0]);
}

TEST_F(WorldTest, ReplacesEverythingAtUniformPlacesEachGeneration) {
    World world = make();
    const auto food = world.islands()[0].food().all();
    const auto bodies = world.islands()[0].bodies().x;
    run_generation(world);
    world.breed_next_generation(executor);
    EXPECT_NE(world.islands()[0].food().all()[0].x, food[0].x);
    EXPECT_NE(world.islands()[0].bodies().x, bodies);
    EXPECT_EQ(world.islands()[0].food().present_count(), 25u);
}

TEST_F(WorldTest, HasTheSameStatisticsOnAnyThreadCount) {
    parameters.fitness = parameters::FitnessFunction::GeneSum;
    parameters.population_size = 30'000;
    const auto statistics = [&](base::Executor& with) {
        World world = make();
        world.advance_tick(with);
        return world.history().back()[0];
    };
    const GenerationStatistics reference = statistics(executor);
    for (const std::size_t threads : {2, 3, 8, 13}) {
        jobs::ThreadPool many{threads};
        const GenerationStatistics s = statistics(many);
        EXPECT_EQ(s.fitness_mean, reference.fitness_mean);
        EXPECT_EQ(s.fitness_deviation, reference.fitness_deviation);
        EXPECT_EQ(s.fitness_median, reference.fitness_median);
        EXPECT_EQ(s.best_organism, reference.best_organism);
        EXPECT_EQ(s.fitness_worst, reference.fitness_worst);
        EXPECT_EQ(s.diversity, reference.diversity);
    }
    World world = make();
    world.advance_tick(executor);
    std::vector<double> fitness;
    double sum = 0, squares = 0;
    for (Eigen::Index i = 0; i < 30'000; ++i) {
        fitness.push_back(gene_sum(world.islands()[0].born().genes.col(i)));
        sum += fitness.back();
        squares += fitness.back() * fitness.back();
    }
    EXPECT_NEAR(reference.fitness_mean, sum / 30'000, 1e-8);
    EXPECT_NEAR(reference.fitness_deviation, std::sqrt(squares / 30'000 - sum / 30'000 * sum / 30'000), 1e-6);
    EXPECT_EQ(reference.best_organism, std::ranges::max_element(fitness) - fitness.begin());
    EXPECT_EQ(reference.fitness_worst, std::ranges::min(fitness));
}

TEST_F(WorldTest, StatisticsEqualSumsOverOrganisms) {
    parameters.island_count = 2;
    parameters.population_size = 25;
    parameters.generation_s = 12;
    parameters.poison_count = 120;
    parameters.mutation_step = 60;
    World world = make();
    for (int generation = 1; generation <= 4; ++generation) {
        run_generation(world);
        for (std::size_t i = 0; i < 2; ++i) {
            const GenerationStatistics& s = world.history().back()[i];
            const Island& island = world.islands()[i];
            const LifeRecords& life_records = island.life_records();
            EXPECT_EQ(s.generation, static_cast<std::uint64_t>(generation));
            EXPECT_EQ(s.island, i);
            EXPECT_EQ(s.end_tick, world.moment().tick);
            EXPECT_EQ(s.organism_count, 25u);

            std::vector<double> fitness(25);
            std::uint64_t food = 0, poison = 0;
            std::uint32_t alive = 0, starved = 0, poisoned = 0;
            for (std::uint32_t id = 0; id < 25; ++id) {
                const auto body = island.body_of(id);
                ASSERT_EQ(body.has_value(), life_records.cause[id] == CauseOfDeath::Alive);
                fitness[id] = body ? static_cast<double>(world.moment().generation_tick) / 60 +
                                         static_cast<double>(island.living().health[*body])
                                   : life_records.lived_ticks[id] / 60.0;
                food += life_records.food_eaten[id];
                poison += life_records.poison_eaten[id];
                alive += life_records.cause[id] == CauseOfDeath::Alive;
                starved += life_records.cause[id] == CauseOfDeath::Starved;
                poisoned += life_records.cause[id] == CauseOfDeath::Poisoned;
            }
            EXPECT_EQ(s.food_eaten, food);
            EXPECT_EQ(s.poison_eaten, poison);
            EXPECT_EQ(s.alive_count, alive);
            EXPECT_EQ(s.starved_count, starved);
            EXPECT_EQ(s.poisoned_count, poisoned);
            double mean = 0, variance = 0;
            for (const double value : fitness) {
                mean += value / 25;
            }
            for (const double value : fitness) {
                variance += (value - mean) * (value - mean) / 25;
            }
            EXPECT_NEAR(s.fitness_mean, mean, 1e-9);
            EXPECT_NEAR(s.fitness_deviation, std::sqrt(variance), 1e-9);
            const auto best = std::max_element(fitness.begin(), fitness.end());
            EXPECT_NEAR(s.fitness_best, *best, 1e-9);
            EXPECT_EQ(s.best_organism, best - fitness.begin());
            std::sort(fitness.begin(), fitness.end());
            EXPECT_NEAR(s.fitness_worst, fitness.front(), 1e-9);
            EXPECT_NEAR(s.fitness_median, fitness[12], 1e-9);

            double diversity = 0;
            const evolution::GeneBounds bounds = evolution::gene_bounds(parameters);
            for (unsigned gene = 0; gene < evolution::body_gene_count; ++gene) {
                double sum = 0, squares = 0, least = 1e9, greatest = 0;
                for (std::uint32_t id = 0; id < 25; ++id) {
                    const double value = static_cast<double>(evolution::column(island.born().genes, id)[gene]);
                    sum += value;
                    squares += value * value;
                    least = std::min(least, value);
                    greatest = std::max(greatest, value);
                }
                const double deviation = std::sqrt(std::max(squares / 25 - sum / 25 * sum / 25, 0.0));
                EXPECT_NEAR(s.genes[gene].mean, sum / 25, 1e-9);
                EXPECT_NEAR(s.genes[gene].deviation, deviation, 1e-6);
                EXPECT_EQ(s.genes[gene].min, least);
                EXPECT_EQ(s.genes[gene].max, greatest);
                diversity += deviation / static_cast<double>(bounds.max(gene) - bounds.min(gene)) / 6;
            }
            EXPECT_NEAR(s.diversity, diversity, 1e-6);
            EXPECT_EQ(s.clamp_count, island.born().clamped_count);
            const LiveStatistics live = island.live_statistics();
            EXPECT_EQ(live.alive_count, alive);
            EXPECT_EQ(live.organism_count, 25u);
            EXPECT_EQ(live.food_eaten, food);
        }
    }
}

} // namespace
} // namespace evod::simulation
