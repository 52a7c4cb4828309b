#include "server/metrics/exposition.h"

#include "proto/text/number_text.h"

#include <cmath>
#include <cstdint>
#include <string_view>

namespace evod::metrics {
namespace {

/// Escapes backslashes and line ends. In label values it also escapes quotes.
std::string escaped(std::string_view text, bool quotes) {
    std::string safe;
    for (const char c : text) {
        if (c == '\n') {
            safe += "\\n";
            continue;
        }
        if (c == '\\' || (quotes && c == '"')) {
            safe += '\\';
        }
        safe += c;
    }
    return safe;
}

/// Formats a number for Prometheus. Whole numbers have no exponent as long as a double represents them exactly.
std::string sample_text(double value) {
    if (std::isnan(value)) {
        return "NaN";
    }
    if (std::isinf(value)) {
        return value > 0 ? "+Inf" : "-Inf";
    }
    constexpr double exact_max = 9007199254740992; // 2^53
    return value == std::trunc(value) && std::abs(value) <= exact_max ? std::to_string(static_cast<std::int64_t>(value))
                                                                      : text::number_text(value);
}

/// Formats labels: {world="default",le="0.1"}. Returns an empty string if there are none.
std::string labels_text(const v1::MetricSample& sample, const std::string& bound = {}) {
    std::string text;
    const auto add = [&text](std::string_view name, std::string_view value) {
        text += text.empty() ? '{' : ',';
        text += std::string{name} + "=\"" + escaped(value, true) + '"';
    };
    for (const v1::MetricLabel& label : sample.labels()) {
        add(label.name(), label.value());
    }
    if (!bound.empty()) {
        add("le", bound);
    }
    return text.empty() ? text : text + '}';
}

const char* type_of(v1::MetricKind kind) {
    switch (kind) {
    case v1::METRIC_KIND_COUNTER:
        return "counter";
    case v1::METRIC_KIND_GAUGE:
        return "gauge";
    case v1::METRIC_KIND_HISTOGRAM:
        return "histogram";
    default:
        return "untyped";
    }
}

} // namespace

std::string to_prometheus(const v1::Metrics& metrics) {
    std::string text;
    const auto line = [&text](const std::string& name, const std::string& labels, const std::string& value) {
        text += name + labels + ' ' + value + '\n';
    };
    for (const v1::MetricFamily& family : metrics.families()) {
        const std::string& name = family.name();
        text += "# HELP " + name + ' ' + escaped(family.help(), false) + '\n';
        text += "# TYPE " + name + ' ' + type_of(family.kind()) + '\n';
        for (const v1::MetricSample& sample : family.samples()) {
            if (family.kind() != v1::METRIC_KIND_HISTOGRAM) {
                line(name, labels_text(sample), sample_text(sample.value()));
                continue;
            }
            const v1::MetricHistogram& histogram = sample.histogram();
            std::uint64_t so_far = 0; // in this format each bucket includes the counts of all lower buckets
            for (int i = 0; i < histogram.counts_size(); ++i) {
                so_far += histogram.counts(i);
                const bool bounded = i < histogram.bounds_size();
                line(name + "_bucket", labels_text(sample, bounded ? sample_text(histogram.bounds(i)) : "+Inf"),
                     std::to_string(so_far));
            }
            line(name + "_sum", labels_text(sample), sample_text(histogram.sum()));
            line(name + "_count", labels_text(sample), std::to_string(so_far));
        }
    }
    return text;
}

} // namespace evod::metrics
