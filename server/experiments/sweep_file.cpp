#include "server/experiments/sweep_file.h"

#include "server/base/elementary.h"
#include "server/base/overloaded.h"
#include "server/experiments/experiment_file.h"
#include "server/parameters/json_text.h"

#include <boost/json.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <numeric>
#include <optional>
#include <set>
#include <utility>

namespace evod::experiments {
namespace {

namespace json = boost::json;
using base::Violation;
using parameters::CountParameter;
using parameters::ParameterDescription;
using parameters::Parameters;
using parameters::ParameterValue;
using parameters::RealParameter;

struct Member;
/// A value of JSON with its place in the text, which Boost.JSON does not tell.
struct Node {
    std::string_view text;
    std::size_t line = 1;
    std::vector<Member> members; // of an object, in order
    std::vector<Node> elements;  // of an array

    bool is_object() const { return text.front() == '{'; }
    bool is_array() const { return text.front() == '['; }
    bool is_string() const { return text.front() == '"'; }
    bool is_number() const { return text.front() == '-' || (text.front() >= '0' && text.front() <= '9'); }
};
struct Member {
    std::string name;
    std::size_t line;
    Node value;
};

/// Finds the places in a text that is known to be JSON, and no deeper than Boost.JSON reads.
class Places {
  public:
    explicit Places(std::string_view text) : text_{text} {}

    Node value() {
        skip_space();
        Node node;
        node.line = line_;
        const std::size_t begin = at_;
        if (const char c = text_[at_]; c == '{' || c == '[') {
            ++at_;
            for (skip_space(); text_[at_] != '}' && text_[at_] != ']'; skip_space()) {
                if (c == '[') {
                    node.elements.push_back(value());
                } else {
                    node.members.push_back(member());
                }
                skip_space();
                at_ += text_[at_] == ',';
            }
            ++at_;
        } else if (c == '"') {
            skip_string();
        } else {
            at_ = std::min(text_.find_first_of(",]} \t\r\n", at_), text_.size());
        }
        node.text = text_.substr(begin, at_ - begin);
        return node;
    }

    static std::string decoded(std::string_view string) {
        boost::system::error_code never;
        const json::value value = json::parse(json::string_view{string.data(), string.size()}, never);
        return value.is_string() ? std::string{value.get_string()} : std::string{};
    }

  private:
    void skip_space() {
        for (; at_ < text_.size() && std::string_view{" \t\r\n"}.find(text_[at_]) != std::string_view::npos; ++at_) {
            line_ += text_[at_] == '\n';
        }
    }
    void skip_string() { // JSON strings hold no line breaks
        for (++at_; text_[at_] != '"';) {
            at_ += text_[at_] == '\\' ? 2 : 1;
        }
        ++at_;
    }
    Member member() {
        const std::size_t begin = at_, line = line_;
        skip_string();
        std::string name = decoded(text_.substr(begin, at_ - begin));
        skip_space();
        ++at_; // the colon
        return {std::move(name), line, value()};
    }

