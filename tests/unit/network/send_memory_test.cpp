#include "server/network/send_memory.h"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

namespace evod::network {
namespace {

SharedBytes bytes(std::size_t count) {
    return std::make_shared<const std::string>(count, 'x');
}

class SendMemoryTest : public testing::Test {
  protected:
    int reports = 0;
    SendMemory memory{100, [this] { ++reports; }};
};

TEST_F(SendMemoryTest, SharedBytesCountOnce) {
    const SharedBytes shared = bytes(30);
    SendMemory::Counted first{memory, shared};
    EXPECT_EQ(memory.bytes(), 30u);
    EXPECT_EQ(first.share(), 30u);
    {
        const SendMemory::Counted second{memory, shared}, other{memory, bytes(30)};
        EXPECT_EQ(memory.bytes(), 60u) << "equal bytes in other memory count separately";
        EXPECT_EQ(first.share(), 15u);
    }
    EXPECT_EQ(memory.bytes(), 30u);
    first = {};
    EXPECT_EQ(memory.bytes(), 0u);
    EXPECT_EQ(first.share(), 0u);
    EXPECT_EQ(shared->size(), 30u) << "the bytes outlive the accounting";
}

TEST_F(SendMemoryTest, CountedBytesCanBeMoved) {
    SendMemory::Counted from{memory, bytes(10)};
    SendMemory::Counted to{std::move(from)};
    EXPECT_EQ(memory.bytes(), 10u);
    EXPECT_EQ(to->size(), 10u);
    to = SendMemory::Counted{memory, bytes(20)};
    EXPECT_EQ(memory.bytes(), 20u) << "the previous bytes are released";
    std::vector<SendMemory::Counted> many;
    for (std::size_t i = 0; i < 20; ++i) {
        many.emplace_back(memory, bytes(1));
    }
    EXPECT_EQ(memory.bytes(), 40u);
    many.clear();
    EXPECT_EQ(memory.bytes(), 20u);
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

TEST_F(SendMemoryTest, ExceedingTheBoundIsReportedOncePerRearm) {
    SendMemory::Reservation own{memory};
    own.set(100);
    EXPECT_EQ(reports, 0) << "exactly at the bound";
    EXPECT_EQ(memory.excess(), 0u);
    SendMemory::Counted more{memory, bytes(7)};
    EXPECT_EQ(reports, 1);
    EXPECT_EQ(memory.excess(), 7u);
    own.set(101);
    EXPECT_EQ(reports, 1);
    own.set(50);
    memory.rearm();
    own.set(93);
    EXPECT_EQ(reports, 1) << "below the bound again";
    own.set(94);
    EXPECT_EQ(reports, 2);
}

} // namespace
} // namespace evod::network
