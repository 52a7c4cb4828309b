#include "server/streaming/snapshot_queue.h"

#include "tests/support/manual_clock.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>

namespace evod::streaming {
namespace {

using namespace std::chrono_literals;

class SnapshotQueueTest : public testing::Test, protected SnapshotSender {
  protected:
    void send_snapshots() override {}
    void send_snapshots_later() override { ++wakes; }

    StreamedSnapshotPtr snapshot(std::uint64_t sequence, Form form = Form::Whole, std::size_t organisms = 1) {
        v1::SnapshotFrame about;
        about.set_sequence(sequence);
        about.set_width_px(1000);
        about.set_height_px(1000);
        about.set_island_count(1);
        codec::QuantisedSnapshot entities;
        for (std::uint32_t id = 0; id < organisms; ++id) {
            for (codec::Column* column : {&entities.organisms.id, &entities.organisms.x, &entities.organisms.y,
                                          &entities.organisms.width, &entities.organisms.height}) {
                column->push_back(id);
            }
        }
        auto island = std::make_shared<EncodedIsland>(std::move(about), std::move(entities), compressor);
        return newest = std::make_shared<StreamedSnapshot>(std::move(island), form, newest, clock.now(), 50ms);
    }
    SnapshotSubscription& subscribe(std::uint32_t id = 1) {
        SnapshotSubscription& subscription = queue.subscriptions[id];
        subscription.codec = v1::CODEC_DELTA;
        return subscription;
    }
    /// The next frame; nullopt: none may be sent.
    std::optional<v1::SnapshotFrame> next() {
        const OutgoingFrame* const outgoing = queue.next();
        if (outgoing == nullptr) {
            return std::nullopt;
        }
        std::string bytes;
        for (const SharedBytes* part : outgoing->parts) {
            bytes += **part;
        }
        bytes += outgoing->tail_view();
        EXPECT_EQ(bytes.size(), outgoing->body_bytes());
        v1::SnapshotFrame frame;
        EXPECT_TRUE(frame.ParseFromString(bytes));
        return frame;
    }
    void acknowledge(std::uint64_t sequence) {
        v1::AcknowledgeSnapshot acknowledged;
        acknowledged.set_subscription_id(1);
        acknowledged.set_sequence(sequence);
        queue.acknowledge(acknowledged);
    }

    support::ManualClock clock;
    metrics::Counter dropped;
    codec::Compressor compressor;
    StreamedSnapshotPtr newest;
    SnapshotQueue queue{clock, dropped, *this};
    int wakes = 0;
};

TEST_F(SnapshotQueueTest, ANewerSnapshotReplacesTheWaitingOne) {
    subscribe();
    for (std::uint64_t sequence = 1; sequence <= 3; ++sequence) {
        queue.offer(1, 0, snapshot(sequence));
    }
    const auto frame = next();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->sequence(), 3U);
    EXPECT_EQ(frame->dropped_count(), 2U);
    EXPECT_EQ(frame->subscription_id(), 1U);
    EXPECT_EQ(dropped.value(), 2U);
    EXPECT_FALSE(next());
}

TEST_F(SnapshotQueueTest, SubscriptionsTakeTurns) {
    subscribe(1);
    subscribe(2);
    const auto shared = snapshot(1);
    for (const std::uint32_t island : {0U, 1U}) {
        for (const std::uint32_t id : {1U, 2U}) {
            queue.offer(id, island, shared);
        }
    }
    for (const std::uint32_t id : {1U, 2U, 1U, 2U}) {
        EXPECT_EQ(next()->subscription_id(), id);
    }
}

TEST_F(SnapshotQueueTest, AfterADroppedSnapshotAKeyframeFollows) {
    subscribe();
    queue.offer(1, 0, snapshot(1));
    EXPECT_EQ(next()->base_sequence(), 0U);
    queue.offer(1, 0, snapshot(2));
    EXPECT_EQ(next()->base_sequence(), 1U);
    queue.offer(1, 0, snapshot(3));
    queue.offer(1, 0, snapshot(4));
    EXPECT_EQ(next()->base_sequence(), 0U);
}

TEST_F(SnapshotQueueTest, ARequestedKeyframeIsTheNewestSnapshot) {
    subscribe();
    queue.offer(1, 0, snapshot(1));
    next();
    queue.offer(1, 0, snapshot(2));
    next();
    queue.send_keyframe(1, 0, newest);
    EXPECT_EQ(wakes, 1);
    const auto frame = next();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->sequence(), 2U);
    EXPECT_EQ(frame->base_sequence(), 0U);
}

