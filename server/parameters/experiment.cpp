#include "server/parameters/experiment.h"

#include "server/parameters/json_text.h"

#include <boost/json.hpp>

#include <algorithm>
#include <charconv>
#include <map>
#include <set>

namespace evod::parameters {
namespace {

namespace json = boost::json;

struct Field {
    std::string_view name;
    std::size_t line;
    std::string_view from_value; // the text from the field's value on
};

/// The fields of the object at the beginning of `text`, which is valid JSON, in the order of the text.
std::vector<Field> fields_of(std::string_view text) {
    std::vector<Field> fields;
    std::size_t line = 1; // a JSON string contains no line breaks
    int depth = 0;
    for (std::size_t i = 0; i < text.size(); ++i) {
        line += text[i] == '\n';
        depth += text[i] == '{' || text[i] == '[';
        depth -= text[i] == '}' || text[i] == ']';
        if (depth == 0 && (text[i] == '}' || text[i] == ']')) {
            break; // the rest is outside this object
        }
        if (text[i] != '"') {
            continue;
        }
        const std::size_t begin = ++i;
        while (text[i] != '"') {
            i += text[i] == '\\' ? 2 : 1;
        }
        const std::size_t after = text.find_first_not_of(" \t\r\n", i + 1);
        if (depth == 1 && after != std::string_view::npos && text[after] == ':') {
            fields.push_back({text.substr(begin, i - begin), line,
                              text.substr(std::min(text.find_first_not_of(" \t\r\n", after + 1), text.size()))});
        }
    }
    return fields;
}

std::string with_line(std::string_view field, std::size_t line) {
    return std::string{field} + " (line " + std::to_string(line) + ")";
}

/// Adds the line of the field's first occurrence.
std::string with_line(const std::vector<Field>& fields, std::string_view field) {
    const auto found = std::ranges::find(fields, field, &Field::name);
    return with_line(field, found == fields.end() ? 1 : found->line);
}

/// Empty for a name that is written with escapes; no parameter's name needs any.
std::string_view from_value_of(const std::vector<Field>& fields, std::string_view name) {
    const auto found = std::ranges::find(fields, name, &Field::name);
    return found == fields.end() ? std::string_view{} : found->from_value;
}

base::Refusal refusal(std::string message) {
    return {.code = base::RefusalCode::InvalidArgument, .message = std::move(message), .violations = {}};
}

/// A number exactly as written, which Boost.JSON does not guarantee.
double exact(double nearly, std::string_view text) {
    double number = 0;
    const auto read = std::from_chars(text.data(), text.data() + text.size(), number);
    return read.ec == std::errc{} ? number : nearly;
}

/// Converts a JSON value to a parameter value. A number without a fraction becomes a count if it fits.
///
/// from_value  the text from the value on.
std::optional<ParameterValue> to_parameter_value(const json::value& value, std::string_view from_value) {
    constexpr std::uint64_t count_max = base::count_max;
    if (value.is_bool()) {
        return ParameterValue{value.get_bool()};
    }
    if (value.is_string()) {
        return ParameterValue{std::string{value.get_string()}};
    }
    if (value.is_double()) {
        return ParameterValue{exact(value.get_double(), from_value)};
    }
    if (value.is_int64() && value.get_int64() >= 0 && static_cast<std::uint64_t>(value.get_int64()) <= count_max) {
        return ParameterValue{static_cast<std::uint32_t>(value.get_int64())};
    }
    if (value.is_number()) {
        return ParameterValue{value.to_number<double>()};
    }
    return std::nullopt;
}

/// The value as an experiment file writes it.
std::string json_text(const ParameterValue& value) {
    return std::holds_alternative<std::string>(value) ? "\"" + to_text(value) + "\"" : to_text(value);
}

/// "mutation_chance at generation 30"
std::string at_generation(std::string_view name, std::uint64_t generation) {
    return std::string{name} + " at generation " + std::to_string(generation);
}

std::optional<std::uint64_t> generation_of(std::string_view key) {
    std::uint64_t generation = 0;
    const auto read = std::from_chars(key.data(), key.data() + key.size(), generation);
    const bool good = read.ec == std::errc{} && read.ptr == key.data() + key.size() && generation > 0 && key[0] != '0';
    return good ? std::optional{generation} : std::nullopt;
}

/// The values of one parameter by generation.
class ValuesByGeneration {
  public:
    /// text  the whole file.
    /// from  the text from the object on; empty if the name is not a parameter's.
    ValuesByGeneration(const std::string& name, const json::object& values, std::string_view text,
                       std::string_view from)
        : name_{name}, description_{find_parameter(name)} {
        const std::size_t first_line = from.empty() ? 1 : line_of(text, text.size() - from.size());
        fields_ = fields_of(from);
        for (Field& field : fields_) {
            field.line += first_line - 1;
        }
        line_ = first_line;
        if (description_ == nullptr) {
            refuse(name_, line_, *fault_of({name_, ParameterValue{0u}}));
        } else if (!can_be_scheduled(*description_)) {
            refuse(name_, line_, {{}, "one value: it can change only at a reset", "values by generation"});
        } else if (values.empty()) {
            refuse(name_, line_, {{}, R"(a generation and its value, as in {"1": 0.2, "30": 0.05})", "{}"});
        } else if (values.size() > 2 * Schedule::values_max) {
            // Too many to check each value.
            refuse(name_, line_,
                   {{}, "at most " + std::to_string(Schedule::values_max) + " values", std::to_string(values.size())});
        } else {
            std::set<std::string_view> seen;
            for (const Field& field : fields_) {
                if (!seen.insert(field.name).second) {
                    refuse(name_ + " at generation " + std::string{field.name}, field.line,
                           {{}, "given once", "given twice"});
                }
            }
            for (const auto& [key, value] : values) {
                read(std::string{key}, value);
            }
        }
    }

