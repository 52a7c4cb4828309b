#include "server/simulation/observation.h"

#include "proto/text/suggestion.h"
#include "server/base/elementary.h"
#include "server/evolution/gene_layout.h"
#include "server/parameters/model_parameters.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <utility>

namespace evod::simulation {
namespace {

using Kind = Observation::Kind;
using Node = Observation::Node;
using Number = std::optional<double>;

constexpr std::size_t numbers_per_gene = 4; // of GeneStatistics, and of evolution::GeneAccount

// ---- parsing ---------------------------------------------------------------------------------------------------

constexpr std::pair<std::string_view, Kind> functions[] = {
    {"ln", Kind::Ln},         {"exp", Kind::Exp},
    {"sqrt", Kind::Sqrt},     {"abs", Kind::Abs},
    {"mean", Kind::Mean},     {"min", Kind::Min},
    {"max", Kind::Max},       {"sum", Kind::Sum},
    {"slope", Kind::Slope},   {"deviation", Kind::Deviation},
    {"first", Kind::First},   {"argmax", Kind::ArgMax},
    {"argmin", Kind::ArgMin},
};
constexpr std::pair<std::string_view, Kind> comparisons[] = {
    // longer ones first
    {"<=", Kind::LessEqual}, {">=", Kind::GreaterEqual}, {"==", Kind::Equal},
    {"!=", Kind::NotEqual},  {"<", Kind::Less},          {">", Kind::Greater},
};
constexpr std::pair<std::string_view, Observation::Islands> over_islands[] = {
    {"mean", Observation::Islands::Mean},
    {"min", Observation::Islands::Min},
    {"max", Observation::Islands::Max},
    {"sum", Observation::Islands::Sum},
    {"deviation", Observation::Islands::Deviation},
};

/// The value with a name in a table of pairs; nullptr if there is none.
template <class Table>
auto find_named(const Table& table, std::string_view name) -> decltype(&std::begin(table)->second) {
    const auto found = std::ranges::find(table, name, [](const auto& pair) { return pair.first; });
    return found == std::end(table) ? nullptr : &found->second;
}

struct Wrong {
    std::size_t at; // of the first wrong character
    std::string allowed;
};

bool is_name_character(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
}
bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

/// Recursive descent: one function for each level of precedence. Each returns the index of the node that it added. The
/// first mistake moves the parser to the end of the text, so that all functions return.
class Parser {
  public:
    Parser(std::string_view text, const std::vector<std::string>& columns) : text_{text}, columns_{columns} {}

    std::vector<Node> parse() {
        const std::uint32_t whole = comparison();
        skip_spaces();
        if (at_ < text_.size()) {
            refuse(at_, "an operator, or the end");
        } else if (nodes_[whole].is_column) {
            refuse(0, "one number: choose a generation, as in fitness_mean[20], or use a function of a column, as in "
                      "mean(fitness_mean)");
        }
        return std::move(nodes_);
    }
    const std::optional<Wrong>& wrong() const { return wrong_; }

  private:
    /// Notes the first mistake.
    std::uint32_t refuse(std::size_t at, std::string allowed) {
        if (!wrong_) {
            wrong_ = Wrong{at, std::move(allowed)};
        }
        at_ = text_.size();
        return add({.kind = Kind::Number});
    }
    std::uint32_t refuse_depth() {
        return refuse(at_, "at most " + std::to_string(Observation::depth_max) + " levels of nesting");
    }

    std::uint32_t add(const Node& node) {
        nodes_.push_back(node);
        return static_cast<std::uint32_t>(nodes_.size() - 1);
    }
    std::uint32_t add(Kind kind, std::uint32_t a, std::uint32_t b = Observation::none) {
        const bool is_column = nodes_[a].is_column || (b != Observation::none && nodes_[b].is_column);
        return add({.kind = kind, .is_column = is_column, .a = a, .b = b});
    }

    void skip_spaces() {
        while (at_ < text_.size() && text_[at_] == ' ') {
            ++at_;
        }
    }
    bool take(std::string_view token) {
        skip_spaces();
        const bool found = text_.substr(at_).starts_with(token);
        at_ += found ? token.size() : 0;
        return found;
    }
    void expect(std::string_view token) {
        if (!take(token)) {
            refuse(at_, std::string{token});
        }
    }
    std::string_view take_name() {
        const std::size_t begin = at_;
        while (at_ < text_.size() && is_name_character(text_[at_])) {
            ++at_;
        }
        return text_.substr(begin, at_ - begin);
    }

