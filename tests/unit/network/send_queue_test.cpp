#include "server/network/send_queue.h"

#include <gtest/gtest.h>

namespace evod::network {
namespace {

using Kind = SendQueue::Kind;

SharedBytes frame(std::size_t bytes, char fill = 'x') {
    return std::make_shared<const std::string>(bytes, fill);
}

class SendQueueTest : public testing::Test {
  protected:
    std::string being_sent() const {
        std::string text;
        for (const boost::asio::const_buffer& buffer : queue.buffers()) {
            text.append(static_cast<const char*>(buffer.data()), buffer.size());
        }
        return text;
    }

    SendMemory memory{std::size_t{1} << 30, [] {}};
    SendQueue queue{memory};
};

TEST_F(SendQueueTest, SendsFramesInOrderAndCountsAnswers) {
    EXPECT_TRUE(queue.is_idle());
    queue.push(frame(1, 'a'), Kind::Answer);
    queue.push(frame(2, 'b'), Kind::Event);
    queue.push(frame(3, 'c'), Kind::Unasked);
    queue.push(frame(4, 'd'), Kind::Answer);
    EXPECT_TRUE(queue.has_waiting_frames());
    EXPECT_FALSE(queue.is_sending());
    EXPECT_EQ(queue.begin_batch(), 2u);
    EXPECT_EQ(being_sent(), "abbcccdddd");
    EXPECT_FALSE(queue.has_waiting_frames());
    EXPECT_FALSE(queue.is_idle());
    EXPECT_EQ(queue.held_bytes(), 10 + 4 * (bytes_per_frame + bytes_per_holder));
    EXPECT_EQ(memory.bytes(), queue.held_bytes());
    queue.end_sending();
    EXPECT_TRUE(queue.is_idle());
    EXPECT_EQ(being_sent(), "");
    EXPECT_EQ(memory.bytes(), 0u);
}

TEST_F(SendQueueTest, ABatchHasALimit) {
    for (int i = 0; i < 100; ++i) {
        queue.push(frame(1), Kind::Answer);
    }
    const std::size_t first = queue.begin_batch();
    EXPECT_LT(first, 100u);
    queue.end_sending();
    EXPECT_EQ(queue.begin_batch(), 100 - first);
}

TEST_F(SendQueueTest, UnreadResponsesAreLimited) {
    queue.push(frame(queued_response_bytes_max), Kind::Unasked);
    queue.push(frame(1000), Kind::Event);
    EXPECT_FALSE(queue.exceeds_limit()) << "events do not count";
    queue.begin_batch();
    queue.push(frame(1), Kind::Answer);
    EXPECT_TRUE(queue.exceeds_limit()) << "bytes that are being sent count";
    queue.end_sending();
    EXPECT_FALSE(queue.exceeds_limit());
}

TEST_F(SendQueueTest, DropsEventsUntilTheirNumberIsReported) {
    queue.push(frame(queued_event_bytes_max), Kind::Event);
    EXPECT_FALSE(queue.has_room_for_event(1));
    queue.count_dropped_events(1);
    queue.begin_batch();
    queue.end_sending();
    EXPECT_FALSE(queue.has_room_for_event(1)) << "the client must know where the gap is";
    EXPECT_FALSE(queue.is_idle());
    queue.count_dropped_events(2);
    EXPECT_EQ(queue.take_dropped_events(), 3u);
    EXPECT_EQ(queue.take_dropped_events(), 0u);
    EXPECT_TRUE(queue.has_room_for_event(codec::header_bytes));
}

TEST_F(SendQueueTest, TheClientLimitsTheSizeOfFrames) {
    EXPECT_TRUE(queue.accepts(std::size_t{1} << 40));
    queue.set_frame_bytes_max(100);
    EXPECT_TRUE(queue.accepts(codec::header_bytes + 100));
    EXPECT_FALSE(queue.accepts(codec::header_bytes + 101));
    EXPECT_FALSE(queue.has_room_for_event(codec::header_bytes + 101));
}

TEST_F(SendQueueTest, SendsTheRestOfASnapshotWithoutCopying) {
    SendQueue::Header header;
    header.fill(std::byte{'h'});
    const SharedBytes first = frame(20, 'a'), second = frame(20, 'b');
    const std::string whole = std::string(header.size(), 'h') + *first + *second + "tail";
    for (const std::size_t accepted : {std::size_t{0}, std::size_t{3}, header.size() + 25, whole.size() - 1}) {
        const std::array parts{&first, &second};
        queue.begin_rest(header, parts, "tail", accepted);
        EXPECT_EQ(being_sent(), whole.substr(accepted));
        EXPECT_TRUE(queue.is_sending());
        EXPECT_EQ(queue.held_bytes(), 2 * (20 / 2)) << "the test holds the parts, too";
        EXPECT_EQ(memory.bytes(), 0u) << "SnapshotMemory counts the parts";
        queue.end_sending();
        EXPECT_TRUE(queue.is_idle());
        EXPECT_EQ(queue.held_bytes(), 0u);
    }
    queue.begin_rest(frame(5, 'r'));
    EXPECT_EQ(being_sent(), "rrrrr");
    EXPECT_FALSE(queue.exceeds_limit());
}

TEST_F(SendQueueTest, KeepsWhatIsBeingSentWhenItDropsTheRest) {
    queue.push(frame(3, 'a'), Kind::Answer);
    queue.begin_batch();
    queue.push(frame(100, 'b'), Kind::Answer);
    queue.drop_waiting();
    EXPECT_EQ(being_sent(), "aaa");
    EXPECT_EQ(memory.bytes(), 3 + bytes_per_frame + bytes_per_holder);
}

} // namespace
} // namespace evod::network
