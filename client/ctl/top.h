// Top: the metrics of a server as one page of text.
#pragma once

#include "evod/v1/commands.pb.h"

#include <cstddef>
#include <string>

namespace evod::ctl {

/// Two measurements of a server's metrics.
struct Measurements {
    const v1::Metrics& before;
    const v1::Metrics& after;
    double between_s; // > 0
};

/// Formats the current values, and the rates between the two measurements. At most `lines_max` lines of at most 80 characters
/// (longer only for long names). If not all worlds fit, the fastest ones are listed.
///
/// server   the server's address as the user wrote it: "localhost".
/// now_s    seconds since 1970.
std::string top_text(const Measurements& measurements, const std::string& server, double now_s, std::size_t lines_max);

} // namespace evod::ctl
