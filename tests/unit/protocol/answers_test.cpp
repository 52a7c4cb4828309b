#include "server/protocol/answers.h"

#include "evod/v1/session.pb.h"
#include "proto/codec/framing.h"

#include <gtest/gtest.h>

namespace evod::protocol {
namespace {

class Answers : public testing::Test {
  protected:
    Answers() { EXPECT_TRUE(laboratory.apply(simulation::CreateWorld{"w", {}, {}, {}})); }

    v1::Response answer_to(const simulation::Command& command, const std::string& name) {
        return answer_of(7, name, laboratory, laboratory.apply(command));
    }

    simulation::Laboratory laboratory;
};

TEST_F(Answers, ShowTheWorldAfterRunControl) {
    const v1::Response response = answer_to(simulation::Run{"w", {}}, "run");
    EXPECT_EQ(response.request_id(), 7);
    EXPECT_FALSE(response.has_status());
    EXPECT_EQ(response.world().name(), "w");
    EXPECT_EQ(response.world().state(), v1::RUN_STATE_RUNNING);
}

TEST_F(Answers, ShowTheParametersAfterAChange) {
    const v1::Response response =
        answer_to(simulation::SetParameters{"w", {{"mutation_chance", parameters::ParameterValue{0.25}}}, false, {}},
                  "set_parameters");
    EXPECT_TRUE(response.has_parameters());
    EXPECT_EQ(response.applied_tick(), 0);
}

TEST_F(Answers, WarnAboutAWorldThatSlowsThoseOfClasses) {
    using parameters::ParameterValue;
    ASSERT_TRUE(laboratory.apply(simulation::SetParameters{
        "w",
        {{"population_size", ParameterValue{1'000'000u}}, {"scale_with_population", ParameterValue{true}}},
        false,
        {}}));
    const simulation::Command run = simulation::Run{"w", {}};
    EXPECT_EQ(answer_to(run, "run").warnings_size(), 0) << "the server has no classes";
    simulation::CreateWorld of_member{"bio_ann", {}, {}, {}};
    of_member.ownership = {.user = "bio/ann", .class_name = "bio", .teacher = "kant"};
    ASSERT_TRUE(laboratory.apply(of_member));
    const v1::Response warned = answer_to(run, "run");
    ASSERT_EQ(warned.warnings_size(), 1);
    EXPECT_TRUE(warned.warnings(0).starts_with("a tick of 1,000,000 organisms cannot be interrupted"));
    EXPECT_EQ(answer_to(simulation::Pause{"w"}, "pause").warnings_size(), 0);
    EXPECT_EQ(answer_to(simulation::Run{"bio_ann", {}}, "run").warnings_size(), 0);
}

TEST_F(Answers, WarnAboutSettingsWithoutEvolution) {
    using parameters::ParameterValue;
    const auto warnings_of = [&](const simulation::Command& command, const std::string& name) {
        const v1::Response response = answer_to(command, name);
        EXPECT_FALSE(response.has_status());
        return std::vector<std::string>(response.warnings().begin(), response.warnings().end());
    };
    const std::vector<parameters::Assignment> only_elite{{"elite_count", ParameterValue{std::uint32_t{50}}}};
    const std::vector<std::string> expected{
        "no child is ever bred, because elite_count 50 is not below population_size 50"};
    parameters::Parameters parameters;
    parameters.elite_count = parameters.population_size = 50;
    EXPECT_EQ(warnings_of(simulation::CreateWorld{"elite", parameters, {}, {}}, "create_world"), expected);
    EXPECT_EQ(warnings_of(simulation::ResetWorld{"elite", {}, {}}, "reset_world"), expected);
    EXPECT_TRUE(warnings_of(simulation::Run{"elite", {}}, "run").empty());
    EXPECT_TRUE(warnings_of(simulation::ResetWorld{"w", {}, {}}, "reset_world").empty());
    EXPECT_EQ(warnings_of(simulation::SetParameters{"w", only_elite, true, {}}, "set_parameters"), expected);
    simulation::SetParameters planned{"w", only_elite, false, {}};
    planned.at = parameters::PlannedMoment{.generation = 9, .tick = {}};
    EXPECT_EQ(warnings_of(planned, "set_parameters"), expected);
    EXPECT_EQ(warnings_of(simulation::SetParameters{"w", only_elite, false, {}}, "set_parameters"), expected);
}

TEST_F(Answers, ShowNoWorldAfterItsDeletion) {
    const v1::Response response = answer_to(simulation::DeleteWorld{"w"}, "delete_world");
    EXPECT_FALSE(response.has_status());
    EXPECT_EQ(response.answer_case(), v1::Response::ANSWER_NOT_SET);
}

TEST_F(Answers, NameTheFieldOfARefusedRequest) {
    const v1::Response response =
        answer_to(simulation::SetParameters{"w", {{"mutation_chance", parameters::ParameterValue{1.5}}}, false, {}},
                  "set_parameters");
    ASSERT_EQ(response.status().violations_size(), 1);
    EXPECT_EQ(response.status().violations(0).field(), "set_parameters.mutation_chance");
    EXPECT_FALSE(response.has_applied_tick());
}

TEST_F(Answers, TravelAsOneControlFrame) {
    const v1::Response response = answer_to(simulation::Pause{"w"}, "pause");
    codec::FrameReader reader{codec::client_limits};
    const std::string bytes = frame_of(response);
    reader.feed(std::as_bytes(std::span{bytes}));
    const auto frame = reader.next();
    ASSERT_TRUE(frame && *frame);
    const auto message = codec::parse_body<v1::ServerMessage>((*frame)->body);
    ASSERT_TRUE(message);
    EXPECT_EQ(message->response().SerializeAsString(), response.SerializeAsString());
}

} // namespace
} // namespace evod::protocol