    std::uint32_t comparison() {
        if (depth_ == depth_max) {
            return refuse_depth();
        }
        ++depth_;
        std::uint32_t left = sum();
        const auto found = std::ranges::find_if(comparisons, [this](const auto& pair) { return take(pair.first); });
        if (found != std::end(comparisons)) {
            left = add(found->second, left, sum());
        }
        --depth_;
        return left;
    }
    std::uint32_t sum() {
        std::uint32_t left = product();
        for (;;) {
            if (take("+")) {
                left = add(Kind::Add, left, product());
            } else if (take("-")) {
                left = add(Kind::Subtract, left, product());
            } else {
                return left;
            }
        }
    }
    std::uint32_t product() {
        std::uint32_t left = signed_power();
        for (;;) {
            if (take("*")) {
                left = add(Kind::Multiply, left, signed_power());
            } else if (take("/")) {
                left = add(Kind::Divide, left, signed_power());
            } else {
                return left;
            }
        }
    }
    std::uint32_t signed_power() {
        if (depth_ == depth_max) {
            return refuse_depth();
        }
        ++depth_;
        std::uint32_t node;
        if (take("-")) {
            node = add(Kind::Negative, signed_power());
        } else {
            node = indexed();
            if (take("^")) {
                node = add(Kind::Power, node, signed_power());
            }
        }
        --depth_;
        return node;
    }
    std::uint32_t indexed() {
        const std::size_t begin = at_;
        const std::uint32_t column = primary();
        if (!take("[")) {
            return column;
        }
        if (!nodes_[column].is_column) {
            return refuse(begin, "a column before [ ]");
        }
        const std::uint32_t generation = number_argument();
        expect("]");
        return add({.kind = Kind::At, .a = column, .b = generation});
    }
    std::uint32_t number_argument() {
        skip_spaces();
        const std::size_t begin = at_;
        const std::uint32_t node = comparison();
        if (nodes_[node].is_column) {
            return refuse(begin, "one number, the generation");
        }
        return node;
    }
    std::uint32_t primary() {
        skip_spaces();
        const std::size_t begin = at_;
        if (take("(")) {
            const std::uint32_t inner = comparison();
            expect(")");
            return inner;
        }
        if (at_ < text_.size() && (is_digit(text_[at_]) || text_[at_] == '.')) {
            double value = 0;
            const auto read = std::from_chars(text_.data() + at_, text_.data() + text_.size(), value);
            if (read.ec != std::errc{}) {
                return refuse(begin, "a number of at most 1e308");
            }
            at_ = static_cast<std::size_t>(read.ptr - text_.data());
            return add({.kind = Kind::Number, .number = value});
        }
        const std::string_view name = take_name();
        if (name == "parameter" && take(".")) {
            return parameter();
        }
        if (const Kind* function = find_named(functions, name)) {
            return call(*function, begin);
        }
        const auto column = std::ranges::find(columns_, name);
        if (name.empty() || column == columns_.end()) {
            std::vector<std::string> names = columns_;
            for (const auto& [function, kind] : functions) {
                names.emplace_back(function);
            }
            return refuse(begin, "a number, a column, a function or parameter.NAME" +
                                     (name.empty() ? std::string{} : text::did_you_mean(name, names)));
        }
        Node node{
            .kind = Kind::Column, .is_column = true, .column = static_cast<std::uint32_t>(column - columns_.begin())};
        if (take("@")) {
            choose_islands(node);
        }
        return add(node);
    }
    void choose_islands(Node& node) {
        const std::size_t begin = at_;
        const std::string_view word = take_name();
        if (const auto* over = find_named(over_islands, word)) {
            node.islands = *over;
            return;
        }
        const auto read = std::from_chars(word.data(), word.data() + word.size(), node.island);
        if (word.empty() || read.ec != std::errc{} || read.ptr != word.data() + word.size()) {
            refuse(begin, "the number of an island, or mean, min, max, sum or deviation");
        }
        node.islands = Observation::Islands::One;
    }
    std::uint32_t parameter() {
        const std::size_t begin = at_;
        const std::string_view name = take_name();
        const parameters::ParameterDescription* description = parameters::find_parameter(name);
        if (description == nullptr || std::holds_alternative<std::string>(description->default_value())) {
            std::vector<std::string_view> names;
            for (const parameters::ParameterDescription& known : parameters::parameter_registry()) {
                names.push_back(known.name);
            }
            return refuse(begin, "the name of a parameter that is a number" +
                                     (description == nullptr ? text::did_you_mean(name, names) : std::string{}));
        }
        return add({.kind = Kind::Parameter, .parameter = description});
    }
    std::uint32_t call(Kind function, std::size_t begin) {
        expect("(");
        skip_spaces();
        const std::size_t argument_at = at_;
        const std::uint32_t argument = comparison();
        if (function < Kind::Mean) {
            expect(")");
            return add(function, argument);
        }
        if (!nodes_[argument].is_column) {
            return refuse(argument_at,
                          "a column, as in " + std::string{text_.substr(begin, argument_at - begin)} + "fitness_mean)");
        }
        Node node{.kind = function, .a = argument};
        if (take(",")) {
            node.b = number_argument();
            expect(",");
            node.c = number_argument();
        }
        expect(")");
        return add(node);
    }