    const std::map<std::uint64_t, ParameterValue>& values() const { return values_; }
    const std::vector<base::Violation>& violations() const { return violations_; }
    /// nullopt if the generation has no value.
    std::optional<std::size_t> line_at(std::uint64_t generation) const {
        const auto found = std::ranges::find(fields_, std::to_string(generation), &Field::name);
        return found == fields_.end() ? std::nullopt : std::optional{found->line};
    }

  private:
    void refuse(const std::string& field, std::size_t line, base::Violation violation) {
        violation.field = with_line(field, line);
        violations_.push_back(std::move(violation));
    }
    void read(const std::string& key, const json::value& value) {
        const auto field = std::ranges::find(fields_, key, &Field::name);
        const std::size_t line = field == fields_.end() ? line_ : field->line;
        const auto generation = generation_of(key);
        if (!generation) {
            return refuse(name_, line, {{}, R"(generations as keys: "1", "30", …)", '"' + key + '"'});
        }
        auto parameter = to_parameter_value(value, from_value_of(fields_, key));
        if (!parameter) {
            return refuse(at_generation(name_, *generation), line,
                          {{}, description_->allowed(), json::serialize(value)});
        }
        if (auto fault = fault_of({name_, *parameter})) {
            return refuse(at_generation(name_, *generation), line, *std::move(fault));
        }
        values_.emplace(*generation, *std::move(parameter));
    }

    std::string name_;
    const ParameterDescription* description_;
    std::size_t line_ = 1;
    std::vector<Field> fields_;
    std::map<std::uint64_t, ParameterValue> values_;
    std::vector<base::Violation> violations_;
};

base::Result<json::value> parse_object(std::string_view text) {
    auto document = parse_json(text);
    if (document && !document->is_object()) {
        return refusal("not an experiment: expected a JSON object of parameters");
    }
    return document;
}

/// Collects the schedule of a file and the lines of its values.
class ScheduleReader {
  public:
    /// Reads the values of one parameter. Adds those after generation 1 to the schedule and returns the value of
    /// generation 1, if there is one.
    ///
    /// from_value  the text from the value on.
    std::optional<ParameterValue> read(const std::string& name, const json::object& values, std::string_view text,
                                       std::string_view from_value, std::vector<base::Violation>& violations) {
        const auto [place, added] = read_.try_emplace(name, name, values, text, from_value);
        const ValuesByGeneration& read = place->second;
        violations.insert(violations.end(), read.violations().begin(), read.violations().end());
        if (!read.violations().empty()) {
            return std::nullopt;
        }
        std::optional<ParameterValue> first;
        for (const auto& [generation, value] : read.values()) {
            if (generation == 1) {
                first = value;
            } else {
                schedule_.add(generation, {name, value});
            }
        }
        return first;
    }

