#include "client/ctl/top.h"

#include "client/ctl/text.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace evod::ctl {

namespace {

const v1::MetricFamily* family_in(const v1::Metrics& metrics, std::string_view name) {
    const auto found = std::ranges::find(metrics.families(), name, &v1::MetricFamily::name);
    return found == metrics.families().end() ? nullptr : &*found;
}

/// Returns the sample of a metric whose only label has the value `label`. If `label` is empty, returns the sample
/// without labels.
const v1::MetricSample* sample_in(const v1::Metrics& metrics, std::string_view name, std::string_view label) {
    const auto* family = family_in(metrics, name);
    if (family == nullptr) {
        return nullptr;
    }
    const auto found = std::ranges::find_if(family->samples(), [&](const v1::MetricSample& sample) {
        return sample.labels().empty() ? label.empty() : sample.labels(0).value() == label;
    });
    return found == family->samples().end() ? nullptr : &*found;
}

/// The distribution of the durations of ticks between the two measurements.
struct TickTimes {
    std::vector<double> bounds;
    std::vector<std::uint64_t> counts;
    std::uint64_t count = 0;
    double sum = 0;

    /// Returns a quantile, interpolated linearly within a bucket of the histogram. `count` must not be 0.
    std::string quantile(double share) const {
        const double wanted = share * static_cast<double>(count);
        double so_far = 0;
        for (std::size_t i = 0; i < bounds.size(); ++i) {
            const auto here = static_cast<double>(counts[i]);
            if (here > 0 && so_far + here >= wanted) {
                const double lower = i == 0 ? 0 : bounds[i - 1];
                return short_time(lower + (bounds[i] - lower) * (wanted - so_far) / here);
            }
            so_far += here;
        }
        return "> " + short_time(bounds.empty() ? 0 : bounds.back());
    }
};

constexpr std::size_t bar_width = 16;

class Page {
  public:
    explicit Page(const Measurements& measurements) : measurements_{measurements} {}

    double now(std::string_view name, std::string_view label = {}) const {
        const auto* sample = sample_in(measurements_.after, name, label);
        return sample == nullptr ? 0 : sample->value();
    }
    /// Returns the increase of a counter between the two measurements; at least 0, because a restart of the server
    /// resets its counters.
    double risen(std::string_view name, std::string_view label = {}) const {
        const auto* sample = sample_in(measurements_.before, name, label);
        return std::max(0.0, now(name, label) - (sample == nullptr ? 0 : sample->value()));
    }
    std::string count(std::string_view name, std::string_view label = {}) const { return fixed(now(name, label), 0); }
    std::string per_s(std::string_view name, std::string_view label = {}) const {
        return fixed(risen(name, label) / measurements_.between_s, 0) + "/s";
    }
    std::string bytes_per_s(std::string_view name, std::string_view label = {}) const {
        return short_bytes(risen(name, label) / measurements_.between_s) + "/s";
    }
    /// Returns the mean number of processors that were busy between the two measurements, such as 1.5.
    double processors(std::string_view name, std::string_view label = {}) const {
        return risen(name, label) / measurements_.between_s;
    }
    bool reports(std::string_view name) const { return family_in(measurements_.after, name) != nullptr; }

    TickTimes tick_times(std::string_view world) const {
        const auto* after = sample_in(measurements_.after, "evod_tick_seconds", world);
        const auto* before = sample_in(measurements_.before, "evod_tick_seconds", world);
        TickTimes times;
        if (after == nullptr) {
            return times;
        }
        const v1::MetricHistogram& last = after->histogram();
        // If a world was deleted and a new one has the same name, its counts are smaller than before.
        const bool goes_on = before != nullptr && before->histogram().counts_size() == last.counts_size() &&
                             std::ranges::equal(before->histogram().counts(), last.counts(), std::less_equal{});
        times.bounds.assign(last.bounds().begin(), last.bounds().end());
        for (int i = 0; i < last.counts_size(); ++i) {
            times.counts.push_back(last.counts(i) - (goes_on ? before->histogram().counts(i) : 0));
            times.count += times.counts.back();
        }
        times.sum = last.sum() - (goes_on ? before->histogram().sum() : 0);
        return times;
    }

    /// Returns the threads with the share of a processor that each of them used.
    std::vector<std::pair<std::string, double>> threads() const {
        std::vector<std::pair<std::string, double>> threads;
        if (const auto* family = family_in(measurements_.after, "evod_thread_cpu_seconds_total")) {
            for (const auto& sample : family->samples()) {
                const std::string& thread = sample.labels(0).value();
                threads.emplace_back(thread, processors("evod_thread_cpu_seconds_total", thread));
            }
        }
        return threads;
    }

    std::string clients() const {
        double all = 0;
        std::string roles;
        for (const char* role : {"admin", "controller", "viewer", "none"}) {
            const double here = now("evod_sessions", role);
            all += here;
            if (here > 0) {
                roles += (roles.empty() ? ": " : ", ") + fixed(here, 0) + " " +
                         (std::string_view{role} == "none" ? "without a role" : role);
            }
        }
        return fixed(all, 0) + roles;
    }

    std::string disk() const {
        if (!reports("evod_storage_state")) {
            return "runs are not recorded";
        }
        std::string state = in_color("keeps up", Color::Green);
        for (const char* other : {"behind", "failing", "stalled"}) {
            if (now("evod_storage_state", other) > 0) {
                state = in_color(other, std::string_view{other} == "behind" ? Color::Yellow : Color::Red);
            }
        }
        return state + "; " + short_bytes(now("evod_journal_waiting_bytes")) + " waiting, the oldest for " +
               fixed(now("evod_journal_lag_seconds"), 1) + " s";
    }

