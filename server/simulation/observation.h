// Observations: numbers that are computed from the statistics of a run, such as "mean(fitness_mean, 10, 20)".
// docs/LESSONS.md describes the language. An expression is parsed once into nodes, and then evaluated.
//
// Threads      any; no state is shared.
// Determinism  the same statistics give the same bits on every processor (base/elementary.h).
#pragma once

#include "server/base/result.h"
#include "server/simulation/statistics.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace evod::parameters {
struct ParameterDescription;
}

namespace evod::simulation {

/// What an observation reads.
struct ObservedRun {
    const History& history;
    const parameters::Parameters& parameters;
};

/// The names that an expression can contain besides those of functions and parameters: the columns of the statistics,
/// those of colonies, and all of them once more for the predators: "predators_count_mean".
class ObservedColumns {
  public:
    /// gene_names  the genes of the world, in chromosome order.
    explicit ObservedColumns(std::span<const std::string> gene_names);
    explicit ObservedColumns(const parameters::Parameters& parameters);

    const std::vector<std::string>& names() const { return names_; }
    /// The value of a column on an island; nullopt: there is none in this generation.
    static std::optional<double> read(const GenerationStatistics& statistics, std::size_t column);

  private:
    std::vector<std::string> names_;
};

class Observation {
  public:
    static constexpr std::size_t bytes_max = 256, depth_max = 32; // of parentheses, functions, signs and powers
    /// The numbers that the observations of one request may read and compute together.
    static constexpr std::uint64_t steps_max = 4'000'000;

    /// Parses an expression. Refused with one violation of `field`: what is allowed, and what stands where instead.
    static base::Result<Observation> parse(std::string_view text, const ObservedColumns& columns,
                                           const std::string& field);

    /// Evaluates the expression; nullopt: the run has no such value, or `steps_left` does not suffice.
    ///
    /// steps_left  is reduced by the work.
    std::optional<double> value(const ObservedRun& run, std::uint64_t& steps_left) const;

    enum class Kind : std::uint8_t {
        Number,
        Column,
        Parameter,
        At, // leaves, and a column in a generation
        Negative,
        Ln,
        Exp,
        Sqrt,
        Abs, // of `a`
        Add,
        Subtract,
        Multiply,
        Divide,
        Power, // of `a` and `b`
        Less,
        LessEqual,
        Greater,
        GreaterEqual,
        Equal,
        NotEqual, // of `a` and `b`
        Mean,
        Min,
        Max,
        Sum,
        Deviation,
        Slope,
        First,
        ArgMax,
        ArgMin, // of column `a`, from `b` to `c`
    };
    enum class Islands : std::uint8_t { Mean, Min, Max, Sum, Deviation, One };
    static constexpr std::uint32_t none = UINT32_MAX;
    struct Node {
        Kind kind;
        bool is_column = false;                     // a number for each generation
        std::uint32_t a = none, b = none, c = none; // indices of nodes before this one
        double number = 0;
        std::uint32_t column = 0;
        Islands islands = Islands::Mean;
        std::uint32_t island = 0; // of Islands::One
        const parameters::ParameterDescription* parameter = nullptr;
    };

  private:
    explicit Observation(std::vector<Node> nodes) : nodes_{std::move(nodes)} {}

    std::vector<Node> nodes_; // the last one is the whole expression
};

} // namespace evod::simulation
