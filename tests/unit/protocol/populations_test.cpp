#include "server/protocol/populations.h"

#include "server/protocol/commands.h"
#include "server/protocol/refusals.h"
#include "tests/unit/protocol/messages.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

namespace evod::protocol {
namespace {

TEST(Populations, RefuseAPopulationThatDoesNotFitTheWorld) {
    v1::Request request;
    request.set_client_key("k");
    auto& create = *request.mutable_create_world();
    create.set_name("w");
    auto& size = *create.add_parameters();
    size.set_name("population_size");
    size.mutable_value()->set_count(2);
    auto& genes = *create.add_population()->mutable_genes();
    const auto fields = [&] {
        std::vector<std::string> found;
        const auto command = to_command(request, draws);
        if (!command) {
            for (const auto& violation : command.error().violations) {
                found.push_back(to_text(violation));
            }
        }
        return found;
    };
    for (int i = 0; i < 11; ++i) {
        genes.Add(100 + static_cast<float>(i) / 8);
    }
    EXPECT_THAT(fields(),
                testing::ElementsAre("create_world.population[0].genes: got 11, allowed a multiple of 6 numbers"));
    genes.Add(100);
    EXPECT_THAT(fields(), testing::IsEmpty());
    const auto population = std::get<simulation::CreateWorld>(*to_command(request, draws)).first_population;
    ASSERT_EQ(population->size(), 1u);
    EXPECT_EQ(population->front()(3, 0), 100.375f);
    EXPECT_EQ(population->front()(0, 1), 100.75f);
    v1::CreateWorld again;
    add_population(again, population);
    EXPECT_EQ(again.population(0).SerializeAsString(), create.population(0).SerializeAsString());

    create.add_population_gene_names("normal_speed");
    create.add_population_gene_names("turn");
    EXPECT_THAT(fields(), testing::ElementsAre("create_world.population_gene_names[1]: got the gene turn, allowed the "
                                               "gene impulse"));
    create.mutable_population_gene_names()->RemoveLast();
    EXPECT_THAT(fields(), testing::ElementsAre("create_world.population_gene_names[1]: got no gene, allowed the gene "
                                               "impulse"));
    create.clear_population_gene_names();
    for (const std::string_view name : evolution::body_gene_names) {
        create.add_population_gene_names(std::string{name});
    }
    EXPECT_THAT(fields(), testing::IsEmpty());
    create.add_population_gene_names("free0");
    EXPECT_THAT(fields(), testing::ElementsAre("create_world.population_gene_names[6]: got the gene free0, allowed no "
                                               "gene"));
    create.clear_population_gene_names();

    genes.Set(8, 300);
    genes.Set(11, std::numeric_limits<float>::quiet_NaN());
    EXPECT_THAT(fields(),
                testing::ElementsAre("create_world.population[0].organism[1].body_size: got 300, allowed 40 to "
                                     "200 (body_size_min, body_size_max)",
                                     "create_world.population[0].organism[1].poison_radius: got nan, allowed "
                                     "20 to 200 (poison_radius_min, poison_radius_max)"));
    genes.Truncate(6);
    create.add_population();
    EXPECT_THAT(fields(), testing::ElementsAre(
                              "create_world.population: got 2 islands, allowed 1 island (island_count)",
                              "create_world.population[0]: got 1 organism, allowed 2 organisms (population_size)",
                              "create_world.population[1]: got 0 organisms, allowed 2 organisms (population_size)"));
    create.mutable_population()->RemoveLast();
    create.set_seed(5);
    EXPECT_THAT(fields(), testing::IsEmpty());
    const auto filled = std::get<simulation::CreateWorld>(*to_command(request, draws)).first_population;
    ASSERT_EQ(filled->front().cols(), 2);
    const auto drawn = evolution::initial_population(2, parameters::Parameters{}, {5}, 0);
    EXPECT_TRUE((filled->front().col(1) == drawn.col(1)).all());
}

} // namespace
} // namespace evod::protocol
