#include "server/streaming/bandwidth.h"

#include "tests/support/manual_clock.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <vector>

namespace evod::streaming {
namespace {

using namespace std::chrono_literals;
using v1::DETAIL_DENSITY;
using v1::DETAIL_DOTS;
using v1::DETAIL_FULL;

class BandwidthTest : public testing::Test {
  protected:
    /// Chooses the detail of a snapshot with these costs now, or of one every 50 ms for a while.
    std::optional<v1::Detail> choose(Bandwidth& bandwidth) {
        const auto detail = bandwidth.choose(clock_.now(), [&](v1::Detail of) { return costs_.at(of); }).detail;
        sent_bytes_ += detail ? costs_.at(*detail) : 0;
        return detail;
    }
    std::vector<std::optional<v1::Detail>> choose_for(Bandwidth& bandwidth, std::chrono::seconds time) {
        std::vector<std::optional<v1::Detail>> chosen;
        for (auto passed = 0ms; passed < time; passed += 50ms) {
            clock_.advance(50ms);
            chosen.push_back(choose(bandwidth));
        }
        return chosen;
    }
    static std::ptrdiff_t count(const std::vector<std::optional<v1::Detail>>& chosen, std::optional<v1::Detail> of) {
        return std::count(chosen.begin(), chosen.end(), of);
    }
    static std::size_t changes(const std::vector<std::optional<v1::Detail>>& chosen) {
        std::size_t changes = 0;
        for (std::size_t i = 1; i < chosen.size(); ++i) {
            changes += chosen[i] != chosen[i - 1];
        }
        return changes;
    }

