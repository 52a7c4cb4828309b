// Class rules: what holds for all worlds of a class of students, beyond the rules for all worlds.
#pragma once

#include "server/base/result.h"
#include "server/parameters/model_parameters.h"

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace evod::simulation {

/// A narrower range of a parameter of kind number.
struct ParameterRange {
    std::string parameter;
    double min, max; // both inclusive
    friend bool operator==(const ParameterRange&, const ParameterRange&) = default;
};

struct ClassRules {
    bool frozen = false;                // the worlds do not advance, and their owners cannot change them
    std::vector<ParameterRange> ranges; // each parameter at most once
    std::size_t worlds_per_member = 1;

    /// Returns the range of a parameter; nullptr: as for all worlds.
    const ParameterRange* range_of(std::string_view parameter) const;
};

/// Returns the assignments with a number outside its range.
///
/// class_name    for the violations.
/// field_prefix  of the names of the parameters, in the violations.
std::vector<base::Violation> values_outside(const ClassRules& rules, const std::string& class_name,
                                            std::span<const parameters::Assignment> assignments,
                                            std::string_view field_prefix);

} // namespace evod::simulation
