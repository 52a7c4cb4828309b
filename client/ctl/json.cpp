#include "client/ctl/json.h"

#include "client/ctl/stop.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/util/json_util.h>

#include <charconv>
#include <cstdint>
#include <string_view>
#include <vector>

namespace evod::ctl {
namespace {

/// Replaces strings by numbers where the field is a 64-bit integer and the value is below 2^53. Protobuf writes every
/// 64-bit integer as a string.
///
/// of  the descriptor of the message that `json` contains.
std::string with_numbers(std::string_view json, const google::protobuf::Descriptor& of) {
    using google::protobuf::FieldDescriptor;
    struct Level {
        const google::protobuf::Descriptor* of;
        const FieldDescriptor* in; // the field that contains this object or array
    };
    std::vector<Level> levels;
    const FieldDescriptor* field = nullptr; // the field of the next value
    std::string text;
    for (std::size_t i = 0; i < json.size(); ++i) {
        if (json[i] == '{') {
            levels.push_back({field != nullptr ? field->message_type() : &of, field});
        } else if (json[i] == '}') {
            field = levels.back().in;
            levels.pop_back();
        }
        if (json[i] != '"') {
            text += json[i];
            continue;
        }
        std::size_t end = i + 1;
        while (json[end] != '"') {
            end += json[end] == '\\' ? 2 : 1;
        }
        const std::string_view word = json.substr(i + 1, end - i - 1);
        if (json.substr(end + 1).starts_with(':')) {
            field = levels.back().of->FindFieldByName(std::string{word});
        }
        const bool is_long = field != nullptr && !json.substr(end + 1).starts_with(':') &&
                             (field->cpp_type() == FieldDescriptor::CPPTYPE_INT64 ||
                              field->cpp_type() == FieldDescriptor::CPPTYPE_UINT64);
        std::int64_t value = 0;
        constexpr std::int64_t exact_max = (std::int64_t{1} << 53) - 1;
        const bool fits = is_long && std::from_chars(word.data(), word.data() + word.size(), value).ec == std::errc{} &&
                          value >= -exact_max && value <= exact_max;
        text += fits ? word : json.substr(i, end + 1 - i);
        i = end;
    }
    return text;
}

} // namespace

std::string to_json(const google::protobuf::Message& message, bool many_lines) {
    google::protobuf::util::JsonPrintOptions options;
    options.preserve_proto_field_names = true;
    options.always_print_primitive_fields = true;
    options.add_whitespace = many_lines;
    std::string text;
    if (const auto status = google::protobuf::util::MessageToJsonString(message, &text, options); !status.ok()) {
        throw Stop{ExitCode::Refused, "the reply cannot be written as JSON: " + std::string{status.message()}};
    }
    if (!text.ends_with('\n')) {
        text += '\n';
    }
    return with_numbers(text, *message.GetDescriptor());
}

} // namespace evod::ctl
