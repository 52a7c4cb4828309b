#include "server/simulation/experiment.h"

#include <boost/json.hpp>

#include <algorithm>

namespace evod::simulation {
namespace {

namespace json = boost::json;

std::size_t line_of(std::string_view text, std::size_t offset) {
    const std::string_view before = text.substr(0, offset);
    return 1 + static_cast<std::size_t>(std::count(before.begin(), before.end(), '\n'));
}

/// The line on which a field stands; its name is looked for in quotes, as it can only be written there.
std::size_t line_of_field(std::string_view text, std::string_view field) {
    const std::size_t found = text.find("\"" + std::string{field} + "\"");
    return line_of(text, found == std::string_view::npos ? 0 : found);
}

std::string with_line(std::string_view text, std::string_view field) {
    return std::string{field} + " (line " + std::to_string(line_of_field(text, field)) + ")";
}

base::Refusal refusal(std::string message) {
    return {.code = base::RefusalCode::InvalidArgument, .message = std::move(message), .violations = {}};
}

/// A JSON value as a parameter value; numbers without a fraction are counts where they fit one.
std::optional<ParameterValue> to_parameter_value(const json::value& value) {
    constexpr std::uint64_t count_max = base::count_max;
    if (value.is_bool())
        return ParameterValue{value.get_bool()};
    if (value.is_string())
        return ParameterValue{std::string{value.get_string()}};
    if (value.is_double())
        return ParameterValue{value.get_double()};
    if (value.is_int64() && value.get_int64() >= 0 && static_cast<std::uint64_t>(value.get_int64()) <= count_max)
        return ParameterValue{static_cast<std::uint32_t>(value.get_int64())};
    if (value.is_number())
        return ParameterValue{value.to_number<double>()};
    return std::nullopt;
}

} // namespace

base::Result<Experiment> parse_experiment(std::string_view text) {
    json::stream_parser parser;
    boost::system::error_code error;
    const std::size_t read = parser.write_some(text, error);
    if (!error && read < text.size() &&
        text.find_first_not_of(" \t\r\n", read) != std::string_view::npos)
        error = json::error::extra_data;
    if (!error)
        parser.finish(error);
    if (error)
        return refusal("not JSON: line " + std::to_string(line_of(text, std::min(read, text.size()))) + ": " +
                       error.message());
    const json::value document = parser.release();
    if (!document.is_object())
        return refusal("not an experiment: a JSON object of parameters is needed");

    Experiment experiment;
    std::vector<Assignment> assignments;
    std::vector<base::Violation> violations;
    bool reference_given = false;
    for (const auto& [key, value] : document.get_object()) {
        const std::string name{key};
        if (name == "seed") {
            if (value.is_uint64() || (value.is_int64() && value.get_int64() >= 0))
                experiment.seed = base::Seed{value.to_number<std::uint64_t>()};
            else
                violations.push_back({with_line(text, name), "a whole number, 0 to 18446744073709551615",
                                      json::serialize(value)});
        } else if (name == "description") {
            if (value.is_string())
                experiment.description = std::string{value.get_string()};
            else
                violations.push_back({with_line(text, name), "a text", json::serialize(value)});
        } else if (auto parameter = to_parameter_value(value)) {
            reference_given |= name == "reference_population";
            assignments.push_back({name, std::move(*parameter)});
        } else {
            violations.push_back({with_line(text, name), "a number, true, false or a text", json::serialize(value)});
        }
    }
    if (!reference_given)
        for (const Assignment& assignment : assignments)
            if (assignment.name == "population_size") {
                assignments.push_back({"reference_population", assignment.value});
                break;
            }

    const base::Result<Parameters> parameters = assign({}, assignments);
    if (!parameters) {
        const base::Refusal refused = parameters.error();
        for (const base::Violation& violation : refused.violations)
            if (violation.field != "reference_population" || reference_given)
                violations.push_back({with_line(text, violation.field), violation.allowed, violation.got});
    }
    if (!violations.empty())
        return base::Refusal{.code = base::RefusalCode::InvalidArgument,
                             .message = "the experiment has fields that cannot be used",
                             .violations = std::move(violations)};
    experiment.parameters = *parameters;
    return experiment;
}

std::string to_experiment_text(const Parameters& parameters) {
    std::string text = "{";
    for (const ParameterDescription& description : parameter_registry()) {
        const ParameterValue value = description.get(parameters);
        if (value == description.default_value())
            continue;
        text += text.size() > 1 ? ",\n  " : "\n  ";
        text += "\"" + std::string{description.name} + "\": ";
        text += std::holds_alternative<std::string>(value) ? "\"" + to_text(value) + "\"" : to_text(value);
    }
    return text + (text.size() > 1 ? "\n}\n" : "}\n");
}

} // namespace evod::simulation
