#include "server/protocol/worlds.h"

#include "server/protocol/queries.h"
#include "tests/unit/protocol/messages.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>
#include <vector>

namespace evod::protocol {
namespace {

TEST_F(Lived, AWorldIsConvertedCompletely) {
    entry().ticks_per_s = 60;
    entry().slowed = true;
    // Unset: it awaits no fitness, its free genes have no list, it has no owner, has not ended, is live, and is paced.
    EXPECT_THAT(unset_in(to_proto(entry())),
                testing::ElementsAre("awaited_fitness", "class", "free_genes", "frozen", "outcome", "owner", "replay",
                                     "speed.max", "storage"));
    entry().storage = {.state = simulation::StorageState::Failing, .reason = "it is full"};
    EXPECT_THAT(unset_in(to_proto(entry())), testing::ElementsAre("awaited_fitness", "class", "free_genes", "frozen",
                                                                  "outcome", "owner", "replay", "speed.max"));
    entry().replay = {.replay_of = "v", .first_generation = 1, .last_generation = 2, .first_tick = 3, .last_tick = 4};
    EXPECT_THAT(unset_in(to_proto(entry())), testing::ElementsAre("awaited_fitness", "class", "free_genes", "frozen",
                                                                  "outcome", "owner", "speed.max"));
    EXPECT_EQ(to_proto(entry()).run_until_generation(), 101);
}

TEST(WorldMessage, GenerationStatisticsAreConvertedInOrder) {
    simulation::GenerationStatistics s;
    double next = 1;
    const auto number = [&] { return next++; };
    const auto count = [&] { return static_cast<std::uint32_t>(next++); };
    s.generation = count(), s.island = count(), s.end_tick = count(), s.organism_count = count();
    s.fitness_best = number(), s.fitness_mean = number(), s.fitness_median = number(), s.fitness_worst = number();
    s.fitness_deviation = number();
    s.account.emplace(s.genes.size());
    for (std::size_t gene = 0; gene < s.genes.size(); ++gene) {
        s.genes[gene] = {number(), number(), number(), number()};
        (*s.account)[gene] = {number(), number(), number(), number()};
    }
    s.diversity = number(), s.alive_count = count(), s.starved_count = count(), s.poisoned_count = count();
    s.food_eaten = count(), s.poison_eaten = count(), s.clamp_count = count(), s.too_fast_count = count();
    s.speed_limit_count = count(), s.best_organism = count(), s.simulated_s = number();
    s.colony = simulation::ColonyStatistics{.first_count = count(),
                                            .lowest_count = count(),
                                            .count_mean = number(),
                                            .born_count = count(),
                                            .refused_count = count(),
                                            .without_room_count = count(),
                                            .eaten_count = count(),
                                            .old_count = count(),
                                            .died_count = count(),
                                            .children_mean = number(),
                                            .children_variance = number(),
                                            .age_mean_s = number()};
    const auto message = to_proto(s);
    EXPECT_THAT(unset_in(message), testing::ElementsAre("predators"));
    // The fields are in the order of the message, so the numbers must rise.
    std::vector<double> numbers, expected;
    collect_numbers(message, numbers);
    for (double n = 1; n < next; ++n) {
        expected.push_back(n);
    }
    EXPECT_EQ(numbers, expected);
    simulation::GenerationStatistics both = s;
    both.predators = {s};
    EXPECT_EQ(to_proto(both).predators().SerializeAsString(), message.SerializeAsString());
    s.account.reset();
    s.colony.reset();
    EXPECT_THAT(unset_in(to_proto(s)), testing::ElementsAre("colony", "genes.account", "predators"));
}

TEST(WorldMessage, LiveStatisticsAreConvertedCompletely) {
    const simulation::LiveStatistics s{.organism_count = 2,
                                       .alive_count = 3,
                                       .health_mean = 4,
                                       .food_eaten = 5,
                                       .poison_eaten = 6,
                                       .starved_count = 7,
                                       .poisoned_count = 8,
                                       .eaten_count = 9,
                                       .old_count = 10,
                                       .born_count = 11,
                                       .predator_count = 12};
    std::vector<double> numbers;
    collect_numbers(to_proto(s, 1), numbers);
    EXPECT_THAT(numbers, testing::ElementsAre(1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12));
}

TEST_F(Lived, AnOrganismIsConvertedCompletely) {
    std::set<std::string> never;
    for (std::uint32_t id = 0; id < 50; ++id) {
        const auto unset = unset_in(organism_info(entry().world, entry().world.islands()[1], id));
        if (id == 0) {
            never = unset;
            continue;
        }
        std::set<std::string> both;
        std::set_intersection(never.begin(), never.end(), unset.begin(), unset.end(), std::inserter(both, both.end()));
        never = both;
    }
    // not every organism eats or dies in a quarter of a second
    never.erase("poison_eaten"), never.erase("cause_of_death");
    never.erase("placed_tick"); // no command has placed an organism
    for (const char* const of_colonies : {"species", "number", "age_s", "children", "handling_s", "flees_predator"}) {
        never.erase(of_colonies);
    }
    EXPECT_THAT(never, testing::UnorderedElementsAre("brain", "heading")) << "of organisms with a network";
}

TEST(OrganismMessage, OrganismsOfColoniesHaveSpeciesAndNumbers) {
    parameters::Parameters parameters;
    parameters.reproduction = parameters::Reproduction::Births;
    parameters.births = parameters.predator_births = parameters::Births::Asexual;
    parameters.birth_health = 60;
    parameters.birth_cost = 0;
    parameters.food_count = 500;
    parameters.predator_count = 4;
    simulation::World world{parameters, base::Seed{4}};
    base::InlineExecutor executor;
    for (int tick = 0; tick < 300; ++tick) {
        world.advance_tick(executor);
    }
    const simulation::Island& island = world.islands()[0];
    EXPECT_EQ(organism_info(world, island, 49).species(), v1::SPECIES_UNSPECIFIED);
    const v1::OrganismInfo predator = organism_info(world, island, 50);
    EXPECT_EQ(predator.species(), v1::SPECIES_PREDATOR);
    EXPECT_EQ(predator.number(), 50);
    ASSERT_GT(island.born().genes.cols(), 54);
    const v1::OrganismInfo child = organism_info(world, island, 54);
    ASSERT_EQ(child.parents_size(), 1);
    EXPECT_EQ(organism_info(world, island, child.parents(0)).species(), child.species());
    EXPECT_GT(organism_info(world, island, child.parents(0)).children(), 0);
    EXPECT_TRUE(child.has_placed_tick());
    EXPECT_EQ(child.number(), 54);
    EXPECT_LT(child.age_s(), predator.age_s());
}

TEST(OrganismMessage, ContainsTheActivationsOfItsNetwork) {
    parameters::Parameters parameters;
    parameters.controller = evolution::Controller::Network;
    parameters.sense_poison = false;
    parameters.brain_hidden = 3;
    simulation::World world{parameters, base::Seed{4}};
    base::InlineExecutor executor;
    for (int tick = 0; tick < 30; ++tick) {
        world.advance_tick(executor);
    }
    const simulation::Island& island = world.islands()[0];
    const v1::OrganismInfo info = organism_info(world, island, 7);
    EXPECT_EQ(info.heading(), double{island.living().heading[*island.body_of(7)]});
    EXPECT_EQ(info.choice(), v1::CHOICE_STEER);
    EXPECT_THAT(unset_in(info.brain()), testing::IsEmpty());
    EXPECT_THAT(info.brain().input_names(), testing::ElementsAre("food_bearing", "food_proximity"));
    EXPECT_THAT(info.brain().output_names(), testing::ElementsAre("thrust", "turn"));
    const auto& genes = info.genes();
    ASSERT_EQ(genes.size(), 6 + 3 * 3 + 2 * 4);
    int next = 6;
    const auto expect_layer = [&](const auto& before, const auto& layer) {
        for (const float activation : layer) {
            double sum = 0;
            for (const float input : before) {
                sum += double{genes.Get(next++)} * double{input};
            }
            EXPECT_NEAR(activation, std::tanh(sum + double{genes.Get(next++)}), 2e-6); // the last weight is the bias
        }
    };
    expect_layer(info.brain().inputs(), info.brain().hidden());
    expect_layer(info.brain().hidden(), info.brain().outputs());
}

} // namespace
} // namespace evod::protocol
