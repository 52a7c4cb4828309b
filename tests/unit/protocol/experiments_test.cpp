#include "server/protocol/experiments.h"

#include <gmock/gmock.h>

namespace evod::protocol {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

void set_chance(v1::CreateWorld& request, double value) {
    auto& assignment = *request.add_parameters();
    assignment.set_name("mutation_chance");
    assignment.mutable_value()->set_real(value);
}

std::vector<std::string> fields_of(const v1::CreateWorld& request) {
    std::vector<base::Violation> violations;
    experiment_of(request, violations);
    std::vector<std::string> fields;
    for (const base::Violation& violation : violations) {
        fields.push_back(violation.field);
    }
    return fields;
}

TEST(ExperimentOfRequest, IsTheTextOfAFile) {
    v1::CreateWorld request;
    request.set_experiment_json(R"({"seed": 7, "food_count": 3, "mutation_chance": {"1": 0.2, "30": 0.05}})");
    std::vector<base::Violation> violations;
    const auto experiment = experiment_of(request, violations);
    EXPECT_TRUE(violations.empty());
    EXPECT_EQ(experiment.seed, base::Seed{7});
    EXPECT_EQ(experiment.parameters.food_count, 3u);
    EXPECT_TRUE(experiment.schedule.holds("mutation_chance"));
}

TEST(ExperimentOfRequest, ParametersChangeTheFileForAllGenerations) {
    v1::CreateWorld request;
    request.set_experiment_json(R"({"food_count": 3, "mutation_chance": {"1": 0.2, "30": 0.05}})");
    set_chance(request, 0.5);
    std::vector<base::Violation> violations;
    const auto experiment = experiment_of(request, violations);
    EXPECT_TRUE(violations.empty());
    EXPECT_EQ(experiment.parameters.mutation_chance, 0.5);
    EXPECT_EQ(experiment.parameters.food_count, 3u);
    EXPECT_TRUE(experiment.schedule.empty());
}

TEST(ExperimentOfRequest, ErrorsNameTheLineOfTheFile) {
    v1::CreateWorld request;
    request.set_experiment_json("{\n\"food_count\": -3,\n\"mutation_chance\": {\"4\": 2}}");
    EXPECT_THAT(fields_of(request), ElementsAre("create_world.experiment_json.mutation_chance at generation 4 (line 3)",
                                                "create_world.experiment_json.food_count (line 2)"));
    request.set_experiment_json("{\n1}");
    EXPECT_THAT(fields_of(request), ElementsAre("create_world.experiment_json"));
    request.set_experiment_json("{}");
    set_chance(request, 2);
    EXPECT_THAT(fields_of(request), ElementsAre("create_world.mutation_chance"));
}

TEST(ExperimentOfRequest, AScheduleBesideTheFileIsRefused) {
    v1::CreateWorld request;
    request.set_experiment_json("{}");
    request.add_schedule()->set_name("mutation_chance");
    EXPECT_THAT(fields_of(request), ElementsAre("create_world.schedule"));
}

TEST(ExperimentOfRequest, AChangeMustFitTheScheduleOfTheFile) {
    v1::CreateWorld request;
    request.set_experiment_json(R"({"tournament_size": 5, "tournament_winners": {"5": 4}})");
    auto& assignment = *request.add_parameters();
    assignment.set_name("tournament_size");
    assignment.mutable_value()->set_count(3);
    EXPECT_THAT(fields_of(request), ElementsAre(HasSubstr("at generation 5")));
}

} // namespace
} // namespace evod::protocol
