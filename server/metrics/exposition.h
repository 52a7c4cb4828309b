// Exposition: metrics as Prometheus reads them.
//
// Source  prometheus.io/docs/instrumenting/exposition_formats, "Text-based format", version 0.0.4.
#pragma once

#include "evod/v1/commands.pb.h"

#include <string>

namespace evod::metrics {

constexpr const char* prometheus_content_type = "text/plain; version=0.0.4; charset=utf-8";

/// Of each family its help, its type and its samples, a line each.
std::string to_prometheus(const v1::Metrics& metrics);

} // namespace evod::metrics
