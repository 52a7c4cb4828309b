// Colonies: births, predators, and what an interval hands over to the next one.
#include "server/simulation/colony.h"

#include "server/base/inline_executor.h"
#include "server/jobs/thread_pool.h"
#include "server/simulation/world.h"
#include "tests/unit/simulation/small_island.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <set>
#include <string>
#include <vector>

namespace evod::simulation {
namespace {

using parameters::Births;
using parameters::Reproduction;
using testing::ElementsAre;
using testing::IsEmpty;

/// An island on which nothing is eaten and no organism loses health.
class QuietIsland : public SmallIsland {
  protected:
    QuietIsland() {
        parameters.reproduction = Reproduction::Births;
        parameters.births = Births::Asexual;
        parameters.health_loss_per_s = parameters.predator_health_loss_per_s = 0;
        parameters.birth_health = 100;
        parameters.birth_cost = 5;
        parameters.mutation_chance = 0;
        parameters.birth_every_s = parameters.tick_s;
        parameters.force_per_unit = 0; // organisms stay where they are, except for contacts
        parameters.predator_birth_health = 10'000;
    }
    /// The last `predators` chromosomes are those of predators.
    void begin(const std::vector<evolution::BodyGenes>& chromosomes, std::uint32_t predators) {
        evolution::NextGeneration born;
        born.genes = evolution::GeneMatrix(evolution::body_gene_count, std::ssize(chromosomes));
        for (std::size_t i = 0; i < chromosomes.size(); ++i) {
            born.genes.col(static_cast<Eigen::Index>(i)) = chromosomes[i];
        }
        born.predator_count = parameters.predator_count = predators;
        island.begin_generation(parameters, 1, std::move(born), executor);
    }
    /// Moves organisms to these places.
    void move(std::vector<Place> places) {
        IslandState state = island.state(executor);
        for (std::size_t id = 0; id < places.size(); ++id) {
            state.organisms[id].x = places[id].x;
            state.organisms[id].y = places[id].y;
        }
        island.restore(state, now, parameters, executor);
    }
    static Place at(double x_px, double y_px) { return {physics::to_units(x_px), physics::to_units(y_px)}; }
    std::uint32_t slots() const { return static_cast<std::uint32_t>(island.life_records().cause.size()); }
    CauseOfDeath cause(std::uint32_t id) const { return island.life_records().cause[id]; }
};

evolution::BodyGenes with_health(float base_health) {
    return chromosome_of(100, 100, 100, base_health, 100, 100);
}

TEST_F(QuietIsland, AChildHasWhatItsParentPays) {
    parameters.base_health_max = 10'000;
    begin({with_health(60)}, 0);
    IslandState state = island.state(executor);
    state.organisms[0].health = 100;
    island.restore(state, 0, parameters, executor);
    tick();
    ASSERT_EQ(slots(), 2u);
    EXPECT_FLOAT_EQ(health(0), 100 - 60 - 5);
    EXPECT_FLOAT_EQ(health(1), 60);
    EXPECT_EQ(island.parents_of_child(1).first, 0u);
    EXPECT_THAT(island.life_records().children, ElementsAre(1, 0));
    EXPECT_THAT(fitness(), ElementsAre(1, 0));
    EXPECT_EQ(island.number_of(1), 1u);
    EXPECT_EQ(island.colony_counts()[0].born, 1u);
}

TEST_F(QuietIsland, AParentMustBeLeftWithHealth) {
    begin({with_health(100)}, 0); // 100 for the child and 5 for the birth
    tick();
    EXPECT_EQ(slots(), 1u);
    EXPECT_FLOAT_EQ(health(0), 100);
}

TEST_F(QuietIsland, TwoParentsShareThePrice) {
    parameters.births = Births::Sexual;
    begin({with_health(100), with_health(100), with_health(100)}, 0);
    move({at(30, 30), at(60, 30), at(150, 150)});
    tick();
    ASSERT_EQ(slots(), 4u) << "the third is further away than mate_px";
    EXPECT_FLOAT_EQ(health(0), 100 - 50 - 5);
    EXPECT_FLOAT_EQ(health(1), 100 - 50 - 5);
    EXPECT_FLOAT_EQ(health(2), 100);
    EXPECT_EQ(island.parents_of_child(3).second, 1u);
}

TEST_F(QuietIsland, MatesAreTheNearestAndThenTheFirst) {
    parameters.births = Births::Sexual;
    begin({with_health(100), with_health(100), with_health(100)}, 0);
    move({at(100, 100), at(140, 100), at(60, 100)}); // both equally far away
    tick();
    ASSERT_EQ(slots(), 4u);
    EXPECT_EQ(island.parents_of_child(3).first, 0u);
    EXPECT_EQ(island.parents_of_child(3).second, 1u);
}

TEST_F(QuietIsland, BirthsEndAtTheGreatestPopulation) {
    parameters.birth_health = 0;
    parameters.birth_cost = 0;
    parameters.population_max = 3;
    begin({with_health(60), with_health(60)}, 0);
    move({at(50, 50), at(150, 150)});
    IslandState state = island.state(executor);
    state.organisms[0].health = state.organisms[1].health = 10'000;
    island.restore(state, 0, parameters, executor);
    tick();
    EXPECT_EQ(island.alive_count(), 3u);
    EXPECT_EQ(island.parents_of_child(2).first, 0u) << "lower ids come first";
    EXPECT_EQ(island.colony_counts()[0].refused, 1u);
}

TEST_F(QuietIsland, ManyPreyDoNotEndTheBirthsOfPredators) {
    parameters.birth_health = 10'000;
    parameters.predator_births = Births::Asexual;
    parameters.predator_birth_health = 100;
    parameters.predator_population_max = 2;
    std::vector<Place> places;
    for (int i = 0; i < 30; ++i) {
        places.push_back(at(30 + 40 * (i % 10), 100 + 100 * (i / 10)));
    }
    begin(std::vector(30, with_health(60)), 1);
    move(places);
    IslandState state = island.state(executor);
    state.organisms[29].health = 1'000;
    island.restore(state, now, parameters, executor);
    tick();
    EXPECT_EQ(island.colony_counts()[1].born, 1u);
    EXPECT_EQ(island.colony_counts()[1].refused, 0u);
}

TEST_F(QuietIsland, AChildNeedsRoom) {
    parameters.island_width_px = parameters.island_height_px = 100;
    parameters.birth_health = 0;
    parameters.birth_cost = 0;
    const auto giant = chromosome_of(100, 100, 200, 60, 100, 100); // 40 px wide; beside it, a child has no room
    parameters.radius_per_unit_px = 0.2;
    begin({giant}, 0);
    move({at(50, 50)});
    tick();
    EXPECT_EQ(slots(), 1u);
    EXPECT_EQ(island.colony_counts()[0].without_room, 0u) << "it cannot pay";
    IslandState state = island.state(executor);
    state.organisms[0].health = 1'000;
    island.restore(state, now, parameters, executor);
    tick();
    EXPECT_EQ(slots(), 1u);
    EXPECT_EQ(island.colony_counts()[0].without_room, 1u);
}

TEST_F(QuietIsland, OrganismsDieOfAge) {
    parameters.lifespan_s = 3 * parameters.tick_s;
    parameters.birth_health = 10'000;
    begin({with_health(60)}, 0);
    tick();
    tick();
    EXPECT_EQ(cause(0), CauseOfDeath::Alive);
    tick();
    EXPECT_EQ(cause(0), CauseOfDeath::Old);
    EXPECT_EQ(island.age_ticks(0, now), 3u);
    EXPECT_EQ(island.alive_count(), 0u);
}

TEST_F(QuietIsland, APredatorEatsAndHandlesItsMeal) {
    parameters.handling_s = 2 * parameters.tick_s;
    parameters.birth_health = 10'000;
    begin({with_health(60), with_health(60), with_health(80)}, 1);
    move({at(119, 100), at(100, 114), at(100, 100)});
    tick();
    EXPECT_EQ(cause(1), CauseOfDeath::Eaten) << "the nearest";
    EXPECT_EQ(cause(0), CauseOfDeath::Alive) << "one at a time";
    EXPECT_FLOAT_EQ(health(2), 80 + 60);
    EXPECT_EQ(island.life_records().food_eaten[2], 1u);
    tick();
    tick();
    EXPECT_EQ(cause(0), CauseOfDeath::Alive) << "it handles its meal for two ticks";
    tick();
    EXPECT_EQ(cause(0), CauseOfDeath::Eaten);
}

TEST_F(QuietIsland, ThePreyGoesToTheNearestPredator) {
    parameters.birth_health = 10'000;
    begin({with_health(60), with_health(80), with_health(80)}, 2);
    move({at(100, 100), at(119, 100), at(100, 86)});
    tick();
    EXPECT_FLOAT_EQ(health(2), 140);
    EXPECT_FLOAT_EQ(health(1), 80);
}

TEST_F(QuietIsland, PredatorsEatNoItems) {
    parameters.food_count = parameters.poison_count = 400;
    parameters.birth_health = 10'000;
    begin({with_health(60), with_health(60)}, 2);
    tick();
    EXPECT_FLOAT_EQ(health(0), 60);
    EXPECT_EQ(island.counts().food_eaten + island.counts().poison_eaten, 0u);
}

TEST_F(QuietIsland, PreyFleesAndPredatorsSeek) {
    parameters.birth_health = 10'000;
    parameters.force_per_unit = 1;
    parameters.flee_certain_impulse = 1;
    begin({with_health(60), with_health(60)}, 1);
    move({at(100, 100), at(150, 100)});
    const std::vector<Intention> intentions = island.intentions(parameters, now + 1, {0, 2});
    EXPECT_EQ(intentions[0].choice, Choice::Flee);
    EXPECT_LT(intentions[0].force_x, 0);
    EXPECT_TRUE(intentions[0].flees_predator);
    EXPECT_EQ(intentions[1].choice, Choice::Seek);
    EXPECT_LT(intentions[1].force_x, 0);
    EXPECT_EQ(intentions[1].target_x, physics::to_units(100.0));
}

parameters::Parameters colony(bool with_predators) {
    parameters::Parameters p;
    p.reproduction = Reproduction::Births;
    p.island_width_px = 900;
    p.island_height_px = 600;
    p.generation_s = 10;
    p.population_size = 60;
    p.food_count = 150;
    p.respawn_s = 3;
    p.birth_health = 110;
    p.mate_px = 200;
    p.lifespan_s = 60;
    if (with_predators) {
        p.births = p.predator_births = Births::Asexual;
        p.predator_count = 8;
        p.predator_from = 2;
        p.handling_s = 3;
    }
    return p;
}

TEST(Colony, IsTheSameOnAnyNumberOfThreads) {
    for (const bool with_predators : {false, true}) {
        jobs::ThreadPool one{1}, three{3};
        World a{colony(with_predators), base::Seed{7}}, b{colony(with_predators), base::Seed{7}};
        for (int i = 0; i < 3'000 && a.outcome() == evolution::Outcome::Running; ++i) {
            a.advance_tick(one);
            b.advance_tick(three);
            ASSERT_EQ(a.hash(), b.hash()) << i;
        }
        EXPECT_GT(a.moment().generation, 3u);
        EXPECT_GT(a.history().back().front().colony->born_count, 0u);
    }
}

TEST(Colony, AnIntervalHasAMostOrganisms) {
    parameters::Parameters p = colony(false);
    p.births = Births::Asexual;
    p.birth_health = 80;
    p.birth_cost = 0;
    p.mutation_chance = 0;
    p.initial_gene_min = p.initial_gene_max = 60;
    p.food_count = 500;
    p.lifespan_s = 6;
    p.population_size = 10;
    p.population_max = 12;
    p.generation_s = 60;
    World world{p, base::Seed{7}};
    base::InlineExecutor executor;
    while (!world.generation_over()) {
        world.advance_tick(executor);
    }
    EXPECT_EQ(parameters::interval_organisms_max(p), 4u * 12u);
    EXPECT_EQ(world.island(0).life_records().cause.size(), 4u * 12u);
}

/// Σ over all living organisms of their health.
double stock(const World& world) {
    double sum = 0;
    for (const Island& island : world.islands()) {
        for (std::size_t body = 0; body < island.bodies().size(); ++body) {
            sum += island.bodies().is_void(body) ? 0 : static_cast<double>(island.living().health[body]);
        }
    }
    return sum;
}

/// Where the health of a world's organisms came from and went to in an interval, and how their stock has changed.
struct HealthAccount {
    double food, prey, poison, life, births, dead, change;