    static constexpr std::size_t depth_max = 2 * Observation::depth_max; // two functions count each parenthesis

    std::string_view text_;
    const std::vector<std::string>& columns_;
    std::vector<Node> nodes_;
    std::size_t at_ = 0, depth_ = 0;
    std::optional<Wrong> wrong_;
};

// ---- evaluation ------------------------------------------------------------------------------------------------

Number finite(double value) {
    return std::isfinite(value) ? Number{value} : std::nullopt;
}

double deviation_of(std::span<const double> values, double mean) {
    double sum = 0;
    for (const double value : values) {
        sum += (value - mean) * (value - mean);
    }
    return std::sqrt(sum / static_cast<double>(values.size()));
}
double sum_of(std::span<const double> values) {
    double sum = 0;
    for (const double value : values) {
        sum += value;
    }
    return sum;
}

Number power(double base, double exponent) {
    constexpr double whole_max = 64;
    if (exponent == std::floor(exponent) && std::abs(exponent) <= whole_max) {
        double product = 1;
        for (int i = 0; i < std::abs(exponent); ++i) {
            product *= base;
        }
        return finite(exponent < 0 ? 1 / product : product);
    }
    return base > 0 || (base == 0 && exponent > 0) ? finite(base::pow(base, exponent)) : std::nullopt;
}

Number of_one(Kind kind, double x) {
    switch (kind) {
    case Kind::Negative:
        return -x;
    case Kind::Ln:
        return x >= std::numeric_limits<double>::min() ? finite(base::log(x)) : std::nullopt;
    case Kind::Exp:
        return x <= 700 ? Number{base::exp(x)} : std::nullopt;
    case Kind::Sqrt:
        return x >= 0 ? Number{std::sqrt(x)} : std::nullopt;
    default:
        return std::abs(x);
    }
}

Number of_two(Kind kind, double x, double y) {
    switch (kind) {
    case Kind::Add:
        return finite(x + y);
    case Kind::Subtract:
        return finite(x - y);
    case Kind::Multiply:
        return finite(x * y);
    case Kind::Divide:
        return finite(x / y);
    case Kind::Power:
        return power(x, y);
    case Kind::Less:
        return x < y;
    case Kind::LessEqual:
        return x <= y;
    case Kind::Greater:
        return x > y;
    case Kind::GreaterEqual:
        return x >= y;
    case Kind::Equal:
        return x == y;
    default:
        return x != y;
    }
}

/// The slope of the line of least squares.
Number slope_of(std::span<const double> at, std::span<const double> values) {
    const auto count = static_cast<double>(values.size());
    const double x_mean = sum_of(at) / count, y_mean = sum_of(values) / count;
    double xy = 0, xx = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
        xy += (at[i] - x_mean) * (values[i] - y_mean);
        xx += (at[i] - x_mean) * (at[i] - x_mean);
    }
    return finite(xy / xx);
}

Number over_generations(Kind kind, std::span<const double> at, std::span<const double> values) {
    if (kind == Kind::First) {
        const auto found = std::ranges::find_if(values, [](double value) { return value != 0; });
        return found == values.end() ? std::nullopt : Number{at[static_cast<std::size_t>(found - values.begin())]};
    }
    if (values.empty()) {
        return std::nullopt;
    }
    const auto largest = std::ranges::max_element(values), smallest = std::ranges::min_element(values);
    const double mean = sum_of(values) / static_cast<double>(values.size());
    switch (kind) {
    case Kind::Mean:
        return finite(mean);
    case Kind::Min:
        return *smallest;
    case Kind::Max:
        return *largest;
    case Kind::Sum:
        return finite(sum_of(values));
    case Kind::Deviation:
        return finite(deviation_of(values, mean));
    case Kind::Slope:
        return slope_of(at, values);
    case Kind::ArgMax:
        return at[static_cast<std::size_t>(largest - values.begin())];
    default:
        return at[static_cast<std::size_t>(smallest - values.begin())];
    }
}

/// Evaluates the nodes of one expression. Each node that is not a column is computed once.
class Evaluator {
  public:
    Evaluator(std::span<const Node> nodes, const ObservedRun& run, std::uint64_t& steps_left)
        : nodes_{nodes}, run_{run}, steps_left_{steps_left}, known_(nodes.size()) {}

