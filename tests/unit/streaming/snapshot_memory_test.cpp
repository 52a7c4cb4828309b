#include "server/streaming/snapshot_memory.h"

#include <gtest/gtest.h>

#include <string>

namespace evod::streaming {
namespace {

class SnapshotMemoryTest : public testing::Test, protected SnapshotMemory {
  protected:
    void add(std::size_t bytes) override { sum += bytes; }
    void remove(std::size_t bytes) override { sum -= bytes; }

    std::size_t sum = 0;
};

TEST_F(SnapshotMemoryTest, AnEncodingCountsWhileAReferenceExists) {
    SharedBytes first = counted(std::string(1000, 'x'), this);
    EXPECT_EQ(*first, std::string(1000, 'x'));
    EXPECT_EQ(sum, bytes_of(first));
    EXPECT_GE(sum, 1000u);
    SharedBytes second = first;
    EXPECT_EQ(sum, bytes_of(first));
    first = {};
    EXPECT_EQ(sum, bytes_of(second));
    second = {};
    EXPECT_EQ(sum, 0u);
}

TEST_F(SnapshotMemoryTest, ShortEncodingsAreWithinTheirObject) {
    EXPECT_LT(bytes_of(counted("x", this)), bytes_of(counted(std::string(100, 'x'), this)) - 100);
}

TEST_F(SnapshotMemoryTest, AnObjectCountsAsLastSet) {
    {
        SnapshotBytes bytes{this};
        bytes.set(50);
        bytes.set(20);
        EXPECT_EQ(sum, 20u);
    }
    EXPECT_EQ(sum, 0u);
}

TEST_F(SnapshotMemoryTest, WithoutAnAccountNothingIsCounted) {
    SnapshotBytes bytes{nullptr};
    bytes.set(50);
    EXPECT_EQ(bytes.bytes(), 50u);
    EXPECT_EQ(*counted("text", nullptr), "text");
}

} // namespace
} // namespace evod::streaming
