#include "server/protocol/event_text.h"

#include "proto/text/number_text.h"
#include "server/base/assert.h"

#include <boost/json.hpp>
#include <google/protobuf/descriptor.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <string_view>
#include <vector>

namespace evod::protocol {

extern const char* const event_templates; // the text of proto/texts/events.json

namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;

struct Templates {
    std::map<std::string, std::string, std::less<>> sentences;
    std::map<std::string, std::map<std::string, std::string, std::less<>>, std::less<>> words;
};

const Templates& templates() {
    static const Templates read = [] {
        Templates to;
        const boost::json::value file = boost::json::parse(event_templates);
        for (const auto& [name, value] : file.as_object()) {
            if (const auto* sentence = value.if_string()) {
                to.sentences.emplace(name, *sentence);
                continue;
            }
            for (const auto& [enumerator, word] : value.as_object()) {
                to.words[name].emplace(enumerator, word.as_string());
            }
        }
        return to;
    }();
    return read;
}

/// A text, and whether all values in it are present.
struct Filled {
    std::string text;
    bool present = true;
};

/// One value of a field: that of a field that is not repeated, or an element of one that is.
struct Value {
    const Message* message;
    const FieldDescriptor* field;
    std::optional<int> element;

    const google::protobuf::Reflection& in() const { return *message->GetReflection(); }
    bool present() const { return element || in().HasField(*message, field); }

    const Message& submessage() const {
        return element ? in().GetRepeatedMessage(*message, field, *element) : in().GetMessage(*message, field);
    }

    std::string string() const {
        return element ? in().GetRepeatedString(*message, field, *element) : in().GetString(*message, field);
    }

    std::string enumerator() const {
        return (element ? in().GetRepeatedEnum(*message, field, *element) : in().GetEnum(*message, field))->name();
    }

    std::uint64_t whole() const {
        if (field->cpp_type() == FieldDescriptor::CPPTYPE_UINT32) {
            return element ? in().GetRepeatedUInt32(*message, field, *element) : in().GetUInt32(*message, field);
        }
        EVOD_ASSERT(field->cpp_type() == FieldDescriptor::CPPTYPE_UINT64);
        return element ? in().GetRepeatedUInt64(*message, field, *element) : in().GetUInt64(*message, field);
    }

