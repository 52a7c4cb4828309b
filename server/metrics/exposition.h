// Exposition: formats metrics in the text format of Prometheus.
//
// Source  prometheus.io/docs/instrumenting/exposition_formats, "Text-based format", version 0.0.4.
#pragma once

#include "evod/v1/commands.pb.h"

#include <string>

namespace evod::metrics {

constexpr const char* prometheus_content_type = "text/plain; version=0.0.4; charset=utf-8";

/// Formats each family as a help line, a type line and one line per sample.
std::string to_prometheus(const v1::Metrics& metrics);

} // namespace evod::metrics
