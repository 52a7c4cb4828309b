#include "tests/fuzz/script.h"

#include "server/parameters/model_parameters.h"

#include <google/protobuf/descriptor.h>

#include <limits>

namespace evod::fuzz {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::Reflection;

constexpr std::uint64_t numbers[] = {0,
                                     1,
                                     2,
                                     3,
                                     4,
                                     5,
                                     8,
                                     12,
                                     20,
                                     60,
                                     100,
                                     1000,
                                     1 << 16,
                                     1u << 31,
                                     std::numeric_limits<std::uint32_t>::max(),
                                     std::numeric_limits<std::uint64_t>::max()};
constexpr double reals[] = {0,
                            0.001,
                            0.01,
                            0.1,
                            0.25,
                            0.5,
                            1,
                            2,
                            10,
                            60,
                            120,
                            200,
                            1000,
                            10'000,
                            -1,
                            1e300,
                            std::numeric_limits<double>::infinity(),
                            std::numeric_limits<double>::quiet_NaN()};
const std::string texts[] = {
    "default", "a", "b", "", "default@1", "no such", std::string(65, 'x'), "life", "k1", "rastrigin", "generational"};

std::string text_for(const FieldDescriptor& field, Script& script) {
    if (field.containing_type()->name() != "ParameterAssignment") {
        return script.one_of(texts);
    }
    const auto parameters = parameters::parameter_registry();
    const std::size_t wanted = script.take() % (parameters.size() + 1);
    return wanted < parameters.size() ? std::string{parameters[wanted].name} : "none";
}

/// Adds an element to a repeated field.
void fill(Message& message, const FieldDescriptor& field, Script& script) {
    const Reflection& reflection = *message.GetReflection();
    const auto put = [&](auto set, auto add, auto value) {
        field.is_repeated() ? (reflection.*add)(&message, &field, value) : (reflection.*set)(&message, &field, value);
    };
    switch (field.cpp_type()) {
    case FieldDescriptor::CPPTYPE_INT32:
    case FieldDescriptor::CPPTYPE_INT64:
        break; // none exist
    case FieldDescriptor::CPPTYPE_UINT32:
        return put(&Reflection::SetUInt32, &Reflection::AddUInt32, static_cast<std::uint32_t>(script.one_of(numbers)));
    case FieldDescriptor::CPPTYPE_UINT64:
        return put(&Reflection::SetUInt64, &Reflection::AddUInt64, script.one_of(numbers));
    case FieldDescriptor::CPPTYPE_DOUBLE:
        return put(&Reflection::SetDouble, &Reflection::AddDouble, script.one_of(reals));
    case FieldDescriptor::CPPTYPE_FLOAT:
        return put(&Reflection::SetFloat, &Reflection::AddFloat, static_cast<float>(script.take()));
    case FieldDescriptor::CPPTYPE_BOOL:
        return put(&Reflection::SetBool, &Reflection::AddBool, script.take() % 2 == 0);
    case FieldDescriptor::CPPTYPE_ENUM: // with one undefined value
        return put(&Reflection::SetEnumValue, &Reflection::AddEnumValue,
                   script.take() % (field.enum_type()->value_count() + 1));
    case FieldDescriptor::CPPTYPE_STRING:
        return put(&Reflection::SetString, &Reflection::AddString, text_for(field, script));
    case FieldDescriptor::CPPTYPE_MESSAGE:
        return fill(field.is_repeated() ? *reflection.AddMessage(&message, &field)
                                        : *reflection.MutableMessage(&message, &field),
                    script);
    }
}

} // namespace

void fill(Message& message, Script& script) {
    const google::protobuf::Descriptor& type = *message.GetDescriptor();
    for (int i = 0; i < type.real_oneof_decl_count(); ++i) {
        const auto& choice = *type.oneof_decl(i);
        const int chosen = script.take() % (choice.field_count() + 1);
        if (chosen < choice.field_count()) {
            fill(message, *choice.field(chosen), script);
        }
    }
    for (int i = 0; i < type.field_count(); ++i) {
        const FieldDescriptor& field = *type.field(i);
        if (field.real_containing_oneof() != nullptr) {
            continue;
        }
        for (int count = script.take() % (field.is_repeated() ? 4 : 2); count > 0; --count) {
            fill(message, field, script);
        }
    }
}

} // namespace evod::fuzz