    /// The value of a node in the generation at this index of the history, which only columns need.
    Number value(std::uint32_t index, std::size_t generation = 0) {
        const Node& node = nodes_[index];
        if (node.is_column) {
            return compute(node, generation);
        }
        if (!known_[index]) {
            known_[index] = Known{compute(node, generation)};
        }
        return known_[index]->value;
    }

  private:
    struct Known {
        Number value;
    };

    /// Counts work. Returns whether it may be done.
    bool take_steps(std::uint64_t steps) {
        const bool enough = steps <= steps_left_;
        steps_left_ = enough ? steps_left_ - steps : 0;
        return enough;
    }

    Number compute(const Node& node, std::size_t generation) {
        if (!take_steps(1)) {
            return std::nullopt;
        }
        switch (node.kind) {
        case Kind::Number:
            return node.number;
        case Kind::Parameter:
            return parameter(*node.parameter);
        case Kind::Column:
            return column(node, run_.history[generation]);
        case Kind::At: {
            const auto there = place_of(value(node.b));
            return there ? value(node.a, *there) : std::nullopt;
        }
        default:
            break;
        }
        if (node.kind >= Kind::Mean) {
            return aggregate(node);
        }
        const Number a = value(node.a, generation);
        if (node.b == Observation::none) {
            return a ? of_one(node.kind, *a) : std::nullopt;
        }
        const Number b = value(node.b, generation);
        return a && b ? of_two(node.kind, *a, *b) : std::nullopt;
    }

    Number parameter(const parameters::ParameterDescription& description) const {
        const parameters::ParameterValue value = description.get(run_.parameters);
        if (const bool* flag = std::get_if<bool>(&value)) {
            return *flag;
        }
        const auto* count = std::get_if<std::uint32_t>(&value);
        return count != nullptr ? *count : std::get<double>(value);
    }

    Number column(const Node& node, const GenerationRows& rows) {
        if (node.islands == Observation::Islands::One) {
            return node.island < rows.size() ? ObservedColumns::read(rows[node.island], node.column) : std::nullopt;
        }
        if (!take_steps(rows.size())) {
            return std::nullopt;
        }
        std::vector<double> values;
        for (const GenerationStatistics& row : rows) {
            const Number value = ObservedColumns::read(row, node.column);
            if (!value) {
                return std::nullopt;
            }
            values.push_back(*value);
        }
        const double mean = sum_of(values) / static_cast<double>(values.size());
        switch (node.islands) {
        case Observation::Islands::Min:
            return std::ranges::min(values);
        case Observation::Islands::Max:
            return std::ranges::max(values);
        case Observation::Islands::Sum:
            return sum_of(values);
        case Observation::Islands::Deviation:
            return deviation_of(values, mean);
        default:
            return mean;
        }
    }

    /// The index in the history of a generation: a positive number, or a negative one that counts from the last.
    std::optional<std::size_t> place_of(Number generation) const {
        if (!generation || run_.history.empty() || *generation != std::floor(*generation)) {
            return std::nullopt;
        }
        const auto size = static_cast<double>(run_.history.size());
        const auto first = static_cast<double>(run_.history.front().front().generation);
        const double place = *generation < 0 ? size + *generation : *generation - first;
        return place >= 0 && place < size ? std::optional{static_cast<std::size_t>(place)} : std::nullopt;
    }