    /// parameters  of generation 1, valid.
    std::vector<base::Violation> finish(const Parameters& parameters, const std::vector<Field>& fields) {
        if (const std::size_t count = schedule_.value_count(); count > Schedule::values_max) {
            return {{"the schedule", "at most " + std::to_string(Schedule::values_max) + " values after generation 1",
                     std::to_string(count)}};
        }
        schedule_.begin_with(parameters);
        std::vector<base::Violation> violations;
        for (const ScheduleFault& fault : faults_of(schedule_, parameters)) {
            const std::string field = at_generation(fault.violation.field, fault.generation);
            const auto read = read_.find(fault.violation.field);
            const auto line = read == read_.end() ? std::nullopt : read->second.line_at(fault.generation);
            violations.push_back({line ? with_line(field, *line) : field + line_text(fields, fault),
                                  fault.violation.allowed, fault.violation.got});
        }
        return violations;
    }
    const Schedule& schedule() const { return schedule_; }

  private:
    /// The line of the parameter, or, if the file does not name it, of a parameter that changes in that generation.
    std::string line_text(const std::vector<Field>& fields, const ScheduleFault& fault) const {
        const auto found = std::ranges::find(fields, fault.violation.field, &Field::name);
        if (found != fields.end()) {
            return with_line("", found->line);
        }
        for (const Assignment& change : schedule_.at(fault.generation)) {
            if (const auto line = read_.at(change.name).line_at(fault.generation)) {
                return with_line("", *line);
            }
        }
        return "";
    }

