// Top: what a server tells of itself, as a page to be read at a glance.
#pragma once

#include "evod/v1/commands.pb.h"

#include <cstddef>
#include <string>

namespace evod::ctl {

/// Two looks at the metrics of a server.
struct TwoLooks {
    const v1::Metrics& before;
    const v1::Metrics& after;
    double between_s; // > 0
};

/// What holds now, and what has happened between the two looks, per second. At most `lines_max` lines, of which none is
/// longer than 80 characters as long as names are not: of the worlds those that tick the fastest are there.
///
/// server   as it was called: "localhost".
/// now_s    seconds since 1970.
std::string top_text(const TwoLooks& looks, const std::string& server, double now_s, std::size_t lines_max);

} // namespace evod::ctl