    std::string_view text_;
    std::size_t at_ = 0, line_ = 1;
};

std::string with_line(std::string field, std::size_t line) {
    return std::move(field) + " (line " + std::to_string(line) + ")";
}

/// The text of a value as it is quoted to whoever wrote it.
std::string quoted(const Node& node) {
    constexpr std::size_t bytes_max = 60;
    return node.text.size() <= bytes_max ? std::string{node.text}
           : node.is_array()             ? "a list"
           : node.is_object()            ? "an object"
                                         : "a long text";
}

template <class Number>
std::optional<Number> number_of(const Node& node) {
    Number number{};
    const char* const end = node.text.data() + node.text.size();
    const auto read = std::from_chars(node.text.data(), end, number);
    return read.ec == std::errc{} && read.ptr == end ? std::optional{number} : std::nullopt;
}

/// A number to its last bit; one that is too small or too large for any, as Boost.JSON takes it.
double real_of(const Node& node) {
    if (const auto exact = number_of<double>(node)) {
        return *exact;
    }
    boost::system::error_code error;
    const json::value value = json::parse(json::string_view{node.text.data(), node.text.size()}, error);
    return value.is_number() ? value.to_number<double>() : HUGE_VAL;
}

void set(const ParameterDescription& description, const ParameterValue& value, Parameters& parameters) {
    std::visit(
        base::Overloaded{[&](const RealParameter& real) {
                             const auto* count = std::get_if<std::uint32_t>(&value);
                             real.set(parameters, count != nullptr ? *count : std::get<double>(value));
                         },
                         [&](const CountParameter& count) { count.set(parameters, std::get<std::uint32_t>(value)); },
                         [&](const parameters::FlagParameter& flag) { flag.set(parameters, std::get<bool>(value)); },
                         [&](const parameters::ChoiceParameter& choice) {
                             const auto name = std::ranges::find(choice.names, std::get<std::string>(value));
                             choice.set(parameters, static_cast<std::size_t>(name - choice.names.begin()));
                         }},
        description.kind);
}

/// As experiment files take it: numbers without a fraction are counts where they fit one.
std::optional<ParameterValue> value_of(const Node& node) {
    if (node.is_string()) {
        return ParameterValue{Places::decoded(node.text)};
    }
    if (node.text == "true" || node.text == "false") {
        return ParameterValue{node.text == "true"};
    }
    if (!node.is_number()) {
        return std::nullopt;
    }
    if (const auto count = number_of<std::uint32_t>(node)) {
        return ParameterValue{*count};
    }
    return ParameterValue{real_of(node)};
}

/// A value that a parameter can have, as it has it: a count that is written for a real is a real.
ParameterValue as_it_is_held(const ParameterDescription& description, const ParameterValue& value) {
    Parameters parameters;
    set(description, value, parameters);
    return description.get(parameters);
}

bool ends(const Parameters& parameters) {
    return parameters.generation_limit > 0 || parameters.stagnation_limit > 0 || parameters.stop_at_target_fitness ||
           parameters.stop_at_extinction;
}

/// What a parameter is given: a list of values, or a range of numbers.
struct Range {
    double from = 0, to = 1;
    bool log = false, whole = false;

    /// t  0 to 1.
    double between(double t, double low, double high) const {
        return log ? base::exp(base::log(low) + t * (base::log(high) - base::log(low))) : low + t * (high - low);
    }
    ParameterValue value(double x) const {
        x = std::clamp(x, from, to);
        if (whole) {
            return static_cast<std::uint32_t>(x);
        }
        return x;
    }
    /// The i-th of so many, evenly spread and with both ends; whole numbers are the nearest.
    ParameterValue step(std::size_t i, std::size_t steps) const {
        if (i == 0 || i + 1 == steps) {
            return value(i == 0 ? from : to);
        }
        const double x = between(static_cast<double>(i) / static_cast<double>(steps - 1), from, to);
        return value(whole ? std::floor(x + 0.5) : x);
    }
    /// u  0 to 1, without 1; each whole number has the same share of it, on the scale.
    ParameterValue drawn(double u) const {
        return value(whole ? std::floor(between(u, from, to + 1)) : between(u, from, to));
    }
};
struct Dimension {
    const ParameterDescription* parameter = nullptr;
    std::vector<ParameterValue> values;
    std::optional<Range> range;
    std::size_t steps = 0; // of the range, in a grid
};

class Reading {
  public:
    Reading(const Node& document, const LoadExperiment& load) : document_{document}, load_{load} {}

    base::Result<Sweep> sweep() {
        top();
        if (designs_.size() == 1) {
            read_design();
        }
        if (violations_.empty()) {
            check_cells();
        }
        if (violations_.empty()) {
            return std::move(sweep_);
        }
        std::string message = "the sweep has fields that cannot be used";
        if (const std::size_t count = violations_.size(); count > violations_max) {
            message += ": " + std::to_string(count) + ", of which the first are";
            violations_.resize(violations_max);
        }
        return base::Refusal{.code = base::RefusalCode::InvalidArgument,
                             .message = std::move(message),
                             .violations = std::move(violations_)};
    }

