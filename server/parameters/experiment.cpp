#include "server/parameters/experiment.h"

#include "server/parameters/gene_list.h"

#include <algorithm>
#include <charconv>
#include <map>
#include <utility>

namespace evod::parameters {
namespace {

using base::Violation;

base::Refusal invalid(std::string message, std::vector<Violation> violations = {}) {
    return {
        .code = base::RefusalCode::InvalidArgument, .message = std::move(message), .violations = std::move(violations)};
}

/// Returns the value in the form in which experiment files write it.
std::string json_text(const ParameterValue& value) {
    return std::holds_alternative<std::string>(value) ? "\"" + to_text(value) + "\"" : to_text(value);
}

/// Returns, for example, "mutation_chance at generation 30".
std::string at_generation(std::string_view name, std::uint64_t generation) {
    return std::string{name} + " at generation " + std::to_string(generation);
}

std::optional<std::uint64_t> generation_of(std::string_view key) {
    std::uint64_t generation = 0;
    const auto read = std::from_chars(key.data(), key.data() + key.size(), generation);
    const bool valid = read.ec == std::errc{} && read.ptr == key.data() + key.size() && generation > 0 && key[0] != '0';
    return valid ? std::optional{generation} : std::nullopt;
}

/// Returns the parameter whose value is the default of `name` in an experiment file; nullptr if there is none.
const ParameterDescription* followed_by(std::string_view name) {
    const auto all = followers();
    const auto found = std::ranges::find(all, name, &Follower::name);
    return found == all.end() ? nullptr : find_parameter(found->followed);
}

/// The values of one parameter by generation.
class ValuesByGeneration {
  public:
    /// values  the JSON object that the experiment file gives for the parameter; must outlive this ValuesByGeneration.
    ValuesByGeneration(const std::string& name, const JsonNode& values)
        : name_{name}, node_{&values}, description_{find_parameter(name)} {
        if (description_ == nullptr) {
            refuse(name_, values.line, *fault_of({name_, ParameterValue{0u}}));
        } else if (!can_be_scheduled(*description_)) {
            refuse(name_, values.line, {{}, "one value: it can change only at a reset", "values by generation"});
        } else if (values.members.empty()) {
            refuse(name_, values.line, {{}, R"(a generation and its value, as in {"1": 0.2, "30": 0.05})", "{}"});
        } else if (values.members.size() > 2 * Schedule::values_max) {
            // There are too many values to check each one.
            refuse(name_, values.line,
                   {{},
                    "at most " + std::to_string(Schedule::values_max) + " values",
                    std::to_string(values.members.size())});
        } else {
            for (const JsonMember* member : unique_members(values, name_ + " at generation ", violations_)) {
                read(*member);
            }
        }
    }

    const std::map<std::uint64_t, ParameterValue>& values() const { return values_; }
    const std::vector<Violation>& violations() const { return violations_; }
    /// Returns the line of the value for a generation; nullopt if the generation has no value.
    std::optional<std::size_t> line_at(std::uint64_t generation) const {
        const JsonMember* member = node_->find(std::to_string(generation));
        return member == nullptr ? std::nullopt : std::optional{member->line};
    }

  private:
    void refuse(const std::string& field, std::size_t line, Violation violation) {
        violation.field = with_line(field, line);
        violations_.push_back(std::move(violation));
    }
    void read(const JsonMember& member) {
        const auto generation = generation_of(member.name);
        if (!generation) {
            return refuse(name_, member.line,
                          {{},
                           R"(generations as keys: "1", "30", …; there is no period, so list each generation)",
                           '"' + member.name + '"'});
        }
        auto value = parameter_value_of(member.value);
        if (!value) {
            return refuse(at_generation(name_, *generation), member.line,
                          {{}, description_->allowed(), member.value.quoted()});
        }
        if (auto fault = fault_of({name_, *value})) {
            return refuse(at_generation(name_, *generation), member.line, *std::move(fault));
        }
        values_.emplace(*generation, *std::move(value));
    }

    std::string name_;
    const JsonNode* node_;
    const ParameterDescription* description_;
    std::map<std::uint64_t, ParameterValue> values_;
    std::vector<Violation> violations_;
};

/// Collects the schedule of a file and the lines of its values.
class ScheduleReader {
  public:
    /// Reads the values of one parameter. Adds the values after generation 1 to the schedule, and returns the value of
    /// generation 1, if there is one.
    std::optional<ParameterValue> read(const JsonMember& member, std::vector<Violation>& violations) {
        const auto [place, added] = read_.try_emplace(member.name, member.name, member.value);
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
                schedule_.add(generation, {member.name, value});
            }
        }
        return first;
    }

