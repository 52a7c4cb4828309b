#include "client/core/number_check.h"

#include "evod/v1/commands.pb.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/reflection.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace evod::core {

namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;

/// Widgets compute with the difference of two limits, so half of the largest number is the most that they can use.
constexpr double limit_max = std::numeric_limits<double>::max() / 2;

/// The sum of three counts is the end of a slider, which must be less than 2^30.
constexpr std::uint32_t count_max = 1U << 28;

/// Whether all numbers of a field are allowed. True for fields of other types.
template <class IsAllowed>
bool are_allowed(const Message& message, const FieldDescriptor& field, const IsAllowed& is_allowed) {
    const google::protobuf::Reflection& reflection = *message.GetReflection();
    const auto all_allowed = [&](const auto& values) { return std::all_of(values.begin(), values.end(), is_allowed); };
    switch (field.cpp_type()) {
    case FieldDescriptor::CPPTYPE_DOUBLE:
        return field.is_repeated() ? all_allowed(reflection.GetRepeatedFieldRef<double>(message, &field))
                                   : is_allowed(reflection.GetDouble(message, &field));
    case FieldDescriptor::CPPTYPE_FLOAT:
        return field.is_repeated() ? all_allowed(reflection.GetRepeatedFieldRef<float>(message, &field))
                                   : is_allowed(reflection.GetFloat(message, &field));
    case FieldDescriptor::CPPTYPE_UINT32:
        return field.is_repeated() || !field.name().ends_with("_count") ||
               reflection.GetUInt32(message, &field) <= count_max;
    default:
        return true;
    }
}

} // namespace

std::string field_without_number(const Message& message) {
    const google::protobuf::Reflection& reflection = *message.GetReflection();
    if (message.GetDescriptor() == evod::v1::Metrics::descriptor()) {
        return "";
    }
    const bool is_limit = message.GetDescriptor() == evod::v1::ParameterDescription::descriptor();
    const auto is_allowed = [is_limit](double value) {
        return is_limit ? std::abs(value) <= limit_max : !std::isnan(value); // the first is false for NaN, too
    };
    std::vector<const FieldDescriptor*> fields;
    reflection.ListFields(message, &fields);
    for (const FieldDescriptor* field : fields) {
        if (!are_allowed(message, *field, is_allowed)) {
            return field->full_name();
        }
        if (field->cpp_type() != FieldDescriptor::CPPTYPE_MESSAGE) {
            continue;
        }
        const int count = field->is_repeated() ? reflection.FieldSize(message, field) : 1;
        for (int i = 0; i < count; ++i) {
            const Message& inner = field->is_repeated() ? reflection.GetRepeatedMessage(message, field, i)
                                                        : reflection.GetMessage(message, field);
            if (std::string found = field_without_number(inner); !found.empty()) {
                return found;
            }
        }
    }
    return "";
}

} // namespace evod::core
