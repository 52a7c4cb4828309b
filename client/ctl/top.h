// Top: the metrics of a server as one page of text.
#pragma once

#include "evod/v1/commands.pb.h"

#include <cstddef>
#include <string>

namespace evod::ctl {

/// The metrics of a server, measured twice.
struct Measurements {
    const v1::Metrics& before;
    const v1::Metrics& after;
    double between_s; // time between the two measurements, > 0
};

/// Formats the current values, and the rates between the two measurements. If not all worlds fit, lists the fastest
/// ones. Lines have at most 80 characters, except lines with long names.
///
/// server     the server's address as the user wrote it: "localhost".
/// now_s      the current time in seconds since 1970.
/// lines_max  maximal number of lines.
std::string top_text(const Measurements& measurements, const std::string& server, double now_s, std::size_t lines_max);

} // namespace evod::ctl
