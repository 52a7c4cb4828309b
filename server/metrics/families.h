// Families: fills in the message from which clients read metrics.
#pragma once

#include "evod/v1/commands.pb.h"
#include "server/metrics/counters.h"

#include <initializer_list>
#include <string>
#include <utility>

namespace evod::metrics {

using Labels = std::initializer_list<std::pair<const char*, std::string>>;

/// One family of metrics: samples that differ in their labels.
class Family {
  public:
    explicit Family(v1::MetricFamily& family) : family_{&family} {}
    Family& add(double value, Labels labels = {});
    Family& add(const TimeHistogram& histogram, Labels labels = {});

  private:
    v1::MetricSample& sample(Labels labels);
    v1::MetricFamily* family_;
};

/// Each function adds an empty family. Names must follow the rules of Prometheus: the name of a counter ends in _total,
/// the name of a metric with a unit ends in the unit.
///
/// help  a description of the metric: one sentence without a full stop.
Family add_counter(v1::Metrics& to, const char* name, const char* help);
Family add_gauge(v1::Metrics& to, const char* name, const char* help);
Family add_histogram(v1::Metrics& to, const char* name, const char* help);

} // namespace evod::metrics
