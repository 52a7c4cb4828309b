#include "server/runtime/processes.h"

#include <gtest/gtest.h>

#include <cstdlib>

namespace evod::runtime {
namespace {

/// Sets the variables with which launchers of MPI describe a process; no launcher has started the test itself.
class ProcessesTest : public testing::Test {
  protected:
    ~ProcessesTest() override {
        for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "PMIX_RANK", "SLURM_STEP_NUM_TASKS"}) {
            ::unsetenv(name);
        }
    }
    static void set(const char* name, const char* value) { ::setenv(name, value, 1); }
};

TEST_F(ProcessesTest, AProcessWithoutALauncherIsAlone) {
    EXPECT_FALSE(is_one_of_several());
    const auto processes = join_processes(std::chrono::seconds{1});
    ASSERT_TRUE(processes);
    Processes& alone = **processes;
    EXPECT_EQ(alone.rank(), 0U);
    EXPECT_EQ(alone.size(), 1U);
    EXPECT_EQ(alone.on_this_machine(), 1U);
    EXPECT_EQ(alone.name_of(0), "this process");
    EXPECT_EQ(alone.exchange_s(), 0);
    EXPECT_EQ(alone.gather("a"), std::vector<std::string>{"a"});
    EXPECT_EQ(alone.collect("b"), std::vector<std::string>{"b"});
    EXPECT_EQ(alone.swap({"c"}), std::vector<std::string>{"c"});
    EXPECT_EQ(alone.broadcast("d"), "d");
}

TEST_F(ProcessesTest, AnyLauncherMayHaveStartedSeveral) {
    set("OMPI_COMM_WORLD_SIZE", "4");
    EXPECT_TRUE(is_one_of_several());
    set("OMPI_COMM_WORLD_SIZE", "");
    set("PMI_SIZE", "2");
    EXPECT_TRUE(is_one_of_several());
    set("PMI_SIZE", "");
    set("PMIX_RANK", "0"); // does not state the number of processes
    EXPECT_TRUE(is_one_of_several());
}

TEST_F(ProcessesTest, AnyLauncherMayHaveStartedOne) {
    set("PMIX_RANK", "0");
    set("SLURM_STEP_NUM_TASKS", "1");
    EXPECT_FALSE(is_one_of_several());
    set("PMI_SIZE", "1");
    EXPECT_FALSE(is_one_of_several());
    set("OMPI_COMM_WORLD_SIZE", "1");
    EXPECT_FALSE(is_one_of_several());
    EXPECT_EQ((*join_processes(std::chrono::seconds{1}))->size(), 1U);
}

} // namespace
} // namespace evod::runtime
