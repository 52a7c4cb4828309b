#include "server/protocol/queries.h"

#include "tests/unit/protocol/messages.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>

namespace evod::protocol {
namespace {

class Queries : public Lived {
  protected:
    v1::Response answer(const v1::Request& request, bool users_only = false) {
        v1::Response response;
        add_rows(answer_query(request, laboratory, users_only, response), response);
        return response;
    }
};

TEST_F(Queries, AreAnsweredWithTheFieldOfTheirRules) {
    v1::Request request;
    request.mutable_list_worlds();
    EXPECT_EQ(answer(request).worlds().worlds(0).name(), "w");
    request.mutable_get_parameters();
    EXPECT_TRUE(answer(request).has_parameters());
    request.mutable_get_statistics();
    EXPECT_TRUE(answer(request).has_statistics());
    request.mutable_get_organism();
    EXPECT_TRUE(answer(request).has_organism());
    request.mutable_get_motion();
    EXPECT_EQ(answer(request).motion().tick(), laboratory.find("w").value()->world.moment().tick);
    EXPECT_EQ(answer(request).motion().generation_tick(), laboratory.find("w").value()->world.moment().generation_tick);
}

TEST_F(Queries, OfWorldsListDamagedOnesWithTheirReason) {
    laboratory.adopt({.name = "z", .run_id = {}, .reason = "z.evod is empty"});
    laboratory.adopt({.name = "broken", .run_id = simulation::RunId{1, 2}, .reason = "broken.evod is damaged"});
    v1::Request request;
    request.mutable_list_worlds();
    const v1::WorldList list = answer(request).worlds();
    EXPECT_EQ(list.worlds_size(), 1);
    ASSERT_EQ(list.damaged_size(), 2);
    EXPECT_EQ(list.damaged(0).name(), "broken");
    EXPECT_EQ(list.damaged(0).run_id(), to_text(simulation::RunId{1, 2}));
    EXPECT_EQ(list.damaged(0).reason(), "broken.evod is damaged");
    EXPECT_EQ(list.damaged(1).run_id(), "");
    request.mutable_get_statistics()->set_world("broken");
    EXPECT_EQ(answer(request).status().reason(), v1::REASON_WORLD_DAMAGED);
}

TEST_F(Queries, WithRowsAreConvertedLater) {
    v1::Request request;
    request.mutable_get_population()->set_first_organism(1);
    v1::Response response;
    const QueryResult rows = answer_query(request, laboratory, false, response);
    EXPECT_EQ(response.answer_case(), v1::Response::ANSWER_NOT_SET);
    EXPECT_EQ(std::get<PopulationRows>(rows).first, 1);
    add_rows(rows, response);
    EXPECT_EQ(response.population().first(), 1);
    EXPECT_GT(row_bytes(rows), 0u);
    request.mutable_get_history();
    EXPECT_EQ(answer(request).history().generations_size(), 3) << "one finished generation on three islands";
    request.mutable_list_worlds();
    EXPECT_EQ(row_bytes(answer_query(request, laboratory, false, response)), 0u);
}

TEST_F(Queries, OfAPopulationContainTheFitnessIfItIsKnown) {
    v1::Request request;
    request.mutable_get_population()->set_world("w");
    EXPECT_EQ(answer(request).population().objectives(), "") << "organisms still live";
    const auto numbers_of = [&](const std::string& world) {
        request.mutable_get_population()->set_world(world);
        request.mutable_get_population()->set_first_organism(3);
        const std::string bytes = answer(request).population().objectives();
        std::vector<double> numbers(bytes.size() / sizeof(double));
        std::memcpy(numbers.data(), bytes.data(), bytes.size());
        return numbers;
    };
    simulation::CreateWorld create{.name = "sum", .parameters = {}, .seed = base::Seed{5}, .run_id = {1, 3}};
    create.parameters.population_size = 5;
    create.parameters.fitness = parameters::FitnessFunction::GeneSum;
    EXPECT_TRUE(laboratory.apply(create));
    const auto& genes = (*laboratory.find("sum"))->world.island(0).born().genes;
    EXPECT_THAT(numbers_of("sum"),
                testing::ElementsAre(genes.col(3).cast<double>().sum(), genes.col(4).cast<double>().sum()));
    create.name = "given";
    create.parameters.fitness = parameters::FitnessFunction::External;
    create.parameters.external_bodies = false;
    EXPECT_TRUE(laboratory.apply(create));
    EXPECT_TRUE(laboratory.apply(simulation::Run{"given", 1}));
    laboratory.advance(**laboratory.find("given"), executor);
    EXPECT_TRUE(numbers_of("given").empty()) << "not rated yet";
    EXPECT_TRUE(laboratory.apply(
        simulation::SetFitness{.world = "given", .generation = 1, .island = 0, .fitness = {1, 2, 3, 4, 5}}));
    EXPECT_THAT(numbers_of("given"), testing::ElementsAre(4, 5));
}

TEST_F(Queries, OfAHistoryListTheChangesOfParameters) {
    const std::vector<parameters::Assignment> assignments{{"mutation_chance", 0.5}, {"food_count", 7u}};
    ASSERT_TRUE(laboratory.apply(simulation::SetParameters{
        "w", assignments, false, {}, {}, base::client_actor("alice", "evoctl", "127.0.0.1:5")}));
    v1::Request request;
    request.mutable_get_history();
    const v1::History history = answer(request).history();
    ASSERT_EQ(history.changes_size(), 1);
    const v1::AppliedChange& change = history.changes(0);
    EXPECT_EQ(change.by().user(), "alice");
    EXPECT_EQ(change.by().client(), "evoctl");
    ASSERT_EQ(change.values_size(), 2);
    EXPECT_EQ(change.values(0).name(), "food_count");
    EXPECT_EQ(change.values(0).after().count(), 7u);
    EXPECT_EQ(change.values(1).after().real(), 0.5);

    v1::Response response;
    add_rows(answer_query(request, laboratory, true, response), response);
    EXPECT_EQ(response.history().changes(0).by().user(), "alice");
    EXPECT_EQ(response.history().changes(0).by().client(), "") << "a viewer sees only the user";

    request.mutable_get_history()->set_first_generation(change.generation() + 1);
    EXPECT_EQ(answer(request).history().changes_size(), 0);
    request.mutable_get_history()->set_first_generation(change.generation());
    EXPECT_EQ(answer(request).history().changes_size(), 1);
    request.mutable_get_history()->clear_first_generation();
    request.mutable_get_history()->set_last_generation(change.generation() - 1);
    EXPECT_EQ(answer(request).history().changes_size(), 0);
}

TEST_F(Queries, ObserveComputesItsExpressionsLater) {
    v1::Request request;
    request.mutable_observe()->set_world("w");
    for (const char* expression : {"generation[-1]", "fitness_mean[2]", "island@max[1] + 1"}) {
        request.mutable_observe()->add_expressions(expression);
    }
    const v1::Observations observed = answer(request).observations();
    ASSERT_EQ(observed.observations_size(), 3);
    EXPECT_EQ(observed.observations(0).value(), 1);
    EXPECT_FALSE(observed.observations(1).has_value()) << "one finished generation";
    EXPECT_EQ(observed.observations(2).value(), 3) << "three islands";

    request.mutable_observe()->set_expressions(1, "fitness_mean[");
    const v1::Status refused = answer(request).status();
    ASSERT_EQ(refused.violations_size(), 1);
    EXPECT_EQ(refused.violations(0).field(), "observe.expressions[1]");
    request.mutable_observe()->set_world("other");
    EXPECT_EQ(answer(request).status().reason(), v1::REASON_WORLD_NOT_FOUND);
}

TEST_F(Queries, ThatReadTooManyNumbersAreRefused) {
    const ObservedHistory observed{
        .observations = {*simulation::Observation::parse("sum(generation)",
                                                         simulation::ObservedColumns{parameters::Parameters{}}, "")},
        .history = {simulation::GenerationRows{std::vector<simulation::GenerationStatistics>(1)}},
        .parameters = {}};
    EXPECT_EQ(to_proto(observed)->observations_size(), 1);
    ObservedHistory many = observed;
    many.history.resize(2'000'000, many.history.front());
    EXPECT_EQ(to_proto(many).error().violations[0].field, "observe.expressions");
}

TEST_F(Queries, ThatFailNameTheirField) {
    v1::Request request;
    request.mutable_get_organism()->set_island(9);
    const v1::Response response = answer(request);
    EXPECT_EQ(response.status().code(), v1::CODE_NOT_FOUND);
    EXPECT_EQ(response.status().violations(0).field(), "get_organism.island");
    EXPECT_EQ(response.answer_case(), v1::Response::ANSWER_NOT_SET);
}

TEST_F(Queries, OfSubscriptionsAndLeasesFindTheirWorld) {
    v1::Request request;
    v1::Response response;
    const auto found = [&] { return std::get<FoundWorld>(answer_query(request, laboratory, false, response)); };
    request.mutable_subscribe_snapshots()->set_island(2);
    EXPECT_EQ(found().name, "w") << "the only world";
    EXPECT_EQ(found().island_count, 3u);
    request.mutable_renew_lease()->set_world("w");
    EXPECT_EQ(found().name, "w");
    request.mutable_subscribe_events()->set_world("w");
    EXPECT_EQ(found().name, "w");
    request.mutable_subscribe_events()->clear_world();
    EXPECT_EQ(found().name, "") << "all worlds";
    EXPECT_FALSE(response.has_status());
    request.mutable_subscribe_snapshots()->set_island(3);
    EXPECT_EQ(answer(request).status().violations(0).field(), "subscribe_snapshots.island");
    request.mutable_renew_lease()->set_world("other");
    EXPECT_EQ(answer(request).status().code(), v1::CODE_NOT_FOUND);
}

TEST_F(Queries, OfAViewerShowNoProgramsOfOthers) {
    ASSERT_TRUE(laboratory.apply(
        simulation::SetParameters{.world = "w",
                                  .assignments = {{"mutation_chance", parameters::ParameterValue{0.5}}},
                                  .dry_run = false,
                                  .expected_revision = {},
                                  .at = parameters::PlannedMoment{.generation = 90, .tick = {}},
                                  .by = base::client_actor("anna", "evoctl", "127.0.0.1:5000")}));
    v1::Request request;
    request.mutable_get_parameters();
    EXPECT_EQ(answer(request).parameters().planned(0).by().client(), "evoctl");
    EXPECT_EQ(answer(request, true).parameters().planned(0).by().client(), "");
    EXPECT_EQ(answer(request, true).parameters().planned(0).by().user(), "anna");
}

} // namespace
} // namespace evod::protocol