  private:
    void refuse(std::string field, std::string allowed, std::string got) {
        violations_.push_back({std::move(field), std::move(allowed), std::move(got)});
    }
    void refuse(const std::string& field, const Node& node, std::string allowed) {
        refuse(with_line(field, node.line), std::move(allowed), quoted(node));
    }

    /// Says which names are there twice; the others.
    std::vector<const Member*> members_of(const Node& object, const std::string& prefix) {
        std::vector<const Member*> members;
        std::set<std::string_view> seen;
        for (const Member& member : object.members) {
            if (seen.insert(member.name).second) {
                members.push_back(&member);
            } else {
                refuse(with_line(prefix + member.name, member.line), "given once", "given twice");
            }
        }
        return members;
    }

    void top() {
        for (const Member* member : members_of(document_, "")) {
            const std::string& name = member->name;
            const Node& value = member->value;
            if (name == "experiment") {
                experiment_ = member;
            } else if (name == "grid" || name == "list" || name == "latin_hypercube") {
                designs_.push_back(member);
            } else if (name == "replicates") {
                take_whole(*member, 1, Sweep::runs_max, sweep_.replicates);
            } else if (name == "generations") {
                take_whole(*member, 1, base::count_max, generations_.emplace());
            } else if (name == "seed") {
                take_whole(*member, 0, ~std::uint64_t{0}, seed_.emplace());
            } else if (name != "description") {
                refuse(with_line(name, member->line),
                       "description, experiment, grid, list, latin_hypercube, replicates, seed, generations",
                       "an unknown name");
            } else if (!value.is_string()) {
                refuse(name, value, "a text");
            }
        }
        if (designs_.size() != 1) {
            std::string got;
            for (const Member* design : designs_) {
                got += (got.empty() ? "" : " and ") + design->name;
            }
            refuse(designs_.empty() ? "grid" : with_line(designs_.back()->name, designs_.back()->line),
                   "one of grid, list, latin_hypercube", got.empty() ? "none of them" : got);
        }
        read_experiment();
    }

    template <class Number>
    void take_whole(const Member& member, std::uint64_t least, std::uint64_t greatest, Number& number) {
        const auto given = number_of<std::uint64_t>(member.value);
        if (given && *given >= least && *given <= greatest) {
            number = static_cast<Number>(*given);
        } else {
            refuse(member.name, member.value,
                   "a whole number, " + std::to_string(least) + " to " + std::to_string(greatest));
        }
    }

    void read_experiment() {
        if (experiment_ != nullptr) {
            const Node& node = experiment_->value;
            if (node.is_object()) {
                // Behind as many line breaks as come before it, so that lines are those of the sweep file.
                take_experiment(parameters::parse_experiment(std::string(node.line - 1, '\n') + std::string{node.text}),
                                "experiment.");
            } else if (node.is_string()) {
                const std::string path = Places::decoded(node.text);
                const auto loaded = load_(path);
                if (!loaded && loaded.error().violations.empty()) {
                    refuse("experiment", node, "the path of an experiment file: " + loaded.error().message);
                } else {
                    take_experiment(loaded, "experiment " + path + ": ");
                }
            } else {
                refuse("experiment", node, "the path of an experiment file, or an object of parameters");
            }
        }
        if (generations_) {
            sweep_.parameters.generation_limit = *generations_;
            sweep_.schedule.remove("generation_limit");
        }
        if (seed_) {
            sweep_.seed = {*seed_};
        }
    }

