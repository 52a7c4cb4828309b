// Helpers of the protocol tests: they walk the fields of a message by reflection, so a field added later is tested too.
#pragma once

#include "server/base/inline_executor.h"
#include "server/protocol/commands.h"
#include "server/simulation/laboratory.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>
#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

namespace evod::protocol {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;

inline const Draws draws{.seed = base::Seed{1}, .run_id = {2, 3}};

/// Paths of the fields without a value in `message` and its sub-messages.
inline void find_unset(const Message& message, const std::string& path, std::set<std::string>& unset) {
    const auto& reflection = *message.GetReflection();
    for (int i = 0; i < message.GetDescriptor()->field_count(); ++i) {
        const FieldDescriptor& field = *message.GetDescriptor()->field(i);
        const std::string name = path + field.name();
        if (field.is_repeated() ? reflection.FieldSize(message, &field) == 0 : !reflection.HasField(message, &field)) {
            unset.insert(name);
        } else if (field.cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE) {
            find_unset(field.is_repeated() ? reflection.GetRepeatedMessage(message, &field, 0)
                                           : reflection.GetMessage(message, &field),
                       name + ".", unset);
        }
    }
}

inline std::set<std::string> unset_in(const Message& message) {
    std::set<std::string> unset;
    find_unset(message, "", unset);
    return unset;
}

/// Every number in a message, at any depth.
inline void collect_numbers(const Message& message, std::vector<double>& numbers) {
    const auto& reflection = *message.GetReflection();
    std::vector<const FieldDescriptor*> fields;
    reflection.ListFields(message, &fields);
    for (const FieldDescriptor* field : fields) {
        if (field->cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE) {
            if (field->is_repeated()) {
                for (int i = 0; i < reflection.FieldSize(message, field); ++i) {
                    collect_numbers(reflection.GetRepeatedMessage(message, field, i), numbers);
                }
            } else {
                collect_numbers(reflection.GetMessage(message, field), numbers);
            }
        } else if (field->cpp_type() == FieldDescriptor::CPPTYPE_DOUBLE) {
            numbers.push_back(reflection.GetDouble(message, field));
        } else if (field->cpp_type() == FieldDescriptor::CPPTYPE_UINT64) {
            numbers.push_back(static_cast<double>(reflection.GetUInt64(message, field)));
        } else if (field->cpp_type() == FieldDescriptor::CPPTYPE_UINT32) {
            numbers.push_back(reflection.GetUInt32(message, field));
        }
    }
}

/// A world with three islands that has simulated two generations.
class Lived : public testing::Test {
  protected:
    Lived() {
        simulation::CreateWorld create{.name = "w", .parameters = {}, .seed = base::Seed{5}, .run_id = {1, 2}};
        create.parameters.island_count = 3;
        create.parameters.generation_s = 0.5;
        EXPECT_TRUE(laboratory.apply(create));
        EXPECT_TRUE(laboratory.apply(simulation::Run{"w", 100}));
        EXPECT_TRUE(laboratory.apply(simulation::RunUntilTick{"w", 1000}));
        for (int tick = 0; tick < 45; ++tick) {
            laboratory.advance(entry(), executor);
        }
    }
    simulation::Entry& entry() { return **laboratory.find("w"); }

    base::InlineExecutor executor;
    simulation::Laboratory laboratory;
};

} // namespace evod::protocol