    double error() const { return food + prey - poison - life - births - dead - change; }
    double turnover() const { return food + prey + poison + life + births + std::abs(dead); }
};

/// The parameter is the kind of world.
class EnergyAccount : public testing::TestWithParam<const char*> {
  protected:
    /// Performs a tick of a world of one island, and adds it to the account. The interval must have begun.
    void advance_tick(World& world) {
        const parameters::Parameters p = world.parameters().active;
        const Island& island = world.island(0);
        const LifeRecords before = island.life_records();
        const IslandCounts counts = island.counts();
        const std::array<ColonyCounts, 2> colony = island.colony_counts();
        const double stock_before = stock(world);
        std::vector<double> left(before.cause.size()); // after the cost of this tick of life
        for (std::uint32_t id = 0; id < left.size(); ++id) {
            if (const auto body = island.body_of(id)) {
                left[id] = static_cast<double>(island.living().health[*body] - island.living().loss_per_tick[*body]);
                account.life += static_cast<double>(island.living().loss_per_tick[*body]);
            }
        }
        world.advance_tick(executor);
        const std::array<ColonyCounts, 2>& now = island.colony_counts();
        account.food += p.food_health * static_cast<double>(island.counts().food_eaten - counts.food_eaten);
        account.poison += p.poison_harm * static_cast<double>(island.counts().poison_eaten - counts.poison_eaten);
        account.prey += p.prey_health * (now[0].eaten - colony[0].eaten);
        const auto parents = [](Births births) { return births == Births::Sexual ? 2 : 1; };
        account.births += p.birth_cost * parents(p.births) * (now[0].born - colony[0].born) +
                          p.predator_birth_cost * parents(p.predator_births) * (now[1].born - colony[1].born);
        const LifeRecords& records = island.life_records();
        for (std::uint32_t id = 0; id < left.size(); ++id) {
            if (before.cause[id] != CauseOfDeath::Alive || records.cause[id] == CauseOfDeath::Alive) {
                continue;
            }
            const double food_health = island.species_of(id) == Species::Predator ? p.prey_health : p.food_health;
            left[id] += food_health * (records.food_eaten[id] - before.food_eaten[id]) -
                        p.poison_harm * (records.poison_eaten[id] - before.poison_eaten[id]);
            account.dead += left[id];
            const bool is_exhausted =
                records.cause[id] == CauseOfDeath::Starved || records.cause[id] == CauseOfDeath::Poisoned;
            EXPECT_EQ(left[id] <= 0, is_exhausted);
        }
        account.change += stock(world) - stock_before;
    }