    void take_experiment(const base::Result<parameters::Experiment>& experiment, const std::string& prefix) {
        if (experiment) {
            sweep_.parameters = experiment->parameters;
            sweep_.schedule = experiment->schedule;
            sweep_.seed = experiment->seed.value_or(sweep_.seed);
            return;
        }
        const base::Refusal refused = experiment.error();
        for (const Violation& violation : refused.violations) {
            refuse(prefix + violation.field, violation.allowed, violation.got);
        }
    }

    void read_design() {
        const Member& design = *designs_.front();
        if (design.name == "list") {
            read_list(design.value);
        } else if (!design.value.is_object() || (design.name == "grid" && design.value.members.empty())) {
            refuse(design.name, design.value,
                   design.name == "grid" ? "an object: what each parameter is given"
                                         : "an object with \"samples\" and \"parameters\"");
        } else if (design.name == "grid") {
            read_grid(design);
        } else {
            read_latin_hypercube(design);
        }
        if (generations_ && std::ranges::any_of(sweep_.swept, [](auto* p) { return p->name == "generation_limit"; })) {
            refuse("generations", "nothing, where generation_limit is swept", std::to_string(*generations_));
        }
    }

    /// Whether a parameter can have a value; says why not.
    bool is_good(const std::string& parameter, const std::string& field, const Node& node) {
        const auto value = value_of(node);
        if (!value) {
            refuse(field, node, "a number, true, false or a text");
            return false;
        }
        auto fault = parameters::fault_of({parameter, *value});
        if (!fault) {
            return true;
        }
        refuse(with_line(field, node.line), std::move(fault->allowed), std::move(fault->got));
        return false;
    }

    const ParameterDescription* parameter_named(const Member& member, const std::string& field) {
        const ParameterDescription* parameter = parameters::find_parameter(member.name);
        if (parameter == nullptr) {
            const auto fault = parameters::fault_of({member.name, 0u});
            refuse(with_line(field, member.line), fault->allowed, fault->got);
        }
        return parameter;
    }

    void read_list(const Node& list) {
        if (!list.is_array() || list.elements.empty() ||
            !std::ranges::all_of(list.elements, [](const Node& cell) { return cell.is_object(); })) {
            return refuse("list", list, "a list of objects of parameters, at least one");
        }
        if (has_too_many_runs("list", list, list.elements.size())) {
            return;
        }
        std::vector<std::vector<std::pair<std::size_t, ParameterValue>>> given(list.elements.size());
        for (std::size_t cell = 0; cell < given.size(); ++cell) {
            const std::string prefix = "list[" + std::to_string(cell) + "].";
            for (const Member* member : members_of(list.elements[cell], prefix)) {
                const ParameterDescription* parameter = parameter_named(*member, prefix + member->name);
                if (parameter == nullptr || !is_good(member->name, prefix + member->name, member->value)) {
                    continue;
                }
                auto column = std::ranges::find(sweep_.swept, parameter);
                if (column == sweep_.swept.end()) {
                    column = sweep_.swept.insert(column, parameter);
                }
                given[cell].emplace_back(column - sweep_.swept.begin(),
                                         as_it_is_held(*parameter, *value_of(member->value)));
            }
        }
        std::vector<ParameterValue> of_base;
        for (const ParameterDescription* parameter : sweep_.swept) {
            of_base.push_back(parameter->get(sweep_.parameters));
        }
        sweep_.cells.assign(given.size(), of_base);
        for (std::size_t cell = 0; cell < given.size(); ++cell) {
            for (auto& [column, value] : given[cell]) {
                sweep_.cells[cell][column] = std::move(value);
            }
        }
    }

    bool has_too_many_runs(const std::string& field, const Node& node, std::size_t cells) {
        if (cells <= Sweep::runs_max / sweep_.replicates) {
            return false;
        }
        refuse(with_line(field, node.line), "at most " + std::to_string(Sweep::runs_max) + " runs",
               std::to_string(cells) + " cells of " + std::to_string(sweep_.replicates) + " replicates");
        return true;
    }