    /// Completes the schedule, and returns its faults. `parameters` are those of generation 1, and must be valid.
    std::vector<Violation> finish(const Parameters& parameters, const JsonNode& document) {
        if (const std::size_t count = schedule_.value_count(); count > Schedule::values_max) {
            return {{"the schedule", "at most " + std::to_string(Schedule::values_max) + " values after generation 1",
                     std::to_string(count)}};
        }
        schedule_.begin_with(parameters);
        std::vector<Violation> violations;
        for (const ScheduleFault& fault : faults_of(schedule_, parameters)) {
            const std::string field = at_generation(fault.violation.field, fault.generation);
            const auto line = line_of(fault, document);
            violations.push_back(
                {line ? with_line(field, *line) : field, fault.violation.allowed, fault.violation.got});
        }
        return violations;
    }
    const Schedule& schedule() const { return schedule_; }

  private:
    /// Returns the line of the faulty value. If the file does not contain the value, returns the line of its parameter,
    /// or else the line of a parameter that changes in that generation.
    std::optional<std::size_t> line_of(const ScheduleFault& fault, const JsonNode& document) const {
        if (const auto read = read_.find(fault.violation.field); read != read_.end()) {
            if (const auto line = read->second.line_at(fault.generation)) {
                return line;
            }
        }
        if (const JsonMember* parameter = document.find(fault.violation.field)) {
            return parameter->line;
        }
        for (const Assignment& change : schedule_.at(fault.generation)) {
            if (const auto line = read_.at(change.name).line_at(fault.generation)) {
                return line;
            }
        }
        return std::nullopt;
    }

    std::map<std::string, ValuesByGeneration, std::less<>> read_;
    Schedule schedule_;
};

/// Reads the members (name and value) of the JSON object that describes an experiment.
class ExperimentReader {
  public:
    explicit ExperimentReader(const JsonNode& document) : document_{document} {}

    base::Result<Experiment> read() {
        // A file with more members contains mistakes, and reporting each of them would take too long.
        const std::size_t members_max = 2 * parameter_registry().size();
        if (document_.members.size() > members_max) {
            return invalid("invalid experiment",
                           {{"the experiment", "at most " + std::to_string(members_max) + " fields",
                             std::to_string(document_.members.size())}});
        }
        for (const JsonMember* member : unique_members(document_, "", violations_)) {
            read(*member);
        }
        for (const Follower& follower : followers()) {
            const auto followed = std::ranges::find(assignments_, follower.followed, &Assignment::name);
            if (document_.find(follower.name) == nullptr && followed != assignments_.end()) {
                assignments_.push_back({std::string{follower.name}, followed->value});
            }
        }
        Parameters with_list;
        with_list.listed_genes = listed_genes_;
        const base::Result<Parameters> parameters = assign(with_list, assignments_);
        if (!parameters) {
            add_violations(parameters.error());
        }
        if (violations_.empty()) {
            violations_ = schedule_.finish(*parameters, document_);
        }
        if (!violations_.empty()) {
            return invalid("invalid experiment", std::move(violations_));
        }
        experiment_.parameters = *parameters;
        experiment_.schedule = schedule_.schedule();
        return std::move(experiment_);
    }

  private:
    void refuse(const JsonMember& member, std::string allowed) {
        violations_.push_back({with_line(member.name, member.line), std::move(allowed), member.value.quoted()});
    }

    void read(const JsonMember& member) {
        if (member.name == "seed") {
            if (const auto seed = member.value.whole_number()) {
                experiment_.seed = base::Seed{*seed};
            } else {
                refuse(member, "a whole number, 0 to 18446744073709551615");
            }
        } else if (member.name == "description") {
            if (member.value.is_string()) {
                experiment_.description = member.value.string();
            } else {
                refuse(member, "a string");
            }
        } else {
            read_parameter(member);
        }
    }

