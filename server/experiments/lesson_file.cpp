#include "server/experiments/lesson_file.h"

#include "proto/text/suggestion.h"
#include "server/experiments/experiment_file.h"
#include "server/parameters/experiment.h"
#include "server/simulation/observation.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <set>
#include <utility>

namespace evod::experiments {
namespace {

using base::Violation;
using parameters::JsonMember;
using parameters::JsonNode;
using Violations = std::vector<Violation>;

constexpr std::size_t short_text_max = 200, ask_max = 400, text_max = 4000, name_max = 32;
constexpr std::size_t expressions_max = 30; // with those of the law, as many as a request may have

bool is_name(std::string_view text) {
    return !text.empty() && text.size() <= name_max && std::ranges::all_of(text, [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
    });
}

/// The members of a JSON object. Every access names a member that the object may have.
class Fields {
  public:
    Fields(const JsonNode& node, std::string path, Violations& violations)
        : node_{node}, path_{std::move(path)}, violations_{violations} {
        if (!node.is_object()) {
            refuse(path_, node, "an object");
        }
        for (const JsonMember* member : parameters::unique_members(node, prefix(), violations)) {
            unread_.push_back(member);
        }
    }

    std::string path_of(std::string_view name) const { return prefix() + std::string{name}; }
    void refuse(const std::string& path, const JsonNode& node, std::string allowed) {
        violations_.push_back({parameters::with_line(path, node.line), std::move(allowed), node.quoted()});
    }
    /// Returns a member; nullptr if there is none.
    const JsonNode* find(const std::string& name) {
        names_.push_back(name);
        const auto found = std::ranges::find(unread_, name, &JsonMember::name);
        if (found == unread_.end()) {
            return nullptr;
        }
        const JsonNode* value = &(*found)->value;
        unread_.erase(found);
        return value;
    }
    /// Returns a member. Without it, adds a violation.
    const JsonNode* require(const std::string& name) {
        const JsonNode* value = find(name);
        if (value == nullptr && node_.is_object()) {
            violations_.push_back({parameters::with_line(path_of(name), node_.line), "required", "nothing"});
        }
        return value;
    }
    std::string text(const std::string& name, std::size_t bytes_max) { return text_of(require(name), name, bytes_max); }
    std::string text_of(const JsonNode* value, const std::string& name, std::size_t bytes_max) {
        if (value == nullptr) {
            return {};
        }
        std::string text = value->is_string() ? value->string() : std::string{};
        if (text.empty() || text.size() > bytes_max) {
            refuse(path_of(name), *value, "a text of 1 to " + std::to_string(bytes_max) + " bytes");
        }
        return text;
    }
    std::string name(const std::string& field) {
        std::string text = this->text(field, name_max);
        if (!text.empty() && !is_name(text)) {
            violations_.push_back({path_of(field), "1 to 32 characters of a-z 0-9 _", '"' + text + '"'});
        }
        return text;
    }
    double number(const std::string& name) { return number_of(require(name), path_of(name)); }
    double number_of(const JsonNode* value, const std::string& path, double min = -1e12, double max = 1e12) {
        if (value == nullptr) {
            return 0;
        }
        const double number = value->is_number() ? value->real() : std::numeric_limits<double>::quiet_NaN();
        if (!(number >= min && number <= max)) {
            refuse(path, *value, "a number, " + text::number_text(min) + " to " + text::number_text(max));
            return 0;
        }
        return number;
    }
    std::uint64_t whole_of(const JsonNode* value, const std::string& name, std::uint64_t min, std::uint64_t max) {
        const auto number = value == nullptr ? std::nullopt : value->whole_number();
        if (value != nullptr && (!number || *number < min || *number > max)) {
            refuse(path_of(name), *value, "a whole number, " + std::to_string(min) + " to " + std::to_string(max));
        }
        return number.value_or(min);
    }
    /// The elements of a list; none if it has another number of them than allowed.
    std::vector<const JsonNode*> list(const JsonNode* value, const std::string& name, std::size_t min,
                                      std::size_t max) {
        std::vector<const JsonNode*> elements;
        if (value == nullptr) {
            return elements;
        }
        if (!value->is_array() || value->elements.size() < min || value->elements.size() > max) {
            refuse(path_of(name), *value, "a list of " + std::to_string(min) + " to " + std::to_string(max));
            return elements;
        }
        for (const JsonNode& element : value->elements) {
            elements.push_back(&element);
        }
        return elements;
    }
    std::vector<std::string> texts(const JsonNode* value, const std::string& name, std::size_t min, std::size_t max,
                                   std::size_t bytes_max = short_text_max) {
        std::vector<std::string> texts;
        for (const JsonNode* element : list(value, name, min, max)) {
            texts.push_back(text_of(element, name + "[" + std::to_string(texts.size()) + "]", bytes_max));
        }
        return texts;
    }
    /// Refuses the members that no access has named.
    void finish() {
        std::string allowed;
        for (const std::string& name : names_) {
            allowed += (allowed.empty() ? "" : ", ") + name;
        }
        for (const JsonMember* member : unread_) {
            std::string meant = text::did_you_mean(member->name, names_);
            if (!meant.empty()) {
                meant.pop_back(); // violation_text() adds the question mark
            }
            violations_.push_back(
                {parameters::with_line(path_of(member->name), member->line), allowed + meant, base::unknown_name});
        }
    }
    Violations& violations() { return violations_; }