    enum class Steps { Needed, None };
    std::optional<Dimension> dimension(const Member& member, const std::string& field, Steps steps) {
        const Node& node = member.value;
        Dimension read{.parameter = parameter_named(member, field), .values = {}, .range = {}};
        if (read.parameter == nullptr) {
            return std::nullopt;
        }
        if (node.is_object()) {
            return take_range(read, node, field, steps) ? std::optional{std::move(read)} : std::nullopt;
        }
        if (!node.is_array() || node.elements.empty()) {
            refuse(field, node,
                   steps == Steps::Needed ? R"(a list of values, or {"from": …, "to": …, "steps": …})"
                                          : R"({"from": …, "to": …}, or a list of values)");
            return std::nullopt;
        }
        bool good = true;
        for (std::size_t i = 0; i < node.elements.size(); ++i) {
            const std::string element = field + "[" + std::to_string(i) + "]";
            if (!is_good(member.name, element, node.elements[i])) {
                good = false;
                continue;
            }
            read.values.push_back(as_it_is_held(*read.parameter, *value_of(node.elements[i])));
        }
        if (good && find_twice(read, node, field)) {
            return std::nullopt;
        }
        return good ? std::optional{std::move(read)} : std::nullopt;
    }

    bool find_twice(const Dimension& read, const Node& node, const std::string& field) {
        bool found = false;
        std::set<ParameterValue> seen;
        for (std::size_t i = 0; i < read.values.size(); ++i) {
            if (!seen.insert(read.values[i]).second) {
                refuse(field + "[" + std::to_string(i) + "]", node.elements[i], "each value once");
                found = true;
            }
        }
        return found;
    }

    bool take_range(Dimension& read, const Node& node, const std::string& field, Steps steps) {
        const std::size_t before = violations_.size();
        const std::string parameter{read.parameter->name};
        const bool whole = std::holds_alternative<CountParameter>(read.parameter->kind);
        if (!whole && !std::holds_alternative<RealParameter>(read.parameter->kind)) {
            refuse(field, node, "a list of values: " + read.parameter->allowed());
            return false;
        }
        Range range{.whole = whole};
        bool from = false, to = false, counted = steps == Steps::None;
        for (const Member* member : members_of(node, field + ".")) {
            const std::string name = field + "." + member->name;
            const Node& value = member->value;
            if (member->name == "from" || member->name == "to") {
                (member->name == "from" ? from : to) = true;
                if (is_good(parameter, name, value)) {
                    (member->name == "from" ? range.from : range.to) = real_of(value);
                }
            } else if (member->name == "steps" && steps == Steps::Needed) {
                counted = true;
                const auto count = number_of<std::uint32_t>(value);
                if (count && *count >= 2 && *count <= Sweep::runs_max) {
                    read.steps = *count;
                } else {
                    refuse(name, value, "a whole number, 2 to " + std::to_string(Sweep::runs_max));
                }
            } else if (member->name == "scale") {
                range.log = value.text == "\"log\"";
                if (!range.log && value.text != "\"linear\"") {
                    refuse(name, value, "linear, log");
                }
            } else {
                refuse(with_line(name, member->line),
                       steps == Steps::Needed ? "from, to, steps, scale" : "from, to, scale", "an unknown name");
            }
        }
        if (!from || !to || !counted) {
            refuse(with_line(field, node.line), steps == Steps::Needed ? "from, to and steps" : "from and to",
                   std::string{"nothing for "} + (!from ? "from"
                                                  : !to ? "to"
                                                        : "steps"));
        }
        if (violations_.size() > before) {
            return false;
        }
        if (!(range.from < range.to)) {
            refuse(field, node, "a \"from\" that is less than \"to\"");
        } else if (range.log && range.from <= 0) {
            refuse(field, node, "a \"from\" above 0 where the scale is log");
        }
        read.range = range;
        return violations_.size() == before;
    }