    base::InlineExecutor executor;
    HealthAccount account{};
};

parameters::Parameters accounted(const std::string& name) {
    parameters::Parameters p = colony(name == "predators" || name == "generations");
    p.predator_health_loss_per_s = 4;
    p.predator_birth_cost = 15;
    p.normal_speed_cost = 0.2;
    p.impulse_cost = p.food_radius_cost = 0.05;
    if (name == "asexual") {
        p.births = Births::Asexual;
    } else if (name == "generations") {
        p.reproduction = Reproduction::Generations;
    }
    return p;
}

// Health comes from food and prey alone. It goes to poison, to life and to the price of births, and with the dead. In
// every interval the account is exact but for the rounding of each change to 24 binary digits: 1e-5 of all flows.
TEST_P(EnergyAccount, BalancesInEveryInterval) {
    World world{accounted(GetParam()), base::Seed{3}};
    std::uint64_t meals = 0, births = 0;
    double greatest_error = 0;
    for (int interval = 1; interval <= 8; ++interval) {
        account = {};
        while (!world.generation_over()) {
            advance_tick(world);
        }
        EXPECT_NEAR(account.error(), 0, 1e-5 * account.turnover()) << interval;
        greatest_error = std::max(greatest_error, std::abs(account.error()) / account.turnover());
        meals += world.island(0).colony_counts()[0].eaten;
        births += world.island(0).colony_counts()[0].born;
        const double ended = stock(world);
        world.breed_next_generation(executor);
        if (world.island(0).has_births()) {
            double arrived = 0;
            const evolution::NextGeneration& next = world.island(0).born();
            for (Eigen::Index id = 0; id < next.genes.cols(); ++id) {
                const bool is_new = next.parents[static_cast<std::size_t>(id)].first == Island::no_parents.first;
                arrived += is_new ? static_cast<double>(next.genes(evolution::BaseHealth, id)) : 0;
            }
            EXPECT_EQ(arrived > 0, GetParam() == std::string{"predators"} && interval == 1);
            EXPECT_NEAR(stock(world) - ended, arrived, 1e-9 * ended);
        }
    }
    std::printf("%s: greatest error of an interval %.1e\n", GetParam(), greatest_error);
    EXPECT_EQ(meals > 0, world.parameters().active.predator_count > 0);
    EXPECT_EQ(births > 0, world.island(0).has_births());
}

INSTANTIATE_TEST_SUITE_P(Worlds, EnergyAccount, testing::Values("sexual", "asexual", "predators", "generations"));

TEST(Colony, LivesOnFromIntervalToInterval) {
    base::InlineExecutor executor;
    World world{colony(false), base::Seed{5}};
    std::set<std::uint32_t> numbers;
    for (int interval = 0; interval < 4; ++interval) {
        while (!world.generation_over()) {
            world.advance_tick(executor);
        }
        const Island& before = world.island(0);
        const double health_before = stock(world);
        std::vector<std::uint32_t> living;
        for (const std::uint32_t id : before.breeders(Species::Prey)) {
            living.push_back(before.number_of(id));
        }
        world.breed_next_generation(executor);
        const Island& after = world.island(0);
        ASSERT_EQ(after.bred_count(), living.size());
        for (std::uint32_t id = 0; id < living.size(); ++id) {
            EXPECT_EQ(after.number_of(id), living[id]);
        }
        EXPECT_EQ(stock(world), health_before);
        const auto& account = world.island(0).born().account;
        ASSERT_TRUE(account.has_value());
        const auto& ended = world.history().back().front();
        for (std::size_t gene = 0; gene < account->size(); ++gene) {
            const evolution::GeneAccount& of = (*account)[gene];
            EXPECT_NEAR(of.selection + of.transmission + of.migration, of.change, 1e-9);
            double mean = 0;
            for (std::uint32_t id = 0; id < after.bred_count(); ++id) {
                mean +=
                    static_cast<double>(after.born().genes(static_cast<Eigen::Index>(gene), id)) / after.bred_count();
            }
            EXPECT_NEAR(ended.genes[gene].mean + of.change, mean, 1e-6);
        }
    }
}

TEST(Colony, EndsWithoutPrey) {
    parameters::Parameters p = colony(false);
    p.food_count = 0;
    base::InlineExecutor executor;
    World world{p, base::Seed{5}};
    while (world.outcome() == evolution::Outcome::Running) {
        world.advance_tick(executor);
    }
    EXPECT_EQ(world.outcome(), evolution::Outcome::Extinction);
    EXPECT_EQ(world.alive_count(), 0u);
}

TEST(Colony, BreedsTwoSpeciesByGenerations) {
    parameters::Parameters p;
    p.predator_count = 15;
    p.predator_elite_count = 2;
    p.generation_s = 5;
    p.island_count = 2;
    p.migration = evolution::Topology::Ring;
    p.migration_epoch = 1;
    base::InlineExecutor executor;
    World world{p, base::Seed{11}};
    for (int generation = 1; generation < 4; ++generation) {
        while (!world.generation_over()) {
            world.advance_tick(executor);
        }
        world.breed_next_generation(executor);
        for (const Island& island : world.islands()) {
            ASSERT_EQ(island.bred_count(), 65u);
            EXPECT_EQ(island.born().predator_count, 15u);
            for (std::uint32_t id = 0; id < 65; ++id) {
                const evolution::Parents parents = island.born().parents[id];
                EXPECT_EQ(parents.first >= 50, id >= 50) << "parents are of the same species";
                EXPECT_EQ(parents.second >= 50, id >= 50);
            }
            EXPECT_TRUE(island.born().predator_account.has_value());
        }
    }
    const GenerationStatistics& statistics = world.history().back().front();
    EXPECT_EQ(statistics.organism_count, 50u);
    ASSERT_EQ(statistics.predators.size(), 1u);
    EXPECT_EQ(statistics.predators[0].organism_count, 15u);
    EXPECT_GE(statistics.predators[0].best_organism, 50u);
    EXPECT_EQ(statistics.predators[0].food_eaten, statistics.colony->eaten_count);
}

} // namespace
} // namespace evod::simulation
