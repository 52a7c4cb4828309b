#include "server/network/requests_in_flight.h"

#include "server/network/limits.h"

#include <gtest/gtest.h>

namespace evod::network {
namespace {

v1::Request request(std::uint64_t id) {
    v1::Request made;
    made.set_request_id(id);
    return made;
}

class RequestsInFlightTest : public testing::Test {
  protected:
    SendMemory memory{std::size_t{1} << 30, [] {}};
    RequestsInFlight requests{memory};
};

TEST_F(RequestsInFlightTest, AreLimitedUntilAnswered) {
    for (std::uint32_t i = 0; i < requests_in_flight_max; ++i) {
        EXPECT_TRUE(requests.admit());
    }
    EXPECT_FALSE(requests.admit());
    EXPECT_EQ(requests.unanswered(), requests_in_flight_max);
    requests.count_answered(2);
    EXPECT_TRUE(requests.admit());
    EXPECT_TRUE(requests.admit());
    EXPECT_FALSE(requests.admit());
}

TEST_F(RequestsInFlightTest, HeldBackOnesKeepTheirOrder) {
    requests.hold_back(request(1));
    requests.hold_back(request(2));
    EXPECT_GT(memory.bytes(), 0u);
    EXPECT_EQ(requests.held_bytes(), memory.bytes());
    EXPECT_EQ(requests.take_held_back()->request_id(), 1u);
    EXPECT_EQ(requests.take_held_back()->request_id(), 2u);
    EXPECT_FALSE(requests.take_held_back());
    EXPECT_EQ(memory.bytes(), 0u);
}

TEST_F(RequestsInFlightTest, ReserveMemoryForAnswers) {
    requests.expect(100);
    requests.expect(20);
    requests.expect(-100);
    EXPECT_EQ(memory.bytes(), 20u);
}

TEST_F(RequestsInFlightTest, CountCommandsUnderWay) {
    EXPECT_EQ(requests.commands_under_way, 0u);
    requests.begin_command(100);
    requests.begin_command(30);
    requests.end_command(100);
    EXPECT_EQ(requests.commands_under_way, 1u);
    EXPECT_EQ(memory.bytes(), 30u);
    requests.end_command(30);
    EXPECT_EQ(requests.commands_under_way, 0u);
}

TEST_F(RequestsInFlightTest, OfAnEndedSessionHoldNoMemory) {
    requests.expect(100);
    requests.hold_back(request(1));
    requests.close();
    EXPECT_EQ(memory.bytes(), 0u);
    requests.expect(-100); // the answer comes later
    EXPECT_EQ(memory.bytes(), 0u);
    EXPECT_FALSE(requests.take_held_back());
}

} // namespace
} // namespace evod::network
