// Counters: numbers that one thread writes and any thread may read. Writing costs no more than a plain store.
//
// Threads      each counter has exactly one writing thread and any number of readers. The values of two counters may
//              belong to different moments.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <chrono>
#include <cstddef>
#include <cstdint>

namespace evod::metrics {

/// A number that starts at 0 and only increases.
class Counter {
  public:
    // There is only one writer, so a load and a store suffice. An atomic increment would cost more than the counted
    // work.
    void add(std::uint64_t count = 1) { value_.store(value() + count, std::memory_order_relaxed); }
    std::uint64_t value() const { return value_.load(std::memory_order_relaxed); }

  private:
    std::atomic<std::uint64_t> value_ = 0;
};

/// A value that may increase and decrease.
class Gauge {
  public:
    void set(double value) { value_.store(value, std::memory_order_relaxed); }
    double value() const { return value_.load(std::memory_order_relaxed); }

  private:
    std::atomic<double> value_ = 0;
};

/// A histogram of durations.
class TimeHistogram {
  public:
    using duration = std::chrono::nanoseconds;

    /// Inclusive upper bounds of the buckets: 1, 2 and 5 in every decade from 0.1 µs to 1 s. The last bucket has no
    /// bound.
    static constexpr std::array<duration, 22> bounds = [] {
        std::array<duration, 22> table{};
        duration decade{100};
        for (std::size_t i = 0; i < table.size(); ++i) {
            table[i] = decade * std::array{1, 2, 5}[i % 3];
            if (i % 3 == 2) {
                decade *= 10;
            }
        }
        return table;
    }();

    /// times  number of measurements with this duration.
    void add(duration took, std::uint64_t times = 1) {
        const auto ns = static_cast<std::uint64_t>(std::max(took, duration{0}).count());
        counts_[bucket_of(ns)].add(times);
        sum_ns_.add(ns * times);
    }

    /// The number of measurements in a bucket. bucket  its index, 0 to bounds.size().
    std::uint64_t count(std::size_t bucket) const { return counts_[bucket].value(); }
    std::uint64_t count() const {
        std::uint64_t all = 0;
        for (const Counter& of_bucket : counts_) {
            all += of_bucket.value();
        }
        return all;
    }
    double sum_s() const { return static_cast<double>(sum_ns_.value()) * 1e-9; }

  private:
    /// Finds the bucket without a branch, because a branch would be mispredicted often. Numbers of equal bit width
    /// differ by less than a factor of 2, so at most one bound is between them.
    static std::size_t bucket_of(std::uint64_t ns) {
        const std::size_t bucket = first_bucket[static_cast<std::size_t>(std::bit_width(ns))];
        return bucket + (ns > bounds_ns[bucket] ? 1 : 0);
    }
    static constexpr std::array<std::uint64_t, bounds.size() + 1> bounds_ns = [] {
        std::array<std::uint64_t, bounds.size() + 1> table{};
        std::ranges::transform(bounds, table.begin(), [](duration bound) { return bound.count(); });
        table.back() = ~std::uint64_t{0};
        return table;
    }();
    /// Element i is the bucket of the smallest number that has i bits.
    static constexpr std::array<std::size_t, 65> first_bucket = [] {
        std::array<std::size_t, 65> table{};
        for (std::size_t width = 1; width < table.size(); ++width) {
            table[width] = static_cast<std::size_t>(
                std::ranges::lower_bound(bounds_ns, std::uint64_t{1} << (width - 1)) - bounds_ns.begin());
        }
        return table;
    }();

    std::array<Counter, bounds.size() + 1> counts_;
    Counter sum_ns_;
};

} // namespace evod::metrics