  private:
    std::string prefix() const { return path_.empty() ? path_ : path_ + "."; }

    const JsonNode& node_;
    std::string path_;
    Violations& violations_;
    std::vector<const JsonMember*> unread_;
    std::vector<std::string> names_;
};

Prediction::Axis read_axis(Fields& of, const std::string& name) {
    const JsonNode* node = of.require(name);
    if (node == nullptr) {
        return {};
    }
    Fields fields{*node, of.path_of(name), of.violations()};
    Prediction::Axis axis{
        .label = fields.text("label", short_text_max), .min = fields.number("min"), .max = fields.number("max")};
    if (axis.min >= axis.max) {
        fields.refuse(fields.path_of("max"), *node, "more than min");
    }
    fields.finish();
    return axis;
}

/// Reads `expected`, whose form depends on the kind.
void read_expected(Fields& fields, Prediction& prediction) {
    const JsonNode* node = fields.require("expected");
    if (node == nullptr) {
        return;
    }
    const auto index = [&](const JsonNode* value, const std::string& name) {
        return static_cast<double>(
            fields.whole_of(value, name, 0, std::max<std::size_t>(prediction.options.size(), 1) - 1));
    };
    const std::size_t options = prediction.options.size();
    switch (prediction.kind) {
    case Prediction::Kind::Number:
        prediction.expected = {fields.number_of(node, fields.path_of("expected"), prediction.min, prediction.max)};
        break;
    case Prediction::Kind::Choice:
        prediction.expected = {index(node, "expected")};
        break;
    case Prediction::Kind::Order: {
        for (const JsonNode* element : fields.list(node, "expected", options, options)) {
            prediction.expected.push_back(index(element, "expected"));
        }
        const std::set<double> different{prediction.expected.begin(), prediction.expected.end()};
        if (different.size() < prediction.expected.size()) {
            fields.refuse(fields.path_of("expected"), *node, "each option once");
        }
        break;
    }
    default:
        for (const JsonNode* point : fields.list(node, "expected", 2, 64)) {
            if (!point->is_array() || point->elements.size() != 2) {
                fields.refuse(fields.path_of("expected"), *point, "points [x, y]");
                return;
            }
            const double x =
                fields.number_of(&point->elements[0], fields.path_of("expected"), prediction.x.min, prediction.x.max);
            const double y =
                fields.number_of(&point->elements[1], fields.path_of("expected"), prediction.y.min, prediction.y.max);
            if (!prediction.expected.empty() && x <= prediction.expected[prediction.expected.size() - 2]) {
                fields.refuse(fields.path_of("expected"), *point, "points in ascending order of x");
            }
            prediction.expected.insert(prediction.expected.end(), {x, y});
        }
    }
}

/// Reads a lesson step by step, and follows which names and genes there are.
class LessonReader {
  public:
    explicit LessonReader(Violations& violations) : violations_{violations} {}

    Lesson read(const JsonNode& document) {
        Fields fields{document, "", violations_};
        lesson_.title = fields.text("title", short_text_max);
        lesson_.minutes = static_cast<std::uint32_t>(fields.whole_of(fields.require("minutes"), "minutes", 5, 90));
        lesson_.goals = fields.texts(fields.require("goals"), "goals", 1, 6);
        lesson_.needs = fields.text("needs", ask_max);
        if (const JsonNode* experiment = fields.require("experiment")) {
            read_experiment(*experiment);
        }
        lesson_.seed = base::Seed{fields.whole_of(fields.require("seed"), "seed", 0, (std::uint64_t{1} << 53) - 1)};
        for (const JsonNode* step : fields.list(fields.require("steps"), "steps", 1, 12)) {
            read_step(*step);
        }
        fields.finish();
        return std::move(lesson_);
    }

