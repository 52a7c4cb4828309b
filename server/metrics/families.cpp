#include "server/metrics/families.h"

namespace evod::metrics {
namespace {

Family add_family(v1::Metrics& to, const char* name, const char* help, v1::MetricKind kind) {
    v1::MetricFamily& family = *to.add_families();
    family.set_name(name);
    family.set_help(help);
    family.set_kind(kind);
    return Family{family};
}

double seconds(TimeHistogram::duration time) {
    return std::chrono::duration<double>{time}.count();
}

} // namespace

v1::MetricSample& Family::sample(Labels labels) {
    v1::MetricSample& sample = *family_->add_samples();
    for (const auto& [name, value] : labels) {
        v1::MetricLabel& label = *sample.add_labels();
        label.set_name(name);
        label.set_value(value);
    }
    return sample;
}

Family& Family::add(double value, Labels labels) {
    sample(labels).set_value(value);
    return *this;
}

Family& Family::add(const TimeHistogram& histogram, Labels labels) {
    v1::MetricHistogram& to = *sample(labels).mutable_histogram();
    for (const auto bound : TimeHistogram::bounds) {
        to.add_bounds(seconds(bound));
    }
    for (std::size_t bucket = 0; bucket <= TimeHistogram::bounds.size(); ++bucket) {
        to.add_counts(histogram.count(bucket));
    }
    to.set_sum(histogram.sum_s());
    return *this;
}

Family add_counter(v1::Metrics& to, const char* name, const char* help) {
    return add_family(to, name, help, v1::METRIC_KIND_COUNTER);
}
Family add_gauge(v1::Metrics& to, const char* name, const char* help) {
    return add_family(to, name, help, v1::METRIC_KIND_GAUGE);
}
Family add_histogram(v1::Metrics& to, const char* name, const char* help) {
    return add_family(to, name, help, v1::METRIC_KIND_HISTOGRAM);
}

} // namespace evod::metrics
