// Sweep dimension: the values of one parameter in a sweep file, given as a list or as a range.
//
// Threads      none.
// Determinism  the values depend only on the text.
#pragma once

#include "server/parameters/experiment.h"
#include "server/parameters/json_text.h"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace evod::experiments {

/// The errors in a sweep file. Each field is named with its line: "grid.mutation_chance[2] (line 4)".
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

/// A range of numbers.
struct Range {
    double from = 0, to = 1; // from < to
    bool log = false;        // true: logarithmic scale; false: linear scale
    bool whole = false;      // whole numbers only

    /// Returns the i-th of `steps` evenly spaced numbers from `from` to `to`. A whole-number parameter gets the nearest
    /// whole number.
    parameters::ParameterValue step(std::size_t i, std::size_t steps) const;
    /// Returns the number at the quantile u, 0 <= u < 1. For a whole-number parameter, maps u to [from, to + 1) and
    /// rounds down.
    parameters::ParameterValue quantile(double u) const;

  private:
    double between(double t, double low, double high) const;
    parameters::ParameterValue value(double x) const;
};

struct Dimension {
    const parameters::ParameterDescription* parameter = nullptr;
    std::vector<parameters::ParameterValue> values; // values of a list
    std::optional<Range> range;                     // set if the dimension is not a list
    std::size_t steps = 0;                          // number of values of the range, only in a grid
};

/// Sets a parameter to a value. The parameter must allow the value.
void set_parameter(const parameters::ParameterDescription& description, const parameters::ParameterValue& value,
                   parameters::Parameters& parameters);

/// Finds the parameter with the name of the member. If there is none, adds an error and returns nullptr.
const parameters::ParameterDescription* find_swept(const parameters::JsonMember& member, const std::string& field,
                                                   SweepErrors& errors);
/// Converts a value to the type of the parameter. If the parameter does not allow it, adds an error and returns
/// nullopt.
std::optional<parameters::ParameterValue> read_swept_value(const parameters::ParameterDescription& parameter,
                                                           const std::string& field, const parameters::JsonNode& node,
                                                           SweepErrors& errors);
/// Whether a range needs a member "steps". A range of a grid needs it; a range of a Latin hypercube must not have it.
enum class Steps { Needed, None };
/// Reads the list or the range of one parameter. If it is invalid, adds errors and returns nullopt.
///
/// field  name of the parameter in errors: "grid.mutation_chance".
std::optional<Dimension> read_dimension(const parameters::JsonMember& member, const std::string& field, Steps steps,
                                        SweepErrors& errors);

} // namespace evod::experiments
