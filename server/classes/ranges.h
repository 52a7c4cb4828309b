// Ranges: the narrower ranges of parameters in the worlds of a class, so that no world of a member takes the time and
// memory of all others.
//
// Threads      any; no state.
#pragma once

#include "evod/v1/commands.pb.h"
#include "server/base/result.h"
#include "server/classes/class.h"
#include "server/parameters/schedule.h"

#include <string>
#include <vector>

namespace evod::classes {

/// The ranges of a class for which none are requested, in the order of the registry.
const std::vector<Range>& default_ranges();

/// Returns the requested ranges and, for each other parameter, its default range, in the order of the registry. Adds a
/// violation for each invalid one.
///
/// path  "create_class.ranges"
std::vector<Range> ranges_of(const v1::QuotaRanges& request, const std::string& path,
                             std::vector<base::Violation>& violations);
v1::QuotaRanges to_proto(const std::vector<Range>& ranges);

/// Adds a violation for each parameter of a world, and for each value of its schedule, that is outside its range.
///
/// path  "create_class.template"
void check_ranges(const std::vector<Range>& ranges, const parameters::Parameters& parameters,
                  const parameters::Schedule& schedule, const std::string& class_name, const std::string& path,
                  std::vector<base::Violation>& violations);

} // namespace evod::classes