  private:
    void read_experiment(const JsonNode& node) {
        const auto refuse = [&](std::string allowed, std::string got) {
            violations_.push_back({parameters::with_line("experiment", node.line), std::move(allowed), std::move(got)});
        };
        auto experiment = parameters::read_experiment(node);
        if (!experiment) {
            const base::Refusal refused = experiment.error();
            for (const Violation& violation : refused.violations) {
                violations_.push_back({"experiment." + violation.field, violation.allowed, violation.got});
            }
            if (refused.violations.empty()) {
                refuse("parameters by their names", node.quoted());
            }
            return;
        }
        if (experiment->seed) {
            refuse("no seed: the lesson has one", "a seed");
        } else if (!experiment->schedule.empty()) {
            refuse("no schedule: set parameters in the steps", "values by generation");
        } else if (experiment->parameters.listed_genes.gene_count() > 0) {
            refuse("no list of free genes", "a list");
        } else if (auto fault = fault_without_network(experiment->parameters)) {
            violations_.push_back({"experiment." + fault->field, fault->allowed, fault->got});
        }
        lesson_.parameters = experiment->parameters;
        requested_ = active_ = lesson_.parameters;
    }

    void read_step(const JsonNode& node) {
        LessonStep& step = lesson_.steps.emplace_back();
        earlier_ = numbers_;
        Fields fields{node, "steps[" + std::to_string(lesson_.steps.size() - 1) + "]", violations_};
        step.title = fields.text("title", short_text_max);
        step.text = fields.text("text", text_max);
        if (const JsonNode* predict = fields.find("predict")) {
            step.predict = read_prediction({*predict, fields.path_of("predict"), violations_});
        }
        if (const JsonNode* todo = fields.find("do")) {
            read_do({*todo, fields.path_of("do"), violations_}, step);
        }
        if (const JsonNode* observe = fields.find("observe")) {
            read_observe({*observe, fields.path_of("observe"), violations_}, *observe, step);
        }
        if (const JsonNode* check = fields.find("check")) {
            read_check({*check, fields.path_of("check"), violations_}, *check, step);
        }
        if (const JsonNode* law = fields.find("law")) {
            read_law({*law, fields.path_of("law"), violations_}, *law, step);
        }
        fields.finish();
    }

    Prediction read_prediction(Fields fields) {
        using Kind = Prediction::Kind;
        Prediction prediction{.id = fields.name("id"), .ask = fields.text("ask", ask_max)};
        const JsonNode* kind_node = fields.require("kind");
        static constexpr std::string_view kinds[] = {"number", "choice", "order", "curve", "sentence"};
        const std::string word = kind_node != nullptr && kind_node->is_string() ? kind_node->string() : "";
        const auto kind = std::ranges::find(kinds, word);
        if (kind_node != nullptr && kind == std::end(kinds)) {
            fields.refuse(fields.path_of("kind"), *kind_node, "number, choice, order, curve or sentence");
        }
        if (kind == std::end(kinds)) {
            return prediction;
        }
        prediction.kind = static_cast<Kind>(kind - std::begin(kinds));
        if (prediction.kind == Kind::Number) {
            if (const JsonNode* unit = fields.find("unit")) {
                prediction.unit = fields.text_of(unit, "unit", short_text_max);
            }
            prediction.min = fields.number("min");
            prediction.max = fields.number("max");
        } else if (prediction.kind == Kind::Choice || prediction.kind == Kind::Order) {
            prediction.options = fields.texts(fields.require("options"), "options", 2, 6);
        } else if (prediction.kind == Kind::Curve) {
            prediction.x = read_axis(fields, "x");
            prediction.y = read_axis(fields, "y");
        }
        if (prediction.kind != Kind::Sentence) {
            read_expected(fields, prediction);
        }
        fields.finish();
        if (lesson_.prediction(prediction.id) != nullptr) {
            violations_.push_back({fields.path_of("id"), "an id that no earlier prediction has", prediction.id});
        }
        return prediction;
    }