    void read_grid(const Member& design) {
        std::vector<Dimension> dimensions;
        std::size_t cells = 1;
        for (const Member* member : members_of(design.value, "grid.")) {
            auto read = dimension(*member, "grid." + member->name, Steps::Needed);
            if (!read) {
                continue;
            }
            if (read->range) {
                for (std::size_t i = 0; i < read->steps; ++i) {
                    // Nearest whole numbers may be the same.
                    if (auto value = read->range->step(i, read->steps);
                        read->values.empty() || read->values.back() != value) {
                        read->values.push_back(std::move(value));
                    }
                }
            }
            cells = std::min(cells * read->values.size(), Sweep::runs_max + 1);
            sweep_.swept.push_back(read->parameter);
            dimensions.push_back(*std::move(read));
        }
        if (!violations_.empty() || has_too_many_runs("grid", design.value, cells)) {
            return;
        }
        sweep_.cells.resize(cells);
        for (std::size_t cell = 0; cell < cells; ++cell) {
            std::vector<ParameterValue>& values = sweep_.cells[cell];
            values.resize(dimensions.size());
            std::size_t rest = cell;
            for (std::size_t d = dimensions.size(); d-- > 0; rest /= dimensions[d].values.size()) {
                values[d] = dimensions[d].values[rest % dimensions[d].values.size()];
            }
        }
    }

    void read_latin_hypercube(const Member& design) {
        const std::size_t before = violations_.size();
        const Member* parameters = nullptr;
        std::uint32_t samples = 0;
        for (const Member* member : members_of(design.value, "latin_hypercube.")) {
            const std::string field = "latin_hypercube." + member->name;
            if (member->name == "samples") {
                const auto count = number_of<std::uint32_t>(member->value);
                samples = count.value_or(0);
                if (samples == 0 || samples > Sweep::runs_max) {
                    refuse(field, member->value, "a whole number, 1 to " + std::to_string(Sweep::runs_max));
                }
            } else if (member->name == "parameters") {
                parameters = member;
            } else {
                refuse(with_line(field, member->line), "samples, parameters", "an unknown name");
            }
        }
        if (violations_.size() > before) {
            return;
        }
        if (samples == 0 || parameters == nullptr) {
            return refuse(with_line("latin_hypercube", design.value.line), "samples and parameters",
                          std::string{"nothing for "} + (samples == 0 ? "samples" : "parameters"));
        }
        if (!parameters->value.is_object() || parameters->value.members.empty()) {
            return refuse("latin_hypercube.parameters", parameters->value,
                          "an object: what each parameter is drawn from");
        }
        std::vector<Dimension> dimensions;
        for (const Member* member : members_of(parameters->value, "latin_hypercube.parameters.")) {
            if (auto read = dimension(*member, "latin_hypercube.parameters." + member->name, Steps::None)) {
                sweep_.swept.push_back(read->parameter);
                dimensions.push_back(*std::move(read));
            }
        }
        if (violations_.empty() && !has_too_many_runs("latin_hypercube.samples", design.value, samples)) {
            draw(dimensions, samples);
        }
    }

    /// McKay, Beckman & Conover 1979: of each parameter's range, cut into as many parts of equal chance as there are
    /// samples, every part has one.
    void draw(const std::vector<Dimension>& dimensions, std::uint32_t samples) {
        sweep_.cells.assign(samples, std::vector<ParameterValue>(dimensions.size()));
        const base::RandomKey key{sweep_.seed, base::Purpose::LatinHypercube, 0, 0};
        std::vector<std::uint32_t> part(samples);
        for (std::uint32_t d = 0; d < dimensions.size(); ++d) {
            const Dimension& dimension = dimensions[d];
            base::RandomStream random{key, d};
            std::iota(part.begin(), part.end(), 0u);
            random.shuffle(std::span{part});
            for (std::uint32_t i = 0; i < samples; ++i) {
                const double u = (part[i] + random.uniform()) / samples;
                if (dimension.range) {
                    sweep_.cells[i][d] = dimension.range->drawn(u);
                    continue;
                }
                const std::size_t count = dimension.values.size();
                const auto index = static_cast<std::size_t>(u * static_cast<double>(count));
                sweep_.cells[i][d] = dimension.values[std::min(index, count - 1)];
            }
        }
    }