    Number aggregate(const Node& node) {
        std::size_t first = 0, end = run_.history.size();
        if (node.b != Observation::none) {
            const auto from = place_of(value(node.b)), to = place_of(value(node.c));
            if (!from || !to) {
                return std::nullopt;
            }
            first = *from;
            end = *to + 1;
        }
        std::vector<double> at, values;
        for (std::size_t generation = first; generation < end; ++generation) {
            if (const Number number = value(node.a, generation)) {
                at.push_back(static_cast<double>(run_.history[generation].front().generation));
                values.push_back(*number);
            }
        }
        return steps_left_ == 0 ? std::nullopt : over_generations(node.kind, at, values);
    }

    std::span<const Node> nodes_;
    const ObservedRun& run_;
    std::uint64_t& steps_left_;
    std::vector<std::optional<Known>> known_;
};

} // namespace

ObservedColumns::ObservedColumns(std::span<const std::string> gene_names) {
    const auto add = [this](const std::string& name, auto) { names_.push_back(name); };
    const GenerationStatistics any{.genes = std::vector<GeneStatistics>(gene_names.size())};
    for_each_number(any, add);
    for_each_gene_number(any, gene_names, add);
    evolution::for_each_number(std::nullopt, gene_names, add);
    for_each_colony_number(ColonyStatistics{}, add);
    const std::size_t of_prey = names_.size();
    for (std::size_t i = 0; i < of_prey; ++i) {
        names_.push_back("predators_" + names_[i]);
    }
}

ObservedColumns::ObservedColumns(const parameters::Parameters& parameters)
    : ObservedColumns{evolution::gene_layout(parameters).names} {}

std::optional<double> ObservedColumns::read(const GenerationStatistics& statistics, std::size_t column) {
    std::optional<double> found;
    std::size_t index = 0;
    for_each_number(statistics, [&](const char*, auto number) {
        if (index++ == column) {
            found = static_cast<double>(number);
        }
    });
    if (found) {
        return found;
    }
    const std::size_t in_genes = column - index, gene_count = statistics.genes.size();
    if (in_genes < gene_count * numbers_per_gene) {
        const GeneStatistics& gene = statistics.genes[in_genes / numbers_per_gene];
        const double numbers[numbers_per_gene] = {gene.mean, gene.deviation, gene.min, gene.max};
        return numbers[in_genes % numbers_per_gene];
    }
    const std::size_t in_account = in_genes - gene_count * numbers_per_gene;
    if (in_account < gene_count * numbers_per_gene) {
        if (!statistics.account || in_account / numbers_per_gene >= statistics.account->size()) {
            return std::nullopt;
        }
        const evolution::GeneAccount& gene = (*statistics.account)[in_account / numbers_per_gene];
        const double numbers[numbers_per_gene] = {gene.selection, gene.transmission, gene.migration, gene.change};
        return numbers[in_account % numbers_per_gene];
    }
    index = column - (in_account - gene_count * numbers_per_gene);
    for_each_colony_number(statistics.colony.value_or(ColonyStatistics{}), [&](const char*, auto number) {
        if (index++ == column && statistics.colony) {
            found = static_cast<double>(number);
        }
    });
    if (column < index) {
        return found;
    }
    return statistics.predators.empty() ? std::nullopt : read(statistics.predators.front(), column - index);
}

base::Result<Observation> Observation::parse(std::string_view text, const ObservedColumns& columns,
                                             const std::string& field) {
    const auto wrong = [&](std::string allowed, std::string got) {
        return base::Refusal{.code = base::RefusalCode::InvalidArgument,
                             .message = "invalid expression",
                             .violations = {{field, std::move(allowed), std::move(got)}}};
    };
    if (text.size() > bytes_max) {
        return wrong("at most " + std::to_string(bytes_max) + " bytes", std::to_string(text.size()) + " bytes");
    }
    Parser parser{text, columns.names()};
    std::vector<Node> nodes = parser.parse();
    if (const std::optional<Wrong>& fault = parser.wrong()) {
        constexpr std::size_t quoted_max = 24;
        std::string rest{text.substr(fault->at, quoted_max)};
        std::ranges::replace_if(
            rest, [](char c) { return c < ' ' || c > '~'; }, '?');
        return wrong(fault->allowed, (rest.empty() ? std::string{"the end"} : '"' + rest + '"') + " at character " +
                                         std::to_string(fault->at + 1));
    }
    return Observation{std::move(nodes)};
}

std::optional<double> Observation::value(const ObservedRun& run, std::uint64_t& steps_left) const {
    return Evaluator{nodes_, run, steps_left}.value(static_cast<std::uint32_t>(nodes_.size() - 1));
}

} // namespace evod::simulation