    std::map<std::string, ValuesByGeneration, std::less<>> read_;
    Schedule schedule_;
};

/// "{"1": 0.2, "30": 0.05}"; empty if the parameter is not scheduled.
std::string values_text(const Schedule& schedule, std::string_view name) {
    std::string text;
    for (const auto& [generation, assignments] : schedule.changes()) {
        for (const Assignment& assignment : assignments) {
            if (assignment.name == name) {
                text +=
                    (text.empty() ? "{\"" : ", \"") + std::to_string(generation) + "\": " + json_text(assignment.value);
            }
        }
    }
    return text.empty() ? text : text + "}";
}

} // namespace

base::Result<Experiment> parse_experiment(std::string_view text) {
    const base::Result<json::value> document = parse_object(text);
    if (!document) {
        return document.error();
    }

    Experiment experiment;
    ScheduleReader schedule;
    std::vector<Assignment> assignments;
    std::vector<base::Violation> violations;
    bool reference_given = false;
    const std::vector<Field> fields = fields_of(text);
    std::set<std::string_view> seen;
    for (const Field& field : fields) {
        if (!seen.insert(field.name).second) {
            violations.push_back({with_line(field.name, field.line), "given once", "given twice"});
        }
    }
    for (const auto& [key, value] : document->get_object()) {
        const std::string name{key};
        if (name == "seed") {
            if (value.is_uint64() || (value.is_int64() && value.get_int64() >= 0)) {
                experiment.seed = base::Seed{value.to_number<std::uint64_t>()};
            } else {
                violations.push_back(
                    {with_line(fields, name), "a whole number, 0 to 18446744073709551615", json::serialize(value)});
            }
        } else if (name == "description") {
            if (value.is_string()) {
                experiment.description = std::string{value.get_string()};
            } else {
                violations.push_back({with_line(fields, name), "a text", json::serialize(value)});
            }
        } else if (value.is_object()) {
            reference_given |= name == "reference_population";
            if (auto first = schedule.read(name, value.get_object(), text, from_value_of(fields, name), violations)) {
                assignments.push_back({name, *std::move(first)});
            }
        } else if (auto parameter = to_parameter_value(value, from_value_of(fields, name))) {
            reference_given |= name == "reference_population";
            assignments.push_back({name, std::move(*parameter)});
        } else {
            violations.push_back({with_line(fields, name), "a number, true, false or a text", json::serialize(value)});
        }
    }
    if (!reference_given) {
        for (const Assignment& assignment : assignments) {
            if (assignment.name == "population_size") {
                assignments.push_back({"reference_population", assignment.value});
                break;
            }
        }
    }

    const base::Result<Parameters> parameters = assign({}, assignments);
    if (!parameters) {
        const base::Refusal refused = parameters.error();
        for (const base::Violation& violation : refused.violations) {
            if (violation.field != "reference_population" || reference_given) {
                violations.push_back({with_line(fields, violation.field), violation.allowed, violation.got});
            }
        }
    }
    if (violations.empty()) {
        violations = schedule.finish(*parameters, fields);
    }
    if (!violations.empty()) {
        return base::Refusal{.code = base::RefusalCode::InvalidArgument,
                             .message = "invalid experiment",
                             .violations = std::move(violations)};
    }
    experiment.parameters = *parameters;
    experiment.schedule = schedule.schedule();
    return experiment;
}

base::Result<Schedule> parse_schedule(std::string_view text) {
    const base::Result<json::value> document = parse_object(text);
    if (!document) {
        return document.error();
    }
    const std::vector<Field> fields = fields_of(text);
    std::vector<base::Violation> violations;
    Schedule schedule;
    for (const auto& [key, value] : document->get_object()) {
        const std::string name{key};
        if (!value.is_object()) {
            violations.push_back({with_line(fields, name), "values by generation", json::serialize(value)});
            continue;
        }
        const ValuesByGeneration read{name, value.get_object(), text, from_value_of(fields, name)};
        violations.insert(violations.end(), read.violations().begin(), read.violations().end());
        if (read.violations().empty() && !read.values().contains(1)) {
            violations.push_back({with_line(fields, name), "a value for generation 1", "none"});
        }
        for (const auto& [generation, parameter] : read.values()) {
            schedule.add(generation, {name, parameter});
        }
    }
    if (violations.empty() && schedule.value_count() > Schedule::values_max) {
        violations.push_back({"the schedule", "at most " + std::to_string(Schedule::values_max) + " values",
                              std::to_string(schedule.value_count())});
    }
    if (!violations.empty()) {
        return base::Refusal{.code = base::RefusalCode::InvalidArgument,
                             .message = "invalid schedule",
                             .violations = std::move(violations)};
    }
    return schedule;
}

std::string to_schedule_text(const Schedule& schedule) {
    std::string text = "{";
    for (const Assignment& scheduled : schedule.at(1)) {
        text += text.size() > 1 ? ",\n  " : "\n  ";
        text += "\"" + scheduled.name + "\": " + values_text(schedule, scheduled.name);
    }
    return text + (text.size() > 1 ? "\n}\n" : "}\n");
}

std::string to_experiment_text(const Parameters& parameters, Written written, const Schedule& schedule) {
    std::string text = "{";
    for (const ParameterDescription& description : parameter_registry()) {
        const ParameterValue value = description.get(parameters);
        // The value that a reader uses if the file does not name the parameter.
        const std::string scheduled = values_text(schedule, description.name);
        const bool follows = description.name == "reference_population";
        if (written == Written::Differences && scheduled.empty() &&
            (follows ? parameters.reference_population == parameters.population_size
                     : value == description.default_value())) {
            continue;
        }
        text += text.size() > 1 ? ",\n  " : "\n  ";
        text += "\"" + std::string{description.name} + "\": " + (scheduled.empty() ? json_text(value) : scheduled);
    }
    return text + (text.size() > 1 ? "\n}\n" : "}\n");
}

} // namespace evod::parameters
