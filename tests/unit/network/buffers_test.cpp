#include "server/network/buffers.h"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

namespace evod::network {
namespace {

SharedBytes bytes(std::size_t count) {
    return std::make_shared<const std::string>(count, 'x');
}

class BuffersOf : public testing::Test {
  protected:
    int told = 0;
    Buffers buffers{100, [this] { ++told; }};
};

TEST_F(BuffersOf, WhatSeveralHoldIsCountedOnce) {
    const SharedBytes shared = bytes(30);
    Buffers::Held first{buffers, shared};
    EXPECT_EQ(buffers.bytes(), 30u);
    EXPECT_EQ(first.share(), 30u);
    {
        const Buffers::Held second{buffers, shared}, other{buffers, bytes(30)};
        EXPECT_EQ(buffers.bytes(), 60u) << "as many bytes elsewhere are others";
        EXPECT_EQ(first.share(), 15u);
    }
    EXPECT_EQ(buffers.bytes(), 30u);
    first = {};
    EXPECT_EQ(buffers.bytes(), 0u);
    EXPECT_EQ(first.share(), 0u);
    EXPECT_EQ(shared->size(), 30u) << "others may go on with it";
}

TEST_F(BuffersOf, WhatIsHeldMayBePassedOn) {
    Buffers::Held from{buffers, bytes(10)};
    Buffers::Held to{std::move(from)};
    EXPECT_EQ(buffers.bytes(), 10u);
    EXPECT_EQ(to->size(), 10u);
    to = Buffers::Held{buffers, bytes(20)};
    EXPECT_EQ(buffers.bytes(), 20u) << "what stood there before is let go";
    std::vector<Buffers::Held> many;
    for (std::size_t i = 0; i < 20; ++i) {
        many.emplace_back(buffers, bytes(1));
    }
    EXPECT_EQ(buffers.bytes(), 40u);
    many.clear();
    EXPECT_EQ(buffers.bytes(), 20u);
}

TEST_F(BuffersOf, MemoryOfOnesOwnCountsAsMuchAsWasLastSaid) {
    {
        Buffers::Own own{buffers};
        own.set(50);
        own.set(20);
        EXPECT_EQ(buffers.bytes(), 20u);
        own.set(90);
        EXPECT_EQ(buffers.bytes(), 90u);
    }
    EXPECT_EQ(buffers.bytes(), 0u);
}

TEST_F(BuffersOf, TooManyAreToldOnceUntilThatIsMended) {
    Buffers::Own own{buffers};
    own.set(100);
    EXPECT_EQ(told, 0) << "as many as may be";
    EXPECT_EQ(buffers.excess(), 0u);
    Buffers::Held more{buffers, bytes(7)};
    EXPECT_EQ(told, 1);
    EXPECT_EQ(buffers.excess(), 7u);
    own.set(101);
    EXPECT_EQ(told, 1);
    own.set(50);
    buffers.relieved();
    own.set(93);
    EXPECT_EQ(told, 1) << "there is room again";
    own.set(94);
    EXPECT_EQ(told, 2);
}

} // namespace
} // namespace evod::network
