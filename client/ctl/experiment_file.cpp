#include "client/ctl/experiment_file.h"

#include "client/ctl/text.h"

#include <boost/json.hpp>

#include <algorithm>
#include <charconv>

namespace evod::ctl {

namespace json = boost::json;

namespace {

/// A JSON value as the word that would be typed for it; nullopt for null, arrays and objects.
std::optional<std::string> word_of(const json::value& value) {
    switch (value.kind()) {
    case json::kind::bool_:
        return value.get_bool() ? "true" : "false";
    case json::kind::int64:
        return std::to_string(value.get_int64());
    case json::kind::uint64:
        return std::to_string(value.get_uint64());
    case json::kind::double_:
        return exact(value.get_double());
    case json::kind::string:
        return std::string{value.get_string()};
    default:
        return std::nullopt;
    }
}

/// Whether JSON's type fits: a number in quotes is a mistake, though its word could be read.
bool fits(const json::value& value, v1::ParameterKind kind) {
    switch (kind) {
    case v1::PARAMETER_KIND_FLAG:
        return value.is_bool();
    case v1::PARAMETER_KIND_CHOICE:
        return value.is_string();
    default:
        return value.is_number();
    }
}

/// Which generation a key of such an object is; nullopt for another text.
std::optional<std::uint64_t> generation_of(std::string_view key) {
    std::uint64_t generation = 0;
    const auto [end, error] = std::from_chars(key.data(), key.data() + key.size(), generation);
    const bool good = error == std::errc{} && end == key.data() + key.size() && generation > 0 && key.front() != '0';
    return good ? std::optional{generation} : std::nullopt;
}

/// A value of JSON's type that fits, and can be read.
Checked<v1::ParameterValue> read_value(const v1::ParameterDescription& parameter, const json::value& value,
                                       const std::string& where) {
    if (!fits(value, parameter.kind())) {
        return Mistakes{
            {parameter.name() + where + ": got " + json::serialize(value) + ", allowed " + allowed(parameter)}};
    }
    return parse_value(parameter, *word_of(value));
}

void read_by_generation(const v1::ParameterDescription& parameter, const json::object& values, ExperimentFile& file,
                        Mistakes& mistakes) {
    if (parameter.effect() == v1::PARAMETER_EFFECT_RESET || values.empty()) {
        mistakes.lines.push_back(parameter.name() + ": got " + json::serialize(values) + ", allowed " +
                                 (values.empty() ? R"(a generation and its value, as in {"1": 0.2, "30": 0.05})"
                                                 : "one value: it can change only at a reset"));
        return;
    }
    for (const auto& [key, value] : values) {
        const auto generation = generation_of(std::string{key});
        if (!generation) {
            mistakes.lines.push_back(parameter.name() + ": got " + json::serialize(json::string{key}) +
                                     R"(, allowed generations as keys: "1", "30", …)");
            continue;
        }
        auto read = read_value(parameter, value, " at generation " + std::string{key});
        if (!read) {
            mistakes.add(read.error());
        } else if (*generation == 1) {
            auto& assignment = file.parameters.emplace_back();
            assignment.set_name(parameter.name());
            *assignment.mutable_value() = *std::move(read);
        } else {
            auto& scheduled = file.schedule.emplace_back();
            scheduled.set_name(parameter.name());
            scheduled.set_generation(*generation);
            *scheduled.mutable_value() = *std::move(read);
        }
    }
}

void read_parameter(const std::string& name, const json::value& value, const Registry& registry, ExperimentFile& file,
                    Mistakes& mistakes) {
    const auto* parameter = registry.find(name);
    if (parameter == nullptr) {
        mistakes.lines.push_back(registry.unknown(name));
        return;
    }
    if (value.is_object()) {
        read_by_generation(*parameter, value.get_object(), file, mistakes);
        return;
    }
    auto parsed = read_value(*parameter, value, "");
    if (!parsed) {
        mistakes.add(parsed.error());
        return;
    }
    auto& assignment = file.parameters.emplace_back();
    assignment.set_name(name);
    *assignment.mutable_value() = *std::move(parsed);
}

} // namespace

Checked<ExperimentFile> parse_experiment(std::string_view text, const Registry& registry) {
    json::error_code error;
    json::stream_parser parser;
    const std::size_t read = parser.write_some(text.data(), text.size(), error);
    if (!error && !parser.done()) {
        error = json::error::incomplete;
    }
    const bool rest = !error && text.find_first_not_of(" \t\r\n", read) != std::string_view::npos;
    if (error || rest) {
        const auto line = 1 + std::ranges::count(text.substr(0, read), '\n');
        return Mistakes{
            {"line " + std::to_string(line) + ": " + (rest ? "more than one JSON value" : error.message())}};
    }
    const json::value document = parser.release();
    if (!document.is_object()) {
        return Mistakes{{"an experiment is a JSON object: { \"population_size\": 50, … }"}};
    }
    ExperimentFile file;
    Mistakes mistakes;
    for (const auto& [key, value] : document.get_object()) {
        const std::string name{key};
        if (name == "description") {
            if (value.is_string()) {
                file.description = std::string{value.get_string()};
            } else {
                mistakes.lines.push_back("description: got " + json::serialize(value) + ", allowed a text");
            }
        } else if (name == "seed") {
            json::error_code not_a_number;
            file.seed = value.to_number<std::uint64_t>(not_a_number);
            if (not_a_number) {
                mistakes.lines.push_back("seed: got " + json::serialize(value) + ", allowed 0 to 2^64 - 1, whole");
            }
        } else {
            read_parameter(name, value, registry, file, mistakes);
        }
    }
    if (!mistakes.lines.empty()) {
        return mistakes;
    }
    const auto named = [&](std::string_view name) {
        return std::ranges::find_if(file.parameters, [&](const auto& p) { return p.name() == name; });
    };
    if (const auto population = named("population_size"); population != file.parameters.end() &&
                                                          named("reference_population") == file.parameters.end() &&
                                                          registry.find("reference_population") != nullptr) {
        v1::ParameterAssignment reference = *population;
        reference.set_name("reference_population");
        file.parameters.push_back(std::move(reference));
    }
    return file;
}

} // namespace evod::ctl
