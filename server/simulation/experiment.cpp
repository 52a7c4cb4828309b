#include "server/simulation/experiment.h"

#include <boost/json.hpp>

#include <algorithm>
#include <charconv>
#include <set>

namespace evod::simulation {
namespace {

namespace json = boost::json;

std::size_t line_of(std::string_view text, std::size_t offset) {
    const std::string_view before = text.substr(0, offset);
    return 1 + static_cast<std::size_t>(std::count(before.begin(), before.end(), '\n'));
}

struct Field {
    std::string_view name;
    std::size_t line;
    std::string_view from_value; // the text from its value on
};

/// The fields of the object that `text` is, in the order in which they stand; `text` is JSON.
std::vector<Field> fields_of(std::string_view text) {
    std::vector<Field> fields;
    std::size_t line = 1; // a JSON string holds no line breaks
    int depth = 0;
    for (std::size_t i = 0; i < text.size(); ++i) {
        line += text[i] == '\n';
        depth += text[i] == '{' || text[i] == '[';
        depth -= text[i] == '}' || text[i] == ']';
        if (text[i] != '"')
            continue;
        const std::size_t begin = ++i;
        while (text[i] != '"')
            i += text[i] == '\\' ? 2 : 1;
        const std::size_t after = text.find_first_not_of(" \t\r\n", i + 1);
        if (depth == 1 && after != std::string_view::npos && text[after] == ':')
            fields.push_back({text.substr(begin, i - begin), line,
                              text.substr(std::min(text.find_first_not_of(" \t\r\n", after + 1), text.size()))});
    }
    return fields;
}

std::string with_line(std::string_view field, std::size_t line) {
    return std::string{field} + " (line " + std::to_string(line) + ")";
}

/// With the line of the field's first place.
std::string with_line(const std::vector<Field>& fields, std::string_view field) {
    const auto found = std::ranges::find(fields, field, &Field::name);
    return with_line(field, found == fields.end() ? 1 : found->line);
}

/// Nothing for a name that is written with escapes, which is no parameter's.
std::string_view from_value_of(const std::vector<Field>& fields, std::string_view name) {
    const auto found = std::ranges::find(fields, name, &Field::name);
    return found == fields.end() ? std::string_view{} : found->from_value;
}

base::Refusal refusal(std::string message) {
    return {.code = base::RefusalCode::InvalidArgument, .message = std::move(message), .violations = {}};
}

/// A number as it is written, to the last bit, which Boost.JSON does not promise.
double exact(double nearly, std::string_view text) {
    double number = 0;
    const auto read = std::from_chars(text.data(), text.data() + text.size(), number);
    return read.ec == std::errc{} ? number : nearly;
}

/// A JSON value as a parameter value; numbers without a fraction are counts where they fit one.
///
/// from_value  the text from the value on.
std::optional<ParameterValue> to_parameter_value(const json::value& value, std::string_view from_value) {
    constexpr std::uint64_t count_max = base::count_max;
    if (value.is_bool())
        return ParameterValue{value.get_bool()};
    if (value.is_string())
        return ParameterValue{std::string{value.get_string()}};
    if (value.is_double())
        return ParameterValue{exact(value.get_double(), from_value)};
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
    if (!error && read < text.size() && text.find_first_not_of(" \t\r\n", read) != std::string_view::npos)
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
    const std::vector<Field> fields = fields_of(text);
    std::set<std::string_view> seen;
    for (const Field& field : fields)
        if (!seen.insert(field.name).second)
            violations.push_back({with_line(field.name, field.line), "given once", "given twice"});
    for (const auto& [key, value] : document.get_object()) {
        const std::string name{key};
        if (name == "seed") {
            if (value.is_uint64() || (value.is_int64() && value.get_int64() >= 0))
                experiment.seed = base::Seed{value.to_number<std::uint64_t>()};
            else
                violations.push_back(
                    {with_line(fields, name), "a whole number, 0 to 18446744073709551615", json::serialize(value)});
        } else if (name == "description") {
            if (value.is_string())
                experiment.description = std::string{value.get_string()};
            else
                violations.push_back({with_line(fields, name), "a text", json::serialize(value)});
        } else if (auto parameter = to_parameter_value(value, from_value_of(fields, name))) {
            reference_given |= name == "reference_population";
            assignments.push_back({name, std::move(*parameter)});
        } else {
            violations.push_back({with_line(fields, name), "a number, true, false or a text", json::serialize(value)});
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
                violations.push_back({with_line(fields, violation.field), violation.allowed, violation.got});
    }
    if (!violations.empty())
        return base::Refusal{.code = base::RefusalCode::InvalidArgument,
                             .message = "the experiment has fields that cannot be used",
                             .violations = std::move(violations)};
    experiment.parameters = *parameters;
    return experiment;
}

std::string to_experiment_text(const Parameters& parameters, Written written) {
    std::string text = "{";
    for (const ParameterDescription& description : parameter_registry()) {
        const ParameterValue value = description.get(parameters);
        // What a reader takes where nothing is said.
        const bool follows = description.name == "reference_population";
        if (written == Written::Differences && (follows ? parameters.reference_population == parameters.population_size
                                                        : value == description.default_value()))
            continue;
        text += text.size() > 1 ? ",\n  " : "\n  ";
        text += "\"" + std::string{description.name} + "\": ";
        text += std::holds_alternative<std::string>(value) ? "\"" + to_text(value) + "\"" : to_text(value);
    }
    return text + (text.size() > 1 ? "\n}\n" : "}\n");
}

} // namespace evod::simulation