    void read_do(Fields fields, LessonStep& step) {
        if (const JsonNode* set = fields.find("set")) {
            if (!set->is_object()) {
                fields.refuse(fields.path_of("set"), *set, "an object of parameters and values");
            }
            for (const JsonMember* member : parameters::unique_members(*set, fields.path_of("set."), violations_)) {
                if (auto value = parameters::parameter_value_of(member->value)) {
                    step.set.push_back({member->name, *std::move(value)});
                } else {
                    fields.refuse(fields.path_of("set.") + member->name, member->value,
                                  "a number, true, false or a string");
                }
            }
            auto changed = parameters::assign(requested_, step.set);
            if (changed) {
                requested_ = *changed;
            } else {
                const base::Refusal refused = changed.error();
                for (const Violation& violation : refused.violations) {
                    const JsonMember* member = set->find(violation.field);
                    violations_.push_back({parameters::with_line(fields.path_of("set.") + violation.field,
                                                                 member == nullptr ? set->line : member->line),
                                           violation.allowed, violation.got});
                }
            }
        }
        if (const JsonNode* reset = fields.find("reset")) {
            step.reset = reset->text == "true";
            if (!step.reset) {
                fields.refuse(fields.path_of("reset"), *reset, "true");
            }
            active_ = requested_;
        }
        if (const JsonNode* run = fields.find("run")) {
            step.run = static_cast<std::uint32_t>(fields.whole_of(run, "run", 1, 1000));
        }
        fields.finish();
    }

    /// Parses an expression as the server will, with 1 for each number that is put in.
    void check_expression(const std::string& expression, const std::string& path, const JsonNode& node, bool with_x) {
        std::string unknown;
        const auto tried = with_values(expression, [&](std::string_view name) -> std::optional<double> {
            const bool known = earlier_.contains(std::string{name}) || (with_x && name == "x");
            unknown = known ? unknown : std::string{name};
            return 1;
        });
        if (!unknown.empty()) {
            return violations_.push_back({parameters::with_line(path, node.line),
                                          with_x ? "{x} and numbers that were observed in earlier steps"
                                                 : "numbers that were observed in earlier steps",
                                          "{" + unknown + "}"});
        }
        const auto parsed = simulation::Observation::parse(*tried, simulation::ObservedColumns{active_},
                                                           parameters::with_line(path, node.line));
        if (!parsed) {
            const base::Refusal refused = parsed.error();
            violations_.push_back(refused.violations[0]);
        }
    }

    void read_observe(Fields fields, const JsonNode& node, LessonStep& step) {
        std::size_t count = 0;
        for (const JsonMember& member : node.members) {
            Observed observed{.name = member.name, .expressions = {}, .at = {}};
            const std::string path = fields.path_of(member.name);
            if (!is_name(member.name) || names_.contains(member.name) || member.name == "x") {
                fields.refuse(path, member.value, "a new name of 1 to 32 characters of a-z 0-9 _, but not x");
            }
            if (member.value.is_object()) {
                Fields each{member.value, path, violations_};
                const std::string expression = each.text("each", simulation::Observation::bytes_max);
                for (const JsonNode* at : each.list(each.require("at"), "at", 2, expressions_max)) {
                    observed.at.push_back(each.number_of(at, each.path_of("at")));
                    observed.expressions.push_back(expression);
                }
                each.finish();
                check_expression(expression, path, member.value, true);
            } else {
                observed.expressions = {fields.text_of(&member.value, member.name, simulation::Observation::bytes_max)};
                check_expression(observed.expressions[0], path, member.value, false);
            }
            names_.insert(observed.name);
            if (observed.at.empty()) {
                numbers_.insert(observed.name);
            }
            count += observed.expressions.size();
            step.observe.push_back(std::move(observed));
        }
        if (count > expressions_max) {
            violations_.push_back({fields.path_of(""), "at most " + std::to_string(expressions_max) + " expressions",
                                   std::to_string(count)});
        }
    }