TEST_F(SnapshotQueueTest, AKeyframeThatWaitsIsNotRequestedAgain) {
    subscribe();
    queue.offer(1, 0, snapshot(1));
    next();
    EXPECT_TRUE(queue.send_keyframe(1, 0, newest));
    const std::size_t bytes = queue.held_bytes();
    for (int i = 0; i < 100; ++i) {
        EXPECT_FALSE(queue.send_keyframe(1, 0, newest));
    }
    EXPECT_EQ(wakes, 1);
    EXPECT_EQ(queue.held_bytes(), bytes);
    EXPECT_TRUE(next());
    EXPECT_FALSE(next());
    EXPECT_TRUE(queue.send_keyframe(1, 0, newest)) << "it was sent";
}

TEST_F(SnapshotQueueTest, AnIslandKeepsItsTurn) {
    subscribe();
    const auto shared = snapshot(1);
    queue.offer(1, 0, shared);
    queue.offer(1, 1, shared);
    const std::size_t bytes = queue.held_bytes();
    for (int i = 0; i < 100; ++i) {
        queue.send_again(1, 0, shared);
    }
    EXPECT_EQ(queue.held_bytes(), bytes);
    queue.unsubscribe(1);
    subscribe();
    EXPECT_FALSE(next());
}

TEST_F(SnapshotQueueTest, AKeyframeCanBeDelayed) {
    subscribe();
    queue.offer(1, 0, snapshot(1));
    next();
    queue.send_keyframe(1, 0, newest, clock.now() + 10ms);
    EXPECT_FALSE(next());
    EXPECT_EQ(queue.retry_at(), clock.now() + 10ms);
    queue.send_again(1, 0, newest); // the view has changed
    EXPECT_TRUE(next());
    EXPECT_FALSE(next());
    queue.send_keyframe(1, 0, newest, clock.now() + 10ms);
    EXPECT_FALSE(next());
    clock.advance(10ms);
    EXPECT_EQ(next()->base_sequence(), 0U);
    EXPECT_FALSE(next());
}

TEST_F(SnapshotQueueTest, HoldsNothingAfterTheLastSubscription) {
    subscribe().unacknowledged_max = 5;
    const std::size_t before = queue.held_bytes();
    for (std::uint64_t sequence = 1; sequence <= 4; ++sequence) {
        queue.offer(1, 0, snapshot(sequence));
        next();
    }
    EXPECT_GT(queue.held_bytes(), before + 4 * sizeof(std::uint64_t));
    queue.forget_islands(queue.subscriptions.at(1), 0);
    EXPECT_EQ(queue.held_bytes(), before);
    queue.unsubscribe(1);
    EXPECT_EQ(queue.held_bytes(), 0U);
}

TEST_F(SnapshotQueueTest, UnacknowledgedSnapshotsAreLimited) {
    subscribe().unacknowledged_max = 2;
    for (std::uint64_t sequence = 1; sequence <= 2; ++sequence) {
        queue.offer(1, 0, snapshot(sequence));
        EXPECT_TRUE(next());
    }
    queue.offer(1, 0, snapshot(3));
    EXPECT_FALSE(next());
    acknowledge(1);
    EXPECT_EQ(next()->sequence(), 3U);
    queue.offer(1, 0, snapshot(4));
    EXPECT_FALSE(next());
    acknowledge(3);
    EXPECT_EQ(next()->sequence(), 4U);
}

TEST_F(SnapshotQueueTest, FramesThatTheClientRejectsAreDropped) {
    subscribe();
    queue.set_frame_bytes_max(1000);
    queue.offer(1, 0, snapshot(1));
    EXPECT_TRUE(next());
    queue.offer(1, 0, snapshot(2, Form::Whole, 1000));
    EXPECT_FALSE(next());
    EXPECT_EQ(dropped.value(), 1U);
    queue.offer(1, 0, snapshot(3));
    EXPECT_EQ(next()->base_sequence(), 0U) << "the client does not have snapshot 2";
}

TEST_F(SnapshotQueueTest, TheBandwidthLimitDelaysSnapshots) {
    v1::View view;
    view.set_bytes_per_s_max(1000);
    subscribe().set_view(view);
    std::size_t sent = 0;
    for (std::uint64_t sequence = 1; sequence <= 100; ++sequence) { // 10 s
        queue.offer(1, 0, snapshot(sequence, Form::Tiles, 300));
        while (const OutgoingFrame* outgoing = queue.next()) {
            sent += outgoing->body_bytes();
        }
        clock.advance(100ms);
    }
    EXPECT_GT(sent, 5'000U);
    EXPECT_LT(sent, 12'500U);
    EXPECT_LT(queue.retry_at(), SnapshotQueue::Clock::time_point::max());
}

TEST_F(SnapshotQueueTest, AStoppedQueueTakesNothing) {
    subscribe();
    queue.stop();
    queue.offer(1, 0, snapshot(1));
    EXPECT_FALSE(next());
}

} // namespace
} // namespace evod::streaming
