#include "server/metrics/exposition.h"
#include "server/metrics/families.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <limits>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

namespace evod::metrics {
namespace {

using namespace std::chrono_literals;

/// A strict parser of the text format: anything unknown is an error.
class Reader {
  public:
    struct Sample {
        std::string name;
        std::map<std::string, std::string> labels;
        double value = 0;
    };

    explicit Reader(std::string text) : text_{std::move(text)} {
        while (at_ < text_.size()) {
            line();
        }
    }

    std::map<std::string, std::string> help, type;
    std::vector<Sample> samples;

    double value(const std::string& name, const std::map<std::string, std::string>& labels = {}) const {
        for (const Sample& sample : samples) {
            if (sample.name == name && sample.labels == labels) {
                return sample.value;
            }
        }
        throw std::runtime_error{"no sample " + name};
    }

  private:
    void expect(char c) {
        if (at_ >= text_.size() || text_[at_] != c) {
            throw std::runtime_error{std::string{"expected "} + c + " at " + text_.substr(at_, 40)};
        }
        ++at_;
    }
    std::string until(char end) {
        const auto found = text_.find(end, at_);
        if (found == std::string::npos) {
            throw std::runtime_error{"missing end of " + text_.substr(at_, 40)};
        }
        std::string word = text_.substr(at_, found - at_);
        at_ = found + 1;
        return word;
    }
    std::string name() {
        std::string word;
        for (; at_ < text_.size() &&
               (std::isalnum(static_cast<unsigned char>(text_[at_])) || text_[at_] == '_' || text_[at_] == ':');
             ++at_) {
            word += text_[at_];
        }
        if (word.empty() || std::isdigit(static_cast<unsigned char>(word[0]))) {
            throw std::runtime_error{"missing name at " + text_.substr(at_, 40)};
        }
        return word;
    }
    std::string quoted() {
        expect('"');
        std::string value;
        for (; at_ < text_.size() && text_[at_] != '"'; ++at_) {
            if (text_[at_] == '\n') {
                throw std::runtime_error{"a label value is longer than its line"};
            }
            if (text_[at_] != '\\') {
                value += text_[at_];
                continue;
            }
            const char c = text_.at(++at_);
            if (c != '\\' && c != '"' && c != 'n') {
                throw std::runtime_error{"unknown escape"};
            }
            value += c == 'n' ? '\n' : c;
        }
        expect('"');
        return value;
    }
    void line() {
        if (text_[at_] == '#') {
            expect('#');
            expect(' ');
            const std::string what = until(' '), of = until(' ');
            auto& lines = what == "HELP" ? help : what == "TYPE" ? type : throw std::runtime_error{"# " + what};
            if (!lines.emplace(of, until('\n')).second) {
                throw std::runtime_error{what + " of " + of + " twice"};
            }
            return;
        }
        Sample sample;
        sample.name = name();
        if (text_.at(at_) == '{') {
            do {
                ++at_;
                const std::string label = name();
                expect('=');
                if (!sample.labels.emplace(label, quoted()).second) {
                    throw std::runtime_error{"duplicate label: " + label};
                }
            } while (text_.at(at_) == ',');
            expect('}');
        }
        expect(' ');
        const std::string number = until('\n');
        std::size_t read = 0;
        sample.value = std::stod(number, &read);
        if (read != number.size()) {
            throw std::runtime_error{"not a number: " + number};
        }
        samples.push_back(sample);
    }