    void read_parameter(const JsonMember& member) {
        if (member.name == "free_genes" && member.value.is_array()) {
            listed_genes_ = read_gene_list(member.value, "free_genes", violations_);
            assignments_.push_back({"free_genes", ParameterValue{listed_genes_.gene_count()}});
        } else if (member.value.is_object()) {
            if (auto first = schedule_.read(member, violations_)) {
                assignments_.push_back({member.name, *std::move(first)});
            }
        } else if (auto value = parameter_value_of(member.value)) {
            assignments_.push_back({member.name, *std::move(value)});
        } else {
            refuse(member, std::string{"a number, true, false or a string"} +
                               (member.name.starts_with("free_gene_")
                                    ? "; the list free_genes gives each gene values of its own"
                                    : ""));
        }
    }

    /// Adds the violations of `refused`. A value that the file gives to a parameter and its follower is wrong once.
    void add_violations(const base::Refusal& refused) {
        const auto is_refused = [&](std::string_view name) {
            return std::ranges::find(refused.violations, name, &Violation::field) != refused.violations.end();
        };
        for (const Violation& violation : refused.violations) {
            const JsonMember* member = document_.find(violation.field);
            const ParameterDescription* followed = followed_by(violation.field);
            if (member == nullptr && followed != nullptr && is_refused(followed->name)) {
                continue;
            }
            violations_.push_back({with_line(violation.field, member == nullptr ? document_.line : member->line),
                                   violation.allowed, violation.got});
        }
    }

    const JsonNode& document_;
    Experiment experiment_;
    ScheduleReader schedule_;
    std::vector<Assignment> assignments_;
    evolution::FreeGenes listed_genes_;
    std::vector<Violation> violations_;
};

/// Returns the scheduled values, for example {"1": 0.2, "30": 0.05}; empty if the parameter is not scheduled.
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

std::optional<ParameterValue> parameter_value_of(const JsonNode& node) {
    if (node.is_string()) {
        return ParameterValue{node.string()};
    }
    if (node.text == "true" || node.text == "false") {
        return ParameterValue{node.text == "true"};
    }
    if (!node.is_number()) {
        return std::nullopt;
    }
    if (const auto count = node.whole_number(); count && *count <= base::count_max) {
        return ParameterValue{static_cast<std::uint32_t>(*count)};
    }
    return ParameterValue{node.real()};
}

base::Result<Experiment> read_experiment(const JsonNode& document) {
    if (!document.is_object()) {
        return invalid("not an experiment: expected a JSON object of parameters");
    }
    return ExperimentReader{document}.read();
}

base::Result<Experiment> parse_experiment(std::string_view text) {
    const auto document = parse_json(text);
    if (!document) {
        return document.error();
    }
    return read_experiment(*document);
}

base::Result<Schedule> parse_schedule(std::string_view text) {
    const auto document = parse_json(text);
    if (!document) {
        return document.error();
    }
    if (!document->is_object()) {
        return invalid("not a schedule: expected a JSON object of parameters");
    }
    std::vector<Violation> violations;
    Schedule schedule;
    for (const JsonMember* member : unique_members(*document, "", violations)) {
        const std::string field = with_line(member->name, member->line);
        if (!member->value.is_object()) {
            violations.push_back({field, "values by generation", member->value.quoted()});
            continue;
        }
        const ValuesByGeneration read{member->name, member->value};
        violations.insert(violations.end(), read.violations().begin(), read.violations().end());
        if (read.violations().empty() && !read.values().contains(1)) {
            violations.push_back({field, "a value for generation 1", "none"});
        }
        for (const auto& [generation, parameter] : read.values()) {
            schedule.add(generation, {member->name, parameter});
        }
    }
    if (violations.empty() && schedule.value_count() > Schedule::values_max) {
        violations.push_back({"the schedule", "at most " + std::to_string(Schedule::values_max) + " values",
                              std::to_string(schedule.value_count())});
    }
    if (!violations.empty()) {
        return invalid("invalid schedule", std::move(violations));
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
        const std::string scheduled = values_text(schedule, description.name);
        const ParameterDescription* followed = followed_by(description.name);
        if (written == Written::Differences && scheduled.empty() &&
            value == (followed == nullptr ? description.default_value() : followed->get(parameters))) {
            continue;
        }
        text += text.size() > 1 ? ",\n  " : "\n  ";
        const bool listed = description.name == "free_genes" && !parameters.listed_genes.empty();
        text += "\"" + std::string{description.name} + "\": " +
                (listed              ? to_json_text(parameters.listed_genes)
                 : scheduled.empty() ? json_text(value)
                                     : scheduled);
    }
    return text + (text.size() > 1 ? "\n}\n" : "}\n");
}

} // namespace evod::parameters
