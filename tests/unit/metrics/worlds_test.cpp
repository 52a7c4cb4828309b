#include "server/metrics/process.h"
#include "server/metrics/worlds.h"

#include <gtest/gtest.h>

#include <ctime>

namespace evod::metrics {
namespace {

TEST(Worlds, AreListedByNameWhileHeld) {
    Worlds worlds;
    const auto lesson = worlds.add("lesson");
    auto gone = worlds.add("gone");
    const auto classic = worlds.add("classic");
    lesson->ticks_per_s.set(60);
    gone.reset();
    const auto listed = worlds.list();
    ASSERT_EQ(listed.size(), 2u);
    EXPECT_EQ(listed[0]->name, "classic");
    EXPECT_EQ(listed[1]->name, "lesson");
    EXPECT_EQ(listed[1]->ticks_per_s.value(), 60);
}

TEST(Worlds, DamagedOnesAreListedByName) {
    Worlds worlds;
    worlds.set_damaged({"plate", "lesson"});
    EXPECT_EQ(worlds.damaged(), (std::vector<std::string>{"lesson", "plate"}));
    EXPECT_TRUE(worlds.list().empty());
}

TEST(Process, MatchesTheSystemsReport) {
    const Process process = read_process();
    EXPECT_GT(process.resident_bytes, 100'000u);
    EXPECT_GE(process.virtual_bytes, process.resident_bytes);
    EXPECT_GE(process.open_files, 3u);
    EXPECT_GT(process.open_files_max, process.open_files);
    EXPECT_GT(process.cpu_s, 0);
    EXPECT_LE(process.start_time_s, static_cast<double>(std::time(nullptr)) + 1);
    EXPECT_GT(process.start_time_s, static_cast<double>(std::time(nullptr)) - 86400);
    const auto of_this_thread = cpu_s_of(pthread_self());
    ASSERT_TRUE(of_this_thread);
    EXPECT_LE(*of_this_thread, read_process().cpu_s);
}

} // namespace
} // namespace evod::metrics
