// Sweep dimension: the values that a sweep file gives to one parameter, as a list or as a range.
//
// Threads      none.
// Determinism  the values follow from the text alone.
#pragma once

#include "server/parameters/experiment.h"
#include "server/parameters/json_text.h"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace evod::experiments {

/// What is wrong with a sweep file. Fields get their line: "grid.mutation_chance[2] (line 4)".
class SweepErrors {
  public:
    void add(std::string field, std::string allowed, std::string got) {
        violations.push_back({std::move(field), std::move(allowed), std::move(got)});
    }
    void add(const std::string& field, const parameters::JsonNode& node, std::string allowed) {
        add(parameters::with_line(field, node.line), std::move(allowed), node.quoted());
    }

    std::vector<base::Violation> violations;
};

/// Numbers between two ends.
struct Range {
    double from = 0, to = 1; // from < to
    bool log = false;        // logarithmic scale, else linear
    bool whole = false;      // whole numbers only

    /// The i-th of `steps` evenly spaced numbers, with both ends. A whole number is the nearest.
    parameters::ParameterValue step(std::size_t i, std::size_t steps) const;
    /// The number at the quantile u, 0 <= u < 1. Each whole number has an equal share of u, by the scale.
    parameters::ParameterValue quantile(double u) const;

  private:
    double between(double t, double low, double high) const;
    parameters::ParameterValue value(double x) const;
};

struct Dimension {
    const parameters::ParameterDescription* parameter = nullptr;
    std::vector<parameters::ParameterValue> values; // of a list
    std::optional<Range> range;                     // instead of a list
    std::size_t steps = 0;                          // of the range, in a grid
};

/// Sets a parameter to a value that it allows.
void set_parameter(const parameters::ParameterDescription& description, const parameters::ParameterValue& value,
                   parameters::Parameters& parameters);

/// The parameter that the member names; nullptr, with an error, if there is none.
const parameters::ParameterDescription* find_swept(const parameters::JsonMember& member, const std::string& field,
                                                   SweepErrors& errors);
/// A value in the type of the parameter; nullopt, with an error, if the parameter does not allow it.
std::optional<parameters::ParameterValue> read_swept_value(const parameters::ParameterDescription& parameter,
                                                           const std::string& field, const parameters::JsonNode& node,
                                                           SweepErrors& errors);
/// Whether a range has "steps": in a grid it must, in a Latin hypercube it cannot.
enum class Steps { Needed, None };
/// Reads the list or the range of one parameter; nullopt, with errors, if it is invalid.
///
/// field  as errors name it: "grid.mutation_chance".
std::optional<Dimension> read_dimension(const parameters::JsonMember& member, const std::string& field, Steps steps,
                                        SweepErrors& errors);

} // namespace evod::experiments
