#include "server/network/send_memory.h"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

namespace evod::network {
namespace {

SharedBytes bytes(std::size_t count) {
    return std::make_shared<const std::string>(count, 'x');
}

/// Memory of frames that hold so many bytes together.
std::size_t frames(std::size_t bytes, std::size_t frame_count, std::size_t holder_count) {
    return bytes + frame_count * bytes_per_frame + holder_count * bytes_per_holder;
}

class SendMemoryTest : public testing::Test {
  protected:
    int checks = 0;
    SendMemory memory{6400, [this] { ++checks; }};
};

TEST_F(SendMemoryTest, SharedBytesCountOnce) {
    const SharedBytes shared = bytes(30);
    SendMemory::Counted first{memory, shared};
    EXPECT_EQ(memory.bytes(), frames(30, 1, 1));
    EXPECT_EQ(first.share(), frames(30, 1, 1));
    {
        const SendMemory::Counted second{memory, shared}, other{memory, bytes(30)};
        EXPECT_EQ(memory.bytes(), frames(60, 2, 3)) << "equal bytes in other memory count separately";
        EXPECT_EQ(first.share(), frames(30, 1, 0) / 2 + bytes_per_holder);
    }
    EXPECT_EQ(memory.bytes(), frames(30, 1, 1));
    first = {};
    EXPECT_EQ(memory.bytes(), 0u);
    EXPECT_EQ(first.share(), 0u);
    EXPECT_EQ(shared->size(), 30u) << "the bytes outlive the accounting";
}

TEST_F(SendMemoryTest, CountedBytesCanBeMoved) {
    SendMemory::Counted from{memory, bytes(10)};
    SendMemory::Counted to{std::move(from)};
    EXPECT_EQ(memory.bytes(), frames(10, 1, 1));
    EXPECT_EQ(to->size(), 10u);
    to = SendMemory::Counted{memory, bytes(20)};
    EXPECT_EQ(memory.bytes(), frames(20, 1, 1)) << "the previous bytes are released";
    std::vector<SendMemory::Counted> many;
    for (std::size_t i = 0; i < 20; ++i) {
        many.emplace_back(memory, bytes(1));
    }
    EXPECT_EQ(memory.bytes(), frames(40, 21, 21));
    many.clear();
    EXPECT_EQ(memory.bytes(), frames(20, 1, 1));
}

TEST_F(SendMemoryTest, AReservationCountsAsLastSet) {
    {
        SendMemory::Reservation own{memory};
        own.set(50);
        own.set(20);
        EXPECT_EQ(memory.bytes(), 20u);
        own.set(90);
        EXPECT_EQ(memory.bytes(), 90u);
    }
    EXPECT_EQ(memory.bytes(), 0u);
}

TEST_F(SendMemoryTest, IsCheckedAboveTheHalfThatAUserMayHold) {
    SendMemory::Reservation own{memory}, others{memory};
    own.set(3200);
    EXPECT_EQ(checks, 0) << "exactly half";
    own.set(3201);
    EXPECT_EQ(checks, 1);
    own.set(6000);
    EXPECT_EQ(checks, 1) << "the first check has not ended";
    own.set(3201);
    memory.rearm();
    own.set(3401);
    EXPECT_EQ(checks, 1) << "it has grown by a 32nd only";
    own.set(3402);
    EXPECT_EQ(checks, 2);
    memory.rearm();
    own.set(3300);
    others.set(102);
    EXPECT_EQ(checks, 2);
    others.set(300);
    EXPECT_EQ(checks, 3) << "it has grown since it was least";
}

TEST_F(SendMemoryTest, IsCheckedWhenItExceedsTheLimit) {
    SendMemory::Reservation own{memory};
    own.set(6390);
    memory.rearm();
    EXPECT_EQ(checks, 1);
    EXPECT_EQ(memory.excess(), 0u);
    own.set(6400);
    EXPECT_EQ(checks, 1) << "exactly at the limit";
    own.set(6407);
    EXPECT_EQ(checks, 2);
    EXPECT_EQ(memory.excess(), 7u);
}

} // namespace
} // namespace evod::network