    std::string text_;
    std::size_t at_ = 0;
};

TEST(TimeHistogram, ABoundIsInclusive) {
    TimeHistogram histogram;
    histogram.add(0ns);
    histogram.add(-5ns); // a clock that was set back
    histogram.add(1us);
    histogram.add(1001ns);
    histogram.add(2us);
    histogram.add(1s);
    histogram.add(1s + 1ns);
    histogram.add(1h);
    EXPECT_EQ(histogram.count(0), 2u);
    EXPECT_EQ(histogram.count(2), 0u);
    EXPECT_EQ(histogram.count(3), 1u);
    EXPECT_EQ(histogram.count(4), 2u);
    EXPECT_EQ(histogram.count(5), 0u);
    EXPECT_EQ(histogram.count(TimeHistogram::bounds.size() - 1), 1u);
    EXPECT_EQ(histogram.count(TimeHistogram::bounds.size()), 2u);
    EXPECT_DOUBLE_EQ(histogram.sum_s(), 3602.000004002);
}

TEST(TimeHistogram, ATimeIsInTheFirstBucketThatCanHoldIt) {
    std::vector<std::uint64_t> times{0, 1, 99, 3'000'000'000};
    for (const auto bound : TimeHistogram::bounds) {
        for (const int off : {-1, 0, 1}) {
            times.push_back(static_cast<std::uint64_t>(bound.count() + off));
        }
    }
    for (int width = 0; width < 62; ++width) {
        for (const std::uint64_t off : {0, 1}) {
            times.push_back((std::uint64_t{1} << width) - off);
        }
    }
    for (const std::uint64_t ns : times) {
        const TimeHistogram::duration took{ns};
        TimeHistogram histogram;
        histogram.add(took);
        const auto bound = std::ranges::lower_bound(TimeHistogram::bounds, took);
        EXPECT_EQ(histogram.count(static_cast<std::size_t>(bound - TimeHistogram::bounds.begin())), 1u) << ns << " ns";
    }
}

TEST(TimeHistogram, BoundsAreOneTwoAndFiveOfEveryDecade) {
    EXPECT_EQ(TimeHistogram::bounds[0], 100ns);
    EXPECT_EQ(TimeHistogram::bounds[1], 200ns);
    EXPECT_EQ(TimeHistogram::bounds[2], 500ns);
    EXPECT_EQ(TimeHistogram::bounds[3], 1us);
    EXPECT_EQ(TimeHistogram::bounds.back(), 1s);
}

TEST(Exposition, HasHelpTypeAndSamplesOfAFamily) {
    v1::Metrics metrics;
    add_counter(metrics, "evod_things_total", "Things").add(12);
    add_gauge(metrics, "evod_room_bytes", "Room").add(0.25, {{"of", "a"}}).add(-3, {{"of", "b"}});
    EXPECT_EQ(to_prometheus(metrics), "# HELP evod_things_total Things\n"
                                      "# TYPE evod_things_total counter\n"
                                      "evod_things_total 12\n"
                                      "# HELP evod_room_bytes Room\n"
                                      "# TYPE evod_room_bytes gauge\n"
                                      "evod_room_bytes{of=\"a\"} 0.25\n"
                                      "evod_room_bytes{of=\"b\"} -3\n");
}

TEST(Exposition, LabelsAndHelpSurviveARoundTrip) {
    const std::string hostile = "a\"b\\c\nd},e=\"f\\n{\t\x1b é";
    v1::Metrics metrics;
    add_gauge(metrics, "evod_room", "one \\ two\nthree \"four\"").add(1, {{"world", hostile}, {"other", ""}});
    const Reader read{to_prometheus(metrics)};
    EXPECT_EQ(read.value("evod_room", {{"world", hostile}, {"other", ""}}), 1);
    EXPECT_EQ(read.help.at("evod_room"), "one \\\\ two\\nthree \"four\"");
    ASSERT_EQ(read.samples.size(), 1u);
}

TEST(Exposition, NumbersSurviveARoundTrip) {
    v1::Metrics metrics;
    auto family = add_gauge(metrics, "evod_number", "Numbers");
    const std::vector<double> numbers{0,
                                      1e15,
                                      9007199254740992,
                                      1e300,
                                      0.1,
                                      1e-9,
                                      -2.5,
                                      1763786452.125,
                                      std::numeric_limits<double>::infinity(),
                                      -std::numeric_limits<double>::infinity()};
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        family.add(numbers[i], {{"n", std::to_string(i)}});
    }
    family.add(std::numeric_limits<double>::quiet_NaN(), {{"n", "nan"}});
    const std::string text = to_prometheus(metrics);
    const Reader read{text};
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        EXPECT_EQ(read.value("evod_number", {{"n", std::to_string(i)}}), numbers[i]);
    }
    EXPECT_NE(text.find("{n=\"nan\"} NaN\n"), std::string::npos);
    EXPECT_NE(text.find(" +Inf\n"), std::string::npos);
    EXPECT_NE(text.find(" 1000000000000000\n"), std::string::npos);
}

TEST(Exposition, HistogramBucketsAreCumulative) {
    TimeHistogram histogram;
    for (const TimeHistogram::duration took : {500ns, 1500ns, 1500ns, 30'000'000ns, 30'000'000ns, 30'000'000ns}) {
        histogram.add(took);
    }
    histogram.add(2s);
    v1::Metrics metrics;
    add_histogram(metrics, "evod_tick_seconds", "Time of a tick").add(histogram, {{"world", "default"}});
    const Reader read{to_prometheus(metrics)};
    EXPECT_EQ(read.type.at("evod_tick_seconds"), "histogram");
    const auto bucket = [&](const std::string& bound) {
        return read.value("evod_tick_seconds_bucket", {{"world", "default"}, {"le", bound}});
    };
    EXPECT_EQ(bucket("1e-06"), 1);
    EXPECT_EQ(bucket("2e-06"), 3);
    EXPECT_EQ(bucket("0.02"), 3);
    EXPECT_EQ(bucket("0.05"), 6);
    EXPECT_EQ(bucket("1"), 6);
    EXPECT_EQ(bucket("+Inf"), 7);
    EXPECT_EQ(read.value("evod_tick_seconds_count", {{"world", "default"}}), 7);
    EXPECT_NEAR(read.value("evod_tick_seconds_sum", {{"world", "default"}}), 2.0900035, 1e-12);
    double before = 0;
    int buckets = 0;
    for (const Reader::Sample& sample : read.samples) {
        if (sample.name == "evod_tick_seconds_bucket") {
            EXPECT_GE(sample.value, before);
            before = sample.value;
            ++buckets;
        }
    }
    EXPECT_EQ(buckets, 23);
}

} // namespace
} // namespace evod::metrics
