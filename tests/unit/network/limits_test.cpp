#include "server/network/limits.h"

#include <gtest/gtest.h>

#include <set>

namespace evod::network {
namespace {

TEST(Limits, HaveOneRowEachInEnumOrder) {
    std::set<std::string_view> names;
    for (std::size_t i = 0; i < limit_table().size(); ++i) {
        const LimitRow& row = limit_table()[i];
        EXPECT_EQ(static_cast<std::size_t>(row.limit), i) << row.name;
        EXPECT_GT(row.value, 0u) << row.name;
        EXPECT_FALSE(row.limited.empty() || row.effect.empty()) << row.name;
        names.insert(row.name);
    }
    EXPECT_EQ(names.size(), limit_table().size());
    EXPECT_EQ(limit_table().size(), LimitCounters::limit_count);
}

TEST(Limits, ReachClientsAsTheTableHasThem) {
    const v1::Limits limits = limits_message({.sessions_max = 7, .worlds_max = 3, .replays_max = 5});
    EXPECT_EQ(limits.sessions_max(), 7u);
    EXPECT_EQ(limits.worlds_max(), 3u);
    EXPECT_EQ(limits.replays_max(), 5u);
    EXPECT_EQ(limits.snapshot_rate_hz_max(), snapshot_rate_hz_max);
    EXPECT_EQ(limits.requests_in_flight_max(), requests_in_flight_max);
    EXPECT_EQ(limits.control_frame_bytes_max(), 1u << 20);
    EXPECT_EQ(limits.http_connections_max(), http_connections_max);
    EXPECT_EQ(v1::Limits::descriptor()->field_count(), static_cast<int>(limit_table().size()));
    const std::string list = limit_list();
    EXPECT_NE(list.find("| `sessions_max` | 256 | 128 | "), std::string::npos) << list;
}

TEST(Limits, HaveACounterEach) {
    LimitCounters counters;
    counters.met(Limit::Sessions);
    counters.met(Limit::OutboxEvents, 5);
    counters.met(Limit::Sessions);
    for (const LimitRow& row : limit_table()) {
        EXPECT_EQ(counters.count(row.limit), row.limit == Limit::Sessions       ? 2u
                                             : row.limit == Limit::OutboxEvents ? 5u
                                                                                : 0u)
            << row.name;
    }
}

} // namespace
} // namespace evod::network