    double real() const {
        if (field->cpp_type() != FieldDescriptor::CPPTYPE_DOUBLE) {
            return static_cast<double>(whole());
        }
        return element ? in().GetRepeatedDouble(*message, field, *element) : in().GetDouble(*message, field);
    }
};

void add_values(const Message& message, std::string_view path, std::vector<Value>& values) {
    const std::size_t dot = path.find('.');
    const FieldDescriptor* field = message.GetDescriptor()->FindFieldByName(std::string{path.substr(0, dot)});
    EVOD_ASSERT(field != nullptr);
    const auto& reflection = *message.GetReflection();
    const int count = field->is_repeated() ? reflection.FieldSize(message, field) : 1;
    for (int i = 0; i < count; ++i) {
        const Value value{&message, field, field->is_repeated() ? std::optional{i} : std::nullopt};
        if (dot == std::string_view::npos) {
            values.push_back(value);
        } else {
            add_values(value.submessage(), path.substr(dot + 1), values);
        }
    }
}

std::string real_text(double number) {
    return text::number_text(number + 0.0, text::Exponent::IfLong); // + 0.0: -0 becomes 0
}

/// "3 organisms"; without words, only the number.
Filled amount(std::uint64_t number, std::string_view words) {
    std::string text = text::with_separators(number);
    const std::size_t slash = words.find('/');
    if (slash != std::string_view::npos) {
        text += " " + std::string{number == 1 ? words.substr(0, slash) : words.substr(slash + 1)};
    }
    return {std::move(text), number != 0};
}

Filled fill(std::string_view text, const Message& message, const v1::Event& event);

std::string text_of(const Value& value) {
    switch (value.field->cpp_type()) {
    case FieldDescriptor::CPPTYPE_STRING:
        return value.string();
    case FieldDescriptor::CPPTYPE_BOOL:
        return value.in().GetBool(*value.message, value.field) ? "true" : "false";
    default:
        return std::to_string(value.whole());
    }
}

/// The text of one value by a rule that treats each value on its own.
std::string text_of(const Value& value, std::string_view rule, const v1::Event& event) {
    if (rule.empty()) {
        return text::with_separators(value.whole());
    }
    if (rule == "text") {
        return value.present() ? text_of(value) : "";
    }
    if (rule == "real") {
        return real_text(value.real());
    }
    if (const auto words = templates().words.find(rule); words != templates().words.end()) {
        const auto word = words->second.find(value.enumerator());
        return word == words->second.end() ? "" : word->second;
    }
    const auto sentence = templates().sentences.find(rule);
    EVOD_ASSERT(sentence != templates().sentences.end());
    return value.present() ? fill(sentence->second, value.submessage(), event).text : "";
}

Filled text_of_all(const std::vector<Value>& values, std::string_view rule, const v1::Event& event) {
    const std::string_view kind = rule.substr(0, rule.find(' '));
    const std::string_view words = rule.substr(std::min(rule.size(), kind.size() + 1));
    const auto any_present = [&] { return std::ranges::any_of(values, &Value::present); };
    if (kind == "count") {
        return amount(values.size(), words);
    }
    if (kind == "sum") {
        std::uint64_t sum = 0;
        for (const Value& value : values) {
            sum += value.whole();
        }
        return amount(sum, words);
    }
    if (kind == "max" || kind == "mean") {
        double result = values.empty() ? 0 : kind == "max" ? values.front().real() : 0;
        for (const Value& value : values) {
            result = kind == "max" ? std::max(result, value.real())
                                   : result + value.real() / static_cast<double>(values.size());
        }
        return {text::fitness_text(result), any_present()};
    }
    if (kind == "if") {
        return {"", any_present()};
    }
    if (kind == "first") {
        return values.empty() ? Filled{"", false} : text_of_all({values.front()}, "", event);
    }
    std::string text;
    for (const Value& value : values) {
        const std::string part = text_of(value, rule, event);
        text += (text.empty() || part.empty() ? "" : ", ") + part;
    }
    const bool is_number = rule.empty() || rule == "real";
    return {text, is_number ? any_present() : !text.empty()};
}

/// Fills the text between braces.
Filled fill_argument(std::string_view argument, const Message& message, const v1::Event& event) {
    const std::size_t end = argument.find("; ");
    if (end != std::string_view::npos) {
        const Filled first = fill_argument(argument.substr(0, end), message, event);
        const Filled others = fill_argument(argument.substr(end + 2), message, event);
        return {(first.present ? first.text : "") + (first.present && others.present ? ", " : "") +
                    (others.present ? others.text : ""),
                first.present || others.present};
    }
    const std::size_t colon = argument.find(':');
    std::string_view path = argument.substr(0, colon);
    constexpr std::string_view of_event = "event.";
    const bool from_event = path.starts_with(of_event);
    std::vector<Value> values;
    add_values(from_event ? event : message, path.substr(from_event ? of_event.size() : 0), values);
    return text_of_all(values, colon == std::string_view::npos ? "" : argument.substr(colon + 1), event);
}

Filled fill(std::string_view text, const Message& message, const v1::Event& event) {
    Filled filled;
    while (!text.empty()) {
        const std::size_t open = std::min(text.find_first_of("{["), text.size());
        filled.text += text.substr(0, open);
        text.remove_prefix(open);
        if (text.empty()) {
            break;
        }
        const std::size_t close = text.find(text.front() == '{' ? '}' : ']');
        EVOD_ASSERT(close != std::string_view::npos);
        std::string_view inside = text.substr(1, close - 1);
        if (text.front() == '{') {
            const Filled argument = fill_argument(inside, message, event);
            filled.text += argument.text;
            filled.present = filled.present && argument.present;
        } else {
            for (bool found = false; !found && !inside.empty();) {
                const std::size_t bar = std::min(inside.find('|'), inside.size());
                const Filled alternative = fill(inside.substr(0, bar), message, event);
                found = alternative.present;
                filled.text += found ? alternative.text : "";
                inside.remove_prefix(std::min(bar + 1, inside.size()));
            }
        }
        text.remove_prefix(close + 1);
    }
    return filled;
}

std::string fill_named(const std::string& name, const Message& message, const v1::Event& event) {
    const auto sentence = templates().sentences.find(name);
    EVOD_ASSERT(sentence != templates().sentences.end());
    return fill(sentence->second, message, event).text;
}

} // namespace

std::string event_text(const v1::Event& event) {
    const FieldDescriptor* kind =
        event.GetReflection()->GetOneofFieldDescriptor(event, event.GetDescriptor()->FindOneofByName("kind"));
    EVOD_ASSERT(kind != nullptr);
    return fill_named(kind->name(), event.GetReflection()->GetMessage(event, kind), event);
}

std::string storage_text(const v1::Storage& storage) {
    return fill_named("storage", storage, v1::Event::default_instance());
}

bool has_event_template(const std::string& name) {
    return templates().sentences.contains(name);
}

} // namespace evod::protocol