    void read_check(Fields fields, const JsonNode& node, LessonStep& step) {
        using Kind = Check::Kind;
        Check check;
        if (const JsonNode* of = fields.find("of")) {
            check.of = fields.text_of(of, "of", name_max);
        } else if (step.predict) {
            check.of = step.predict->id;
        }
        const Prediction* prediction = lesson_.prediction(check.of);
        if (prediction == nullptr || prediction->kind == Prediction::Kind::Sentence) {
            fields.refuse(fields.path_of("of"), node, "the id of a prediction that can be judged, here or earlier");
            return;
        }
        static constexpr struct {
            const char* name;
            Kind kind;
            Prediction::Kind of;
        } kinds[] = {{"near", Kind::Near, Prediction::Kind::Number},
                     {"argmax", Kind::ArgMax, Prediction::Kind::Choice},
                     {"argmin", Kind::ArgMin, Prediction::Kind::Choice},
                     {"order", Kind::Order, Prediction::Kind::Order},
                     {"curve", Kind::Curve, Prediction::Kind::Curve}};
        std::string allowed;
        bool found = false;
        for (const auto& [name, kind, of] : kinds) {
            if (of != prediction->kind) {
                continue;
            }
            allowed += (allowed.empty() ? "" : " or ") + std::string{name};
            const JsonNode* names = fields.find(name);
            if (names == nullptr) {
                continue;
            }
            found = true;
            check.kind = kind;
            if (kind == Kind::Near || kind == Kind::Curve) {
                check.names = {fields.text_of(names, name, name_max)};
            } else {
                check.names =
                    fields.texts(names, name, prediction->options.size(), prediction->options.size(), name_max);
            }
            for (const std::string& observed : check.names) {
                const bool fits = kind == Kind::Curve ? names_.contains(observed) && !numbers_.contains(observed)
                                                      : numbers_.contains(observed);
                if (!fits) {
                    fields.refuse(fields.path_of(name), *names,
                                  kind == Kind::Curve ? "an observation with each and at"
                                                      : "names of numbers that were observed here or earlier");
                    break;
                }
            }
        }
        if (!found) {
            fields.refuse(fields.path_of("check"), node, allowed + ", for this kind of prediction");
        }
        if (check.kind == Kind::Near || check.kind == Kind::Curve) {
            const JsonNode* percent = check.kind == Kind::Near ? fields.find("within_percent") : nullptr;
            check.in_percent = percent != nullptr;
            check.within =
                fields.number_of(check.in_percent ? percent : fields.require("within"), fields.path_of("within"), 0);
        }
        fields.finish();
        step.check = std::move(check);
    }

    void read_law(Fields fields, const JsonNode& node, LessonStep& step) {
        Law law{.text = fields.text("text", short_text_max),
                .of = fields.text("of", name_max),
                .value = fields.text("value", simulation::Observation::bytes_max),
                .error = fields.text("error", simulation::Observation::bytes_max)};
        if (!numbers_.contains(law.of)) {
            fields.refuse(fields.path_of("of"), node, "the name of a number that was observed here or earlier");
        }
        check_expression(law.value, fields.path_of("value"), node, false);
        check_expression(law.error, fields.path_of("error"), node, false);
        fields.finish();
        step.law = std::move(law);
    }

    Violations& violations_;
    Lesson lesson_;
    parameters::Parameters requested_, active_;
    std::set<std::string> names_, numbers_; // of the observations so far; numbers_: those without `each`
    std::set<std::string> earlier_;         // numbers_ of the earlier steps
};

} // namespace

const Prediction* Lesson::prediction(std::string_view id) const {
    for (const LessonStep& step : steps) {
        if (step.predict && step.predict->id == id) {
            return &*step.predict;
        }
    }
    return nullptr;
}

base::Result<Lesson> parse_lesson(std::string_view text) {
    if (text.size() > Lesson::bytes_max) {
        return refusal(base::RefusalCode::InvalidArgument, "too long: " + std::to_string(text.size()) +
                                                               " bytes, allowed at most " +
                                                               std::to_string(Lesson::bytes_max));
    }
    const auto document = parameters::parse_json(text);
    if (!document) {
        return document.error();
    }
    Violations violations;
    if (!document->is_object()) {
        return refusal(base::RefusalCode::InvalidArgument, "not a lesson: expected a JSON object");
    }
    Lesson lesson = LessonReader{violations}.read(*document);
    if (!violations.empty()) {
        return base::Refusal{.code = base::RefusalCode::InvalidArgument,
                             .message = "invalid lesson",
                             .violations = std::move(violations)};
    }
    return lesson;
}

base::Result<Lesson> load_lesson(const std::string& path) {
    const base::Result<std::string> text = load_text(path, "a lesson");
    if (!text) {
        return text.error();
    }
    base::Result<Lesson> lesson = parse_lesson(*text);
    if (!lesson) {
        base::Refusal named = lesson.error();
        named.message = path + ": " + named.message;
        return named;
    }
    return lesson;
}

} // namespace evod::experiments