    support::ManualClock clock_;
    std::map<v1::Detail, std::size_t> costs_{{DETAIL_FULL, 1000}, {DETAIL_DOTS, 300}, {DETAIL_DENSITY, 100}};
    std::size_t sent_bytes_ = 0;
};

TEST_F(BandwidthTest, FullDetailIsSentWhileBytesSuffice) {
    Bandwidth bandwidth{20'000, DETAIL_FULL}; // just enough for 20 snapshots per second
    for (const auto& detail : choose_for(bandwidth, 60s)) {
        EXPECT_EQ(detail, DETAIL_FULL);
    }
}

TEST_F(BandwidthTest, DetailIsReducedBeforeSnapshotsAreDelayed) {
    Bandwidth dots{10'000, DETAIL_FULL}, density{2'500, DETAIL_FULL};
    choose_for(dots, 60s);
    choose_for(density, 60s);
    const auto in_dots = choose_for(dots, 60s), in_density = choose_for(density, 60s);
    // All except attempts at more detail.
    EXPECT_GT(count(in_dots, DETAIL_DOTS), 1000);
    EXPECT_GT(count(in_density, DETAIL_DENSITY), 1000);
    EXPECT_EQ(count(in_dots, std::nullopt), 0);
    EXPECT_EQ(count(in_density, std::nullopt), 0);
    Bandwidth few_bytes{1'000, DETAIL_FULL};
    choose_for(few_bytes, 60s);
    const auto few = choose_for(few_bytes, 2s);
    EXPECT_GT(count(few, std::nullopt), 10);
    EXPECT_GT(count(few, DETAIL_DENSITY), 10);
}

TEST_F(BandwidthTest, TheRateHoldsForAllCosts) {
    std::uint64_t random = 1;
    for (const double bytes_per_s : {1'000.0, 7'000.0, 30'000.0}) {
        Bandwidth bandwidth{bytes_per_s, DETAIL_FULL};
        sent_bytes_ = 0;
        for (int round = 0; round < 200; ++round) {
            random = random * 6364136223846793005U + 1442695040888963407U;
            costs_[DETAIL_FULL] = (random >> 33) % 5000;
            costs_[DETAIL_DOTS] = (random >> 40) % 2000;
            costs_[DETAIL_DENSITY] = (random >> 45) % 1500;
            choose_for(bandwidth, 1s);
        }
        // The initial bytes, and the longest snapshot.
        EXPECT_LE(static_cast<double>(sent_bytes_), (200 + Bandwidth::accumulated_s_max) * bytes_per_s + 5000);
        EXPECT_GT(static_cast<double>(sent_bytes_), 100 * bytes_per_s) << "the rate is used";
    }
}

TEST_F(BandwidthTest, DetailReturnsWhenItFitsAgain) {
    Bandwidth bandwidth{10'000, DETAIL_FULL};
    EXPECT_GT(count(choose_for(bandwidth, 30s), DETAIL_DOTS), 400);
    costs_ = {{DETAIL_FULL, 400}, {DETAIL_DOTS, 300}, {DETAIL_DENSITY, 100}};
    const auto chosen = choose_for(bandwidth, std::chrono::seconds{Bandwidth::retry_max} + 1s);
    EXPECT_EQ(chosen.back(), DETAIL_FULL);
    EXPECT_EQ(changes(chosen), 1U);
}

TEST_F(BandwidthTest, FullDetailIsSentIfItCostsLessThanDots) {
    Bandwidth bandwidth{10'000, DETAIL_FULL};
    choose_for(bandwidth, 30s);
    costs_ = {{DETAIL_FULL, 400}, {DETAIL_DOTS, 1200}, {DETAIL_DENSITY, 100}};
    EXPECT_EQ(choose_for(bandwidth, std::chrono::seconds{Bandwidth::retry_max} + 1s).back(), DETAIL_FULL);
}

TEST_F(BandwidthTest, DetailDoesNotOscillate) {
    Bandwidth bandwidth{6'000, DETAIL_FULL}; // dots, just
    choose_for(bandwidth, 60s);
    EXPECT_LE(changes(choose_for(bandwidth, 120s)), 8U) << "of 2400 snapshots";
}

TEST_F(BandwidthTest, BytesAccumulateForKeyframes) {
    Bandwidth bandwidth{12'000, DETAIL_FULL};
    for (int i = 0; i < 1000; ++i) { // 39 of 400 bytes and one of 8,000 every 2 s: 11,800 a second
        costs_[DETAIL_FULL] = i % 40 == 0 ? 8000 : 400;
        clock_.advance(50ms);
        ASSERT_EQ(choose(bandwidth), DETAIL_FULL) << i;
    }
}

TEST_F(BandwidthTest, TooLongSnapshotsAreSentOccasionally) {
    costs_ = {{DETAIL_FULL, 90'000}, {DETAIL_DOTS, 80'000}, {DETAIL_DENSITY, 70'000}};
    Bandwidth bandwidth{1'000, DETAIL_FULL};
    EXPECT_EQ(choose(bandwidth), DETAIL_DENSITY);
    sent_bytes_ = 0;
    const auto chosen = choose_for(bandwidth, 700s);
    EXPECT_EQ(count(chosen, DETAIL_DENSITY), 10);
    EXPECT_EQ(sent_bytes_, 700'000U);
}

TEST_F(BandwidthTest, ReportsWhenASnapshotCanBeSent) {
    costs_ = {{DETAIL_DENSITY, 1'500}};
    Bandwidth bandwidth{1'000, DETAIL_DENSITY};
    const auto cost = [&](v1::Detail of) { return costs_.at(of); };
    EXPECT_TRUE(choose(bandwidth)); // 500 are left
    const auto now = clock_.now();
    EXPECT_EQ(bandwidth.choose(now, cost).again, now + 1s);
    EXPECT_FALSE(bandwidth.choose(now + 999ms, cost).detail);
    EXPECT_EQ(bandwidth.choose(now + 1s, cost).detail, DETAIL_DENSITY);
}

TEST_F(BandwidthTest, AnOldSnapshotIsRefinedWhenBytesSuffice) {
    const auto cost = [&](v1::Detail of) { return costs_.at(of); };
    const auto refine = [&](Bandwidth& bandwidth) { return bandwidth.refine(clock_.now(), DETAIL_DENSITY, cost); };
    Bandwidth bandwidth{550, DETAIL_FULL};
    EXPECT_EQ(choose(bandwidth), DETAIL_FULL); // 100 are left
    const Bandwidth::Choice shown = bandwidth.choose(clock_.now(), cost);
    EXPECT_EQ(shown.detail, DETAIL_DENSITY);
    EXPECT_EQ(shown.again, clock_.now() + Bandwidth::retry_min);
    EXPECT_EQ(refine(bandwidth).again, shown.again);
    clock_.advance(Bandwidth::retry_min);
    EXPECT_EQ(refine(bandwidth).detail, DETAIL_FULL); // 100 are left
    // A snapshot of another island, sent in the same detail.
    const Bandwidth::Choice other = refine(bandwidth);
    EXPECT_FALSE(other.detail);
    clock_.advance(other.again - clock_.now() - 1ms);
    EXPECT_FALSE(refine(bandwidth).detail);
    clock_.advance(1ms);
    EXPECT_EQ(refine(bandwidth).detail, DETAIL_FULL);
    costs_[DETAIL_FULL] = 1101; // more than can accumulate
    clock_.advance(1h);
    EXPECT_EQ(refine(bandwidth).detail, DETAIL_DOTS);
    costs_[DETAIL_DOTS] = 1101;
    EXPECT_EQ(refine(bandwidth).again, Bandwidth::Clock::time_point::max());
}

TEST_F(BandwidthTest, AHugeSnapshotDoesNotDelayANewView) {
    Bandwidth bandwidth{500, DETAIL_DENSITY};
    costs_[DETAIL_DENSITY] = 1'000'000;
    EXPECT_EQ(choose(bandwidth), DETAIL_DENSITY);
    costs_[DETAIL_DENSITY] = 100; // of a small region
    bandwidth.change(500, DETAIL_DENSITY);
    clock_.advance(2200ms);
    EXPECT_EQ(choose(bandwidth), DETAIL_DENSITY);
}

TEST_F(BandwidthTest, AHigherRateAddsBytesAtOnce) {
    Bandwidth bandwidth{500, DETAIL_FULL};
    EXPECT_EQ(choose(bandwidth), DETAIL_FULL); // nothing is left
    bandwidth.change(400, DETAIL_FULL);
    EXPECT_EQ(choose(bandwidth), std::nullopt);
    bandwidth.change(900, DETAIL_FULL);
    EXPECT_EQ(choose(bandwidth), DETAIL_FULL);
}

TEST_F(BandwidthTest, TheWantedDetailIsNeverExceeded) {
    Bandwidth bandwidth{1e9, DETAIL_DOTS};
    for (const auto& detail : choose_for(bandwidth, 10s)) {
        EXPECT_EQ(detail, DETAIL_DOTS);
    }
    bandwidth.change(3'000, DETAIL_FULL);
    EXPECT_EQ(choose(bandwidth), DETAIL_FULL);
    choose_for(bandwidth, 10s);
    EXPECT_NE(choose(bandwidth), DETAIL_FULL);
    bandwidth.change(1e9, DETAIL_FULL);
    clock_.advance(50ms);
    EXPECT_EQ(choose(bandwidth), DETAIL_FULL);
}

} // namespace
} // namespace evod::streaming
