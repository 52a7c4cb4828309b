// Lesson files: texts, predictions, what to run, observations and checks, as JSON. docs/LESSONS.md documents the
// format.
//
// Threads      none.
#pragma once

#include "server/base/random.h"
#include "server/base/result.h"
#include "server/parameters/model_parameters.h"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace evod::experiments {

/// What a pupil predicts, or what was observed in its place: a number; the index of an option; the indices of all
/// options in order; the coordinates x, y, x, y … of the points of a curve.
using Answer = std::vector<double>;

struct Prediction {
    enum class Kind : std::uint8_t { Number, Choice, Order, Curve, Sentence };
    struct Axis {
        std::string label;
        double min = 0, max = 1;
    };
    std::string id, ask;
    Kind kind = Kind::Sentence;
    std::string unit = {};                 // of a number
    double min = 0, max = 1;               // of a number
    std::vector<std::string> options = {}; // of a choice or an order
    Axis x = {}, y = {};                   // of a curve
    Answer expected = {};                  // empty: of a sentence
};

/// An observation: one expression, or one for each place.
struct Observed {
    std::string name;
    std::vector<std::string> expressions; // may contain {names} of earlier observations
    std::vector<double> at;               // empty: one expression
};

struct Check {
    enum class Kind : std::uint8_t { Near, ArgMax, ArgMin, Order, Curve };
    Kind kind = Kind::Near;
    std::string of;                 // id of the prediction
    std::vector<std::string> names; // of observations; one of Near and Curve, otherwise one for each option
    double within = 0;
    bool in_percent = false;
};

struct Law {
    std::string text, of, value, error; // `of`: the name of an observation; value and error: expressions
};

struct LessonStep {
    std::string title, text;
    std::optional<Prediction> predict;
    std::vector<parameters::Assignment> set;
    bool reset = false;
    std::uint32_t run = 0; // number of generations
    std::vector<Observed> observe;
    std::optional<Check> check;
    std::optional<Law> law;
};

struct Lesson {
    static constexpr std::size_t bytes_max = 64 << 10;

    std::string title, needs;
    std::uint32_t minutes = 0;
    std::vector<std::string> goals;
    parameters::Parameters parameters;
    base::Seed seed{1};
    std::vector<LessonStep> steps;

    /// The prediction with this id; nullptr if there is none.
    const Prediction* prediction(std::string_view id) const;
};

/// Parses the text of a lesson. Violations name the JSON path with its line: "steps[2].predict.ask (line 31)".
base::Result<Lesson> parse_lesson(std::string_view text);

/// Reads a lesson file. The message of a refusal begins with the path.
base::Result<Lesson> load_lesson(const std::string& path);

/// Replaces each {name} in an expression by the number that value_of(name) returns, in parentheses; nullopt if it
/// returns nullopt for one of them.
template <class ValueOf>
std::optional<std::string> with_values(std::string_view expression, ValueOf&& value_of);

} // namespace evod::experiments

#include "proto/text/number_text.h"

template <class ValueOf>
std::optional<std::string> evod::experiments::with_values(std::string_view expression, ValueOf&& value_of) {
    std::string text;
    for (;;) {
        const std::size_t open = expression.find('{'), close = expression.find('}', open);
        if (close == std::string_view::npos) {
            return text += expression;
        }
        const std::optional<double> value = value_of(expression.substr(open + 1, close - open - 1));
        if (!value) {
            return std::nullopt;
        }
        text += expression.substr(0, open);
        text += '(' + text::number_text(*value) + ')';
        expression.remove_prefix(close + 1);
    }
}
