#include "server/protocol/commands.h"

#include "server/protocol/parameters.h"
#include "server/protocol/refusals.h"
#include "server/protocol/request_rules.h"
#include "tests/unit/protocol/messages.h"

#include <gmock/gmock.h>
#include <google/protobuf/descriptor.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

namespace evod::protocol {
namespace {

TEST(Requests, ACommandNeedsAClientKey) {
    const auto& requests = *v1::Request::descriptor()->FindOneofByName("kind");
    for (int i = 0; i < requests.field_count(); ++i) {
        v1::Request request;
        request.GetReflection()->MutableMessage(&request, requests.field(i));
        if (kind_of(request) == v1::REQUEST_KIND_COMMAND) {
            const auto command = to_command(request, draws);
            ASSERT_FALSE(command) << "it has no client_key";
            EXPECT_EQ(command.error().violations.front().field, "client_key");
        }
    }
}

/// Sets every double of a request to `poison`, one at a time, and expects a refusal that names it.
void poison_doubles(v1::Request& request, Message& part, double poison, int& poisoned) {
    const auto& reflection = *part.GetReflection();
    for (int i = 0; i < part.GetDescriptor()->field_count(); ++i) {
        const FieldDescriptor& field = *part.GetDescriptor()->field(i);
        if (field.cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE) {
            Message& inner =
                field.is_repeated() ? *reflection.AddMessage(&part, &field) : *reflection.MutableMessage(&part, &field);
            if (inner.GetDescriptor()->name() == "ParameterAssignment") {
                static_cast<v1::ParameterAssignment&>(inner).set_name("mutation_chance");
            }
            if (auto* scheduled = dynamic_cast<v1::ScheduledValue*>(&inner)) {
                scheduled->set_name("mutation_chance");
                scheduled->set_generation(2);
            }
            poison_doubles(request, inner, poison, poisoned);
            reflection.ClearField(&part, &field);
        } else if (field.cpp_type() == FieldDescriptor::CPPTYPE_DOUBLE) {
            field.is_repeated() ? reflection.AddDouble(&part, &field, poison)
                                : reflection.SetDouble(&part, &field, poison);
            ++poisoned;
            if (kind_of(request) == v1::REQUEST_KIND_COMMAND) {
                auto command = to_command(request, draws);
                if (command) { // then the world must refuse it
                    simulation::Laboratory laboratory;
                    ASSERT_TRUE(laboratory.apply(simulation::CreateWorld{"w", {}, {}, {}}));
                    const auto applied = laboratory.apply(*command);
                    ASSERT_FALSE(applied) << request.ShortDebugString();
                    EXPECT_THAT(applied.error().violations, testing::Not(testing::IsEmpty()));
                }
            } else {
                EXPECT_THAT(faults_of(request), testing::Contains(testing::Field(
                                                    &base::Violation::field, testing::EndsWith("." + field.name()))))
                    << request.ShortDebugString();
            }
            reflection.ClearField(&part, &field);
        }
    }
}
TEST(Requests, RefuseNanAndInfinityInEveryNumber) {
    const auto& requests = *v1::Request::descriptor()->FindOneofByName("kind");
    int poisoned = 0;
    for (const double poison : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
                                -std::numeric_limits<double>::infinity()}) {
        for (int i = 0; i < requests.field_count(); ++i) {
            v1::Request request;
            request.set_client_key("k");
            auto& part = *request.GetReflection()->MutableMessage(&request, requests.field(i));
            if (kind_of(request) == v1::REQUEST_KIND_CLASS) {
                continue; // class_requests_test.cpp
            }
            if (request.has_create_world()) {
                request.mutable_create_world()->set_name("new");
            }
            poison_doubles(request, part, poison, poisoned);
        }
    }
    // Three lists of parameters, a schedule, two speeds, a rate, two regions, two positions, a fitness; four numbers of
    // a gene in each of three lists.
    EXPECT_EQ(poisoned, 3 * 32);
}

TEST(Requests, NameAllFaultsAtOnce) {
    v1::Request request;
    auto& create = *request.mutable_create_world();
    create.set_name("no good");
    create.add_parameters()->set_name("food_count"); // no value
    auto& wrong = *create.add_parameters();
    wrong.set_name("mutation_chance");
    wrong.mutable_value()->set_real(2);
    const auto command = to_command(request, draws);
    ASSERT_FALSE(command);
    std::vector<std::string> fields;
    for (const auto& violation : command.error().violations) {
        fields.push_back(violation.field);
    }
    EXPECT_THAT(fields, testing::UnorderedElementsAre("client_key", "create_world.name", "create_world.food_count",
                                                      "create_world.mutation_chance"));
}

TEST(Requests, DrawAnAbsentSeedAndKeepZero) {
    v1::Request request;
    request.set_client_key("k");
    request.mutable_create_world()->set_name("w");
    EXPECT_EQ(std::get<simulation::CreateWorld>(*to_command(request, draws)).seed, draws.seed);
    EXPECT_EQ(std::get<simulation::CreateWorld>(*to_command(request, draws)).run_id, draws.run_id);
    request.mutable_create_world()->set_seed(0);
    EXPECT_EQ(std::get<simulation::CreateWorld>(*to_command(request, draws)).seed, base::Seed{0});
    request.mutable_reset_world()->set_world("w");
    EXPECT_FALSE(std::get<simulation::ResetWorld>(*to_command(request, draws)).seed);
    request.mutable_set_parameters();
    EXPECT_FALSE(std::get<simulation::SetParameters>(*to_command(request, draws)).expected_revision);
    request.mutable_set_parameters()->set_expected_revision(0);
    EXPECT_EQ(std::get<simulation::SetParameters>(*to_command(request, draws)).expected_revision, 0);
}

TEST(Requests, ThatDestroyMustNameTheirWorld) {
    v1::Request request;
    request.set_client_key("k");
    request.mutable_reset_world();
    const auto reset = to_command(request, draws);
    ASSERT_FALSE(reset);
    EXPECT_EQ(reset.error().violations.at(0).field, "reset_world.world");
    request.mutable_delete_world();
    const auto deleted = to_command(request, draws);
    ASSERT_FALSE(deleted);
    EXPECT_EQ(deleted.error().violations.at(0).field, "delete_world.world");
}

TEST(Requests, NameTheirFirstUnknownFieldAtAnyDepth) {
    v1::Request request;
    v1::ParameterAssignment& assignment = *request.mutable_set_parameters()->add_parameters();
    assignment.mutable_value()->set_real(1);
    EXPECT_EQ(unknown_field_of(request), std::nullopt);
    assignment.GetReflection()->MutableUnknownFields(&assignment)->AddVarint(99, 1);
    EXPECT_EQ(unknown_field_of(request), "set_parameters.parameters.99");
    request.GetReflection()->MutableUnknownFields(&request)->AddVarint(200, 1);
    EXPECT_EQ(unknown_field_of(request), "200");
}

} // namespace
} // namespace evod::protocol
