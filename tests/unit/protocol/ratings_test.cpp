#include "server/protocol/ratings.h"

#include "server/base/inline_executor.h"
#include "server/protocol/commands.h"
#include "server/protocol/events.h"
#include "server/protocol/queries.h"
#include "server/protocol/worlds.h"
#include "server/simulation/laboratory.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <limits>

namespace evod::protocol {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

base::Result<simulation::Command> rating_of(v1::Request request) {
    request.set_request_id(1);
    request.set_client_key("test");
    return to_command(request, {});
}

TEST(SetFitness, BecomesACommand) {
    v1::Request request;
    v1::SetFitness& set = *request.mutable_set_fitness();
    set.set_world("w");
    set.set_generation(7);
    set.set_island(2);
    set.set_first_organism(3);
    set.add_fitness(1.5);
    set.add_fitness(-1e100);
    const auto command = rating_of(request);
    ASSERT_TRUE(command) << to_text(command.error());
    const auto& fitness = std::get<simulation::SetFitness>(*command);
    EXPECT_EQ(fitness.world, "w");
    EXPECT_EQ(fitness.generation, 7u);
    EXPECT_EQ(fitness.island, 2u);
    EXPECT_EQ(fitness.first_organism, 3u);
    EXPECT_THAT(fitness.fitness, ElementsAre(1.5, -1e100));
}

TEST(SetFitness, NamesEveryWrongNumber) {
    v1::Request request;
    v1::SetFitness& set = *request.mutable_set_fitness();
    EXPECT_EQ(rating_of(request).error().violations.at(0).field, "set_fitness.fitness");
    for (const double number :
         {0.0, std::numeric_limits<double>::quiet_NaN(), -std::numeric_limits<double>::infinity(), 1.1e100, 5.0}) {
        set.add_fitness(number);
    }
    std::vector<std::string> fields;
    for (const base::Violation& violation : rating_of(request).error().violations) {
        fields.push_back(violation.field + " " + violation.got);
    }
    EXPECT_THAT(fields, ElementsAre("set_fitness.fitness[1] nan", "set_fitness.fitness[2] -inf",
                                    "set_fitness.fitness[3] 1.1e+100"));
}

class AwaitedFitness : public testing::Test {
  protected:
    AwaitedFitness() {
        parameters::Parameters parameters;
        parameters.fitness = parameters::FitnessFunction::External;
        parameters.population_size = 3;
        parameters.island_count = 2;
        parameters.generation_s = 0.1;
        EXPECT_TRUE(laboratory.apply(simulation::CreateWorld{"w", parameters, base::Seed{5}, {}}));
        EXPECT_TRUE(laboratory.apply(simulation::Run{"w", {}}));
    }
    simulation::Entry& entry() { return **laboratory.find("w"); }
    void advance_to_rating() {
        do {
            laboratory.advance(entry(), executor);
        } while (!entry().world.awaits_fitness());
    }

    simulation::Laboratory laboratory;
    base::InlineExecutor executor;
};

TEST_F(AwaitedFitness, IsInTheStateOfTheWorldAndInEvents) {
    EXPECT_FALSE(to_proto(entry()).has_awaited_fitness());
    advance_to_rating();
    const v1::WorldInfo waiting = to_proto(entry());
    EXPECT_EQ(waiting.state(), v1::RUN_STATE_RUNNING);
    EXPECT_EQ(waiting.awaited_fitness().generation(), 1u);
    EXPECT_THAT(waiting.awaited_fitness().islands(), ElementsAre(0, 1));
    const auto events = laboratory.take_events();
    const v1::Event awaited = to_proto(events.back(), laboratory);
    EXPECT_EQ(awaited.fitness_awaited().generation(), 1u);
    EXPECT_THAT(awaited.fitness_awaited().islands(), ElementsAre(0, 1));

    const simulation::SetFitness first{"w", 1, 0, 0, {1, 2, 3}}, second{"w", 1, 1, 0, {1, 2, 3}};
    auto applied = laboratory.apply(first);
    ASSERT_TRUE(applied);
    const auto set = event_of(first, *applied, base::client_actor({}, "alice", "::1:5000"), laboratory);
    ASSERT_TRUE(set);
    EXPECT_EQ(set->fitness_set().organism_count(), 3u);
    EXPECT_THAT(set->fitness_set().awaited_islands(), ElementsAre(1));
    applied = laboratory.apply(second);
    ASSERT_TRUE(applied);
    EXPECT_THAT(event_of(second, *applied, base::client_actor({}, "alice", "::1:5000"), laboratory)
                    ->fitness_set()
                    .awaited_islands(),
                IsEmpty());
    EXPECT_FALSE(to_proto(entry()).has_awaited_fitness());
}

TEST_F(AwaitedFitness, IsFoundFromThePopulationWithItsLife) {
    advance_to_rating();
    v1::GetPopulation query;
    query.set_world("w");
    EXPECT_TRUE(to_proto(*get_population(laboratory, query)).lived_s().empty());
    query.set_with_life(true);
    const v1::Population population = to_proto(*get_population(laboratory, query));
    const simulation::Island& island = entry().world.islands()[0];
    ASSERT_EQ(population.lived_s().size(), 3 * sizeof(double));
    ASSERT_EQ(population.health().size(), 3 * sizeof(float));
    EXPECT_EQ(population.food_eaten().size(), 3 * sizeof(std::uint32_t));
    EXPECT_EQ(population.poison_eaten().size(), 3 * sizeof(std::uint32_t));
    for (std::uint32_t id = 0; id < 3; ++id) {
        const auto life = island.life(id, static_cast<std::uint32_t>(entry().world.moment().generation_tick));
        double lived_s = 0;
        float health = 0;
        std::memcpy(&lived_s, population.lived_s().data() + id * sizeof lived_s, sizeof lived_s);
        std::memcpy(&health, population.health().data() + id * sizeof health, sizeof health);
        EXPECT_EQ(lived_s, life.lived_ticks / 60.0);
        EXPECT_EQ(health, life.health);
    }
}

} // namespace
} // namespace evod::protocol
