// Families: what is counted, as clients are told it.
#pragma once

#include "evod/v1/commands.pb.h"
#include "server/metrics/counters.h"

#include <initializer_list>
#include <string>
#include <utility>

namespace evod::metrics {

using Labels = std::initializer_list<std::pair<const char*, std::string>>;

/// One family as it is filled in: samples that differ in their labels.
class Family {
  public:
    explicit Family(v1::MetricFamily& family) : family_{&family} {}
    Family& add(double value, Labels labels = {});
    Family& add(const TimeHistogram& histogram, Labels labels = {});

  private:
    v1::MetricSample& sample(Labels labels);
    v1::MetricFamily* family_;
};

/// Names are those of Prometheus: a counter's ends in _total, what has a unit ends in it.
///
/// help  one sentence, without a full stop.
Family add_counter(v1::Metrics& to, const char* name, const char* help);
Family add_gauge(v1::Metrics& to, const char* name, const char* help);
Family add_histogram(v1::Metrics& to, const char* name, const char* help);

} // namespace evod::metrics
