#include "client/ctl/registry.h"

#include "client/ctl/text.h"
#include "proto/text/suggestion.h"

#include <boost/throw_exception.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>

namespace evod::ctl {

void throw_exception_from_error(const Mistakes& mistakes, const boost::source_location& where) {
    boost::throw_exception(std::runtime_error{mistakes.lines.empty() ? "" : mistakes.lines.front()}, where);
}

namespace {

template <class Number>
std::optional<Number> number_from(std::string_view word) {
    Number number{};
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
    return error == std::errc{} && end == word.data() + word.size() ? std::optional{number} : std::nullopt;
}

std::optional<std::uint32_t> count_from(std::string_view word) {
    if (const auto count = number_from<std::uint32_t>(word)) {
        return count;
    }
    const auto real = number_from<double>(word);
    if (real && *real >= 0 && *real <= std::numeric_limits<std::uint32_t>::max() && *real == std::floor(*real)) {
        return static_cast<std::uint32_t>(*real);
    }
    return std::nullopt;
}

std::optional<bool> flag_from(std::string_view word) {
    static constexpr std::array yes{"true", "on", "yes", "1"}, no{"false", "off", "no", "0"};
    if (std::ranges::find(yes, word) != yes.end()) {
        return true;
    }
    return std::ranges::find(no, word) != no.end() ? std::optional{false} : std::nullopt;
}

} // namespace

const v1::ParameterDescription* Registry::find(std::string_view name) const {
    const auto found = std::ranges::find_if(parameters_, [&](const auto& p) { return p.name() == name; });
    return found == parameters_.end() ? nullptr : &*found;
}

std::vector<std::string> Registry::names() const {
    std::vector<std::string> names;
    for (const auto& parameter : parameters_) {
        names.push_back(parameter.name());
    }
    return names;
}

std::string Registry::unknown(std::string_view name) const {
    return std::string{name} + ": unknown parameter" + text::did_you_mean(name, names());
}

Checked<std::vector<v1::ParameterAssignment>> Registry::assignments(const std::vector<std::string>& words) const {
    std::vector<v1::ParameterAssignment> result;
    Mistakes mistakes;
    for (const std::string& word : words) {
        const auto equals = word.find('=');
        const std::string name = word.substr(0, equals);
        const auto* parameter = find(name);
        if (parameter == nullptr) {
            mistakes.lines.push_back(unknown(name));
        } else if (equals == std::string::npos) {
            mistakes.lines.push_back(name + ": got no value, allowed " + name + "=VALUE with " + allowed(*parameter));
        } else if (auto value = parse_value(*parameter, std::string_view{word}.substr(equals + 1))) {
            auto& assignment = result.emplace_back();
            assignment.set_name(name);
            *assignment.mutable_value() = *std::move(value);
        } else {
            mistakes.add(value.error());
        }
    }
    if (!mistakes.lines.empty()) {
        return mistakes;
    }
    return result;
}

Checked<v1::ParameterValue> parse_value(const v1::ParameterDescription& parameter, std::string_view word) {
    v1::ParameterValue value;
    const auto wrong = [&](const std::string& hint = {}) {
        return Mistakes{{parameter.name() + ": got " + (word.empty() ? "nothing" : std::string{word}) + ", allowed " +
                         allowed(parameter) + hint}};
    };
    switch (parameter.kind()) {
    case v1::PARAMETER_KIND_REAL: {
        const auto real = number_from<double>(word);
        if (!real || !std::isfinite(*real)) {
            return wrong(text::value_hint(word, true));
        }
        value.set_real(*real);
        return value;
    }
    case v1::PARAMETER_KIND_COUNT: {
        const auto count = count_from(word);
        if (!count) {
            return wrong(text::value_hint(word, true));
        }
        value.set_count(*count);
        return value;
    }
    case v1::PARAMETER_KIND_FLAG: {
        const auto flag = flag_from(word);
        if (!flag) {
            return wrong(text::value_hint(word, false));
        }
        value.set_flag(*flag);
        return value;
    }
    case v1::PARAMETER_KIND_CHOICE: {
        const std::vector<std::string> choices{parameter.choices().begin(), parameter.choices().end()};
        if (std::ranges::find(choices, word) == choices.end()) {
            return wrong(text::did_you_mean(word, choices));
        }
        value.set_choice(std::string{word});
        return value;
    }
    default:
        return Mistakes{{parameter.name() + " has a kind unknown to this evoctl, which is older than the server"}};
    }
}

std::string allowed(const v1::ParameterDescription& parameter) {
    switch (parameter.kind()) {
    case v1::PARAMETER_KIND_REAL:
        return number_text(parameter.min(), text::Exponent::IfLong) + " to " +
               number_text(parameter.max(), text::Exponent::IfLong);
    case v1::PARAMETER_KIND_COUNT:
        return "a whole number, " + fixed(parameter.min(), 0) + " to " + fixed(parameter.max(), 0);
    case v1::PARAMETER_KIND_FLAG:
        return "true or false";
    default: {
        std::string text;
        for (const std::string& choice : parameter.choices()) {
            text += (text.empty() ? "" : ", ") + choice;
        }
        return text;
    }
    }
}

std::string effect_of(const v1::ParameterDescription& parameter) {
    switch (parameter.effect()) {
    case v1::PARAMETER_EFFECT_NEXT_TICK:
        return "next tick";
    case v1::PARAMETER_EFFECT_NEXT_GENERATION:
        return "next generation";
    case v1::PARAMETER_EFFECT_RESET:
        return "reset";
    default:
        return "-";
    }
}

} // namespace evod::ctl
