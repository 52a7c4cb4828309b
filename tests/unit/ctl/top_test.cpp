#include "client/ctl/top.h"

#include "client/ctl/text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>
#include <string>
#include <vector>

namespace evod::ctl {
namespace {

using ::testing::HasSubstr;

class Metrics {
  public:
    Metrics& add(const std::string& name, double value, const std::string& label = {}) {
        v1::MetricSample& sample = of(name, label);
        sample.set_value(value);
        return *this;
    }
    Metrics& add_ticks(const std::string& world, std::vector<std::uint64_t> counts, double sum) {
        auto& histogram = *of("evod_tick_seconds", world).mutable_histogram();
        for (const double bound : {0.001, 0.002, 0.005}) {
            histogram.add_bounds(bound);
        }
        histogram.mutable_counts()->Assign(counts.begin(), counts.end());
        histogram.set_sum(sum);
        return *this;
    }
    v1::Metrics metrics;

  private:
    v1::MetricSample& of(const std::string& name, const std::string& label) {
        auto* const families = metrics.mutable_families();
        auto found = std::find_if(families->begin(), families->end(), [&](const auto& f) { return f.name() == name; });
        v1::MetricFamily& family = found == families->end() ? *families->Add() : *found;
        family.set_name(name);
        v1::MetricSample& sample = *family.add_samples();
        if (!label.empty()) {
            v1::MetricLabel& with = *sample.add_labels();
            with.set_name("label");
            with.set_value(label);
        }
        return sample;
    }
};

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream stream{text};
    for (std::string line; std::getline(stream, line);) {
        lines.push_back(line);
    }
    return lines;
}

std::string top(const Metrics& before, const Metrics& after, std::size_t lines_max = 24) {
    return top_text({before.metrics, after.metrics, 2}, "lab", 1000, lines_max);
}

TEST(Top, RatesAreIncreasesPerSecond) {
    Metrics before, after;
    before.add("evod_snapshots_sent_total", 100).add("evod_sent_bytes_total", 1024, "stream");
    after.add("evod_snapshots_sent_total", 220).add("evod_sent_bytes_total", 5120, "stream");
    const std::string text = top(before, after);
    EXPECT_THAT(text, HasSubstr("snapshots      60/s, dropped 0/s"));
    EXPECT_THAT(text, HasSubstr("2.0 KiB/s of snapshots, 0 B/s of replies"));
}

TEST(Top, ARestartedServerHasNoNegativeRates) {
    Metrics before, after;
    before.add("evod_requests_total", 100)
        .add_ticks("default", {5, 0, 0, 0}, 1)
        .add("evod_ticks_per_second", 1, "default");
    after.add("evod_requests_total", 3)
        .add_ticks("default", {1, 1, 0, 0}, 0.002)
        .add("evod_ticks_per_second", 1, "default");
    const std::string text = top(before, after);
    EXPECT_THAT(text, HasSubstr("waiting; 0/s"));
    EXPECT_THAT(text, HasSubstr("1.0 ms")) << "the mean of its two ticks";
}

TEST(Top, TickTimesAreThoseBetweenMeasurements) {
    Metrics before, after;
    before.add_ticks("default", {1000, 0, 0, 0}, 0.5);
    after.add_ticks("default", {1000, 98, 1, 1}, 0.7).add("evod_ticks_per_second", 50, "default");
    const std::string text = top(before, after);
    EXPECT_THAT(text, HasSubstr("default       50  ████████████████     2.0 ms  1.5 ms  5.0 ms")) << text;
}

TEST(Top, TicksBeyondTheLastBoundAreMarked) {
    Metrics before, after;
    after.add_ticks("default", {0, 0, 0, 4}, 4).add("evod_ticks_per_second", 4, "default");
    EXPECT_THAT(top(before, after), HasSubstr("> 5.0 ms"));
}

TEST(Top, FitsTheTerminalAndShowsTheFastestWorlds) {
    Metrics before, after;
    for (int i = 0; i < 64; ++i) {
        after.add("evod_ticks_per_second", i, "world-" + std::to_string(i));
    }
    for (const char* role : {"admin", "controller", "viewer", "none"}) {
        after.add("evod_sessions", 64, role);
    }
    for (const char* thread : {"network", "simulation", "storage", "packing"}) {
        after.add("evod_thread_cpu_seconds_total", 2, thread);
    }
    after.add("evod_storage_state", 1, "failing").add("evod_journal_waiting_bytes", 5e6);
    const std::string text = top(before, after, 21);
    const auto lines = lines_of(text);
    EXPECT_EQ(lines.size(), 21u) << text;
    for (const std::string& line : lines) {
        EXPECT_LE(width_of(line), 80u) << line;
    }
    EXPECT_THAT(text, HasSubstr("world-63"));
    EXPECT_EQ(text.find("world-10 "), std::string::npos);
    EXPECT_THAT(lines.back(), ::testing::MatchesRegex("and [0-9]+ more"));
    EXPECT_THAT(text, HasSubstr("disk           failing; 4.8 MiB waiting"));
}

TEST(Top, ListsTheLimitsThatWereReached) {
    Metrics before, after;
    EXPECT_EQ(top(before, after).find("limits"), std::string::npos);
    after.add("evod_limit_reached_total", 0, "requests").add("evod_limit_reached_total", 3, "sessions");
    EXPECT_THAT(top(before, after), HasSubstr("limits reached sessions 3\n"));
}

TEST(Top, BarsShowSharesOfAProcessorAndOfTheFastest) {
    Metrics before, after;
    before.add("evod_thread_cpu_seconds_total", 10, "network");
    after.add("evod_thread_cpu_seconds_total", 11, "network")
        .add("evod_ticks_per_second", 100, "fast")
        .add("evod_ticks_per_second", 25, "slow");
    const std::string text = top(before, after);
    EXPECT_THAT(text, HasSubstr("  network      ████████          50 %\n"));
    EXPECT_THAT(text, HasSubstr("fast       100  ████████████████ "));
    EXPECT_THAT(text, HasSubstr("slow        25  ████             "));
}

TEST(Top, AServerWithoutRecordingIsNamed) {
    EXPECT_THAT(top({}, {}), HasSubstr("disk           runs are not recorded\n"));
    EXPECT_THAT(top({}, {}), HasSubstr("no worlds\n"));
}

} // namespace
} // namespace evod::ctl