    std::string name_of(std::size_t cell) const {
        std::string name = "cell " + std::to_string(cell);
        for (std::size_t i = 0; i < sweep_.swept.size(); ++i) {
            name += (i == 0 ? " (" : ", ") + std::string{sweep_.swept[i]->name} + " " +
                    parameters::to_text(sweep_.cells[cell][i]);
        }
        return name + (sweep_.swept.empty() ? ": " : "): ");
    }

    void check_cells() {
        for (const ParameterDescription* parameter : sweep_.swept) {
            sweep_.schedule.remove(parameter->name); // each cell has its own value all along
        }
        std::size_t endless = 0;
        for (std::size_t cell = 0; cell < sweep_.cells.size(); ++cell) {
            const Parameters parameters = sweep_.parameters_of(cell);
            endless += !ends(parameters);
            const auto faults = parameters::validate(parameters);
            for (const Violation& fault : faults) {
                refuse(name_of(cell) + fault.field, fault.allowed, fault.got);
            }
            if (!faults.empty()) {
                continue;
            }
            for (const auto& [generation, fault] : faults_of(sweep_.schedule_of(cell), parameters)) {
                refuse(name_of(cell) + fault.field + " at generation " + std::to_string(generation), fault.allowed,
                       fault.got);
            }
        }
        const std::string wanted = "what ends a run: generations, or one of the parameters generation_limit, "
                                   "stagnation_limit, stop_at_target_fitness, stop_at_extinction";
        if (endless == sweep_.cells.size()) {
            return refuse("generations", wanted, "nothing");
        }
        for (std::size_t cell = 0; endless > 0 && cell < sweep_.cells.size(); ++cell) {
            if (!ends(sweep_.parameters_of(cell))) {
                refuse(name_of(cell) + "generation_limit", wanted, "nothing");
                --endless;
            }
        }
    }

    const Node& document_;
    const LoadExperiment& load_;
    Sweep sweep_;
    std::vector<Violation> violations_;
    const Member* experiment_ = nullptr;
    std::vector<const Member*> designs_;
    std::optional<std::uint32_t> generations_;
    std::optional<std::uint64_t> seed_;
};

} // namespace

Parameters Sweep::parameters_of(std::size_t cell) const {
    Parameters of_cell = parameters;
    for (std::size_t i = 0; i < swept.size(); ++i) {
        set(*swept[i], cells[cell][i], of_cell);
    }
    return of_cell;
}

parameters::Schedule Sweep::schedule_of(std::size_t cell) const {
    parameters::Schedule of_cell = schedule;
    of_cell.begin_with(parameters_of(cell));
    return of_cell;
}

base::Result<Sweep> parse_sweep(std::string_view text, const LoadExperiment& load) {
    if (const auto json = parameters::parse_json(text); !json) {
        return json.error();
    }
    const Node document = Places{text}.value();
    if (!document.is_object()) {
        return refusal(base::RefusalCode::InvalidArgument, "not a sweep: a JSON object is needed");
    }
    base::Result<Sweep> sweep = Reading{document, load}.sweep();
    if (sweep) {
        sweep->text = text;
    }
    return sweep;
}

base::Result<Sweep> load_sweep(const std::string& path) {
    const base::Result<std::string> text = load_text(path, "a sweep file");
    if (!text) {
        return text.error();
    }
    base::Result<Sweep> sweep = parse_sweep(*text, [&](const std::string& experiment) {
        return load_experiment((std::filesystem::path{path}.parent_path() / experiment).string());
    });
    if (!sweep) {
        base::Refusal named = sweep.error();
        named.message = path + ": " + named.message;
        return named;
    }
    return sweep;
}

} // namespace evod::experiments