    /// Returns the limits that clients have reached, with their counters: "requests 12, sessions 3". Empty if no limit
    /// was reached, or if the server does not count how often limits are reached.
    std::string limits() const {
        std::string text;
        if (const auto* family = family_in(measurements_.after, "evod_limit_reached_total")) {
            for (const auto& sample : family->samples()) {
                if (sample.value() > 0) {
                    text += (text.empty() ? "" : ", ") + sample.labels(0).value() + " " + fixed(sample.value(), 0);
                }
            }
        }
        return text;
    }

    std::string worlds(std::size_t lines_max) const {
        const auto* family = family_in(measurements_.after, "evod_ticks_per_second");
        if (family == nullptr || family->samples().empty()) {
            return "no worlds\n";
        }
        std::vector<v1::MetricSample> all{family->samples().begin(), family->samples().end()};
        std::ranges::stable_sort(all, std::ranges::greater{}, &v1::MetricSample::value);
        const std::size_t room = std::max<std::size_t>(lines_max, 2) - 1; // lines below the titles
        const std::size_t shown = all.size() <= room ? all.size() : room - 1;
        const double fastest = std::max(all.front().value(), 1.0);
        Table table{{{"WORLD"},
                     {"TICKS/S", Table::Align::Right},
                     {""},
                     {"TICK MEAN", Table::Align::Right},
                     {"P50", Table::Align::Right},
                     {"P99", Table::Align::Right}}};
        for (std::size_t i = 0; i < shown; ++i) {
            const std::string& world = all[i].labels(0).value();
            const TickTimes times = tick_times(world);
            const bool any = times.count > 0;
            table.add({world, fixed(all[i].value(), 0), bar(all[i].value() / fastest, bar_width),
                       any ? short_time(times.sum / static_cast<double>(times.count)) : "-",
                       any ? times.quantile(0.5) : "-", any ? times.quantile(0.99) : "-"});
        }
        return table.to_text() + (shown < all.size() ? "and " + std::to_string(all.size() - shown) + " more\n" : "");
    }

  private:
    const Measurements& measurements_;
};

} // namespace

std::string top_text(const Measurements& measurements, const std::string& server, double now_s, std::size_t lines_max) {
    const Page page{measurements};
    const auto* build = family_in(measurements.after, "evod_build_info");
    const std::string version = build != nullptr && !build->samples().empty() && !build->samples(0).labels().empty()
                                    ? " " + build->samples(0).labels(0).value()
                                    : "";
    std::string text = "evod" + version + " at " + server + ", up " +
                       duration(std::max(0.0, now_s - page.now("process_start_time_seconds"))) + "\n\n";
    std::size_t lines = 2;
    const auto line = [&](std::string_view title, const std::string& value) {
        text += std::string{title} + std::string(title.size() < 15 ? 15 - title.size() : 1, ' ') + value + "\n";
        ++lines;
    };
    const auto percent = [](double share) { return fixed(100 * share, 0) + " %"; };
    line("memory", short_bytes(page.now("process_resident_memory_bytes")));
    line("processor", percent(page.processors("process_cpu_seconds_total")));
    const auto threads = page.threads();
    for (std::size_t i = 0; i < threads.size(); i += 2) { // two threads in a line
        const auto bar_of = [&](double share) {
            const std::string number = percent(share);
            return bar(share, bar_width) + std::string(number.size() < 6 ? 6 - number.size() : 1, ' ') + number;
        };
        const bool has_second = i + 1 < threads.size();
        line("  " + threads[i].first,
             bar_of(threads[i].second) +
                 (has_second
                      ? "  " + threads[i + 1].first +
                            std::string(threads[i + 1].first.size() < 12 ? 12 - threads[i + 1].first.size() : 1, ' ') +
                            bar_of(threads[i + 1].second)
                      : ""));
    }
    line("clients", page.clients());
    line("logins", page.count("evod_logins_failed_total") + " failed");
    line("subscriptions", page.count("evod_subscriptions", "snapshots") + " to snapshots, " +
                              page.count("evod_subscriptions", "events") + " to events");
    const double waiting = page.now("evod_mailbox_requests"), waiting_max = page.now("evod_mailbox_requests_max");
    line("requests", bar(waiting_max > 0 ? waiting / waiting_max : 0, bar_width) + " " + fixed(waiting, 0) + " of " +
                         fixed(waiting_max, 0) + " waiting; " + page.per_s("evod_requests_total"));
    line("received", page.bytes_per_s("evod_received_bytes_total"));
    line("sent", page.bytes_per_s("evod_sent_bytes_total", "stream") + " of snapshots, " +
                     page.bytes_per_s("evod_sent_bytes_total", "control") + " of replies; " +
                     short_bytes(page.now("evod_client_buffer_bytes")) + " waiting");
    line("snapshots",
         page.per_s("evod_snapshots_sent_total") + ", dropped " + page.per_s("evod_snapshots_dropped_total"));
    line("events", page.count("evod_events_dropped_total") + " dropped");
    line("disk", page.disk());
    if (const std::string limits = page.limits(); !limits.empty()) {
        line("limits reached", in_color(limits, Color::Yellow));
    }
    text += "\n";
    return text + page.worlds(lines_max > lines + 1 ? lines_max - lines - 1 : 2);
}

} // namespace evod::ctl
