// The memory that is counted for sessions, compared with the memory that is allocated.
#include "server/base/inline_executor.h"
#include "server/network/requests_in_flight.h"
#include "server/network/send_queue.h"
#include "server/replay/rerun.h"
#include "server/simulation/world_bytes.h"
#include "server/streaming/snapshot_streams.h"
#include "tests/support/manual_clock.h"
#include "tests/unit/network/held_memory.h"

#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <deque>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace evod::network {
namespace {

/// Compares what is counted with what has been allocated since its construction.
class Truth {
  public:
    void agrees_with(std::size_t counted, const std::string& what) const {
        const auto allocated = static_cast<double>(tests::held_memory() - before_);
        const double ratio = static_cast<double>(counted) / allocated;
        EXPECT_GT(ratio, 0.8) << what << ": counted " << counted << ", allocated " << allocated;
        EXPECT_LT(ratio, 1.2) << what << ": counted " << counted << ", allocated " << allocated;
    }

  private:
    std::size_t before_ = tests::held_memory();
};

class AccountTest : public testing::Test {
  protected:
    SendMemory memory{std::size_t{1} << 40, [] {}};
};

// ---- requests and frames ---------------------------------------------------------------------------------------

TEST_F(AccountTest, OfRequestsThatAreHeldBack) {
    (void)v1::Request{}.SpaceUsedLong(); // the first call reads the descriptors
    for (const std::size_t text_bytes : {std::size_t{40}, std::size_t{50'000}}) {
        RequestsInFlight requests{memory};
        const Truth truth;
        for (std::uint32_t i = 0; i < requests_in_flight_max; ++i) {
            v1::Request request;
            request.set_request_id(i);
            request.set_client_key(std::string(text_bytes, 'k'));
            request.mutable_get_history()->set_world("w");
            requests.hold_back(std::move(request));
        }
        truth.agrees_with(memory.bytes(), "requests of " + std::to_string(text_bytes) + " bytes");
    }
    EXPECT_EQ(memory.bytes(), 0u);
}

TEST_F(AccountTest, OfFramesThatWait) {
    for (const std::size_t frame_bytes : {std::size_t{60}, std::size_t{400}, std::size_t{200'000}}) {
        std::deque<SendQueue> queues; // of two sessions that share the frames
        queues.emplace_back(memory);
        queues.emplace_back(memory);
        const Truth truth;
        for (int i = 0; i < 50; ++i) {
            const auto event = std::make_shared<const std::string>(frame_bytes, 'e');
            for (SendQueue& queue : queues) {
                queue.push(event, SendQueue::Kind::Event);
            }
        }
        truth.agrees_with(memory.bytes(), "frames of " + std::to_string(frame_bytes) + " bytes");
    }
    EXPECT_EQ(memory.bytes(), 0u);
}

TEST_F(AccountTest, OfAnIncompleteFrame) {
    codec::FrameReader reader{{.control_bytes_max = 1 << 20, .stream_bytes_max = std::nullopt}};
    const Truth truth;
    reader.feed(codec::encode_header({.channel = codec::Channel::Control, .body_bytes = 900'000}));
    const std::array<std::byte, 16'384> bytes{};
    for (int i = 0; i < 50; ++i) {
        reader.feed(bytes);
    }
    truth.agrees_with(reader.capacity_bytes(), "an incomplete frame");
}

// ---- subscriptions ---------------------------------------------------------------------------------------------

class SubscriptionAccountTest : public AccountTest {
  protected:
    static constexpr std::uint32_t island_count = 500;

    struct Viewer final : streaming::SnapshotSender {
        Viewer(runtime::Clock& clock, metrics::Counter& dropped) : queue{clock, dropped, *this} {}
        void send_snapshots() override {}
        void send_snapshots_later() override {}
        streaming::SnapshotQueue queue;
    };
    /// A session with a subscription to all islands.
    void subscribe(streaming::SnapshotSubscription subscription) {
        viewers.push_back(std::make_unique<Viewer>(clock, dropped));
        subscription.world = "w";
        subscription.island_count = island_count;
        streams.subscribe(viewers.size(), viewers.back()->queue, 1, std::move(subscription));
    }
    void deliver(std::uint64_t tick, std::size_t organisms) {
        auto snapshot = std::make_shared<runtime::Snapshot>();
        snapshot->world = "w";
        snapshot->moment.tick = snapshot->moment.generation_tick = tick;
        snapshot->moment.generation = 1;
        snapshot->island_count = island_count;
        snapshot->islands.resize(island_count);
        for (std::uint32_t i = 0; i < island_count; ++i) {
            runtime::IslandSnapshot& island = snapshot->islands[i];
            island.island = i;
            island.width_px = island.height_px = 1000;
            island.organisms.alive_count = static_cast<std::uint32_t>(organisms);
            for (std::uint32_t id = 0; id < organisms; ++id) {
                island.organisms.place_of.push_back(id);
                island.organisms.x.push_back(static_cast<physics::Coordinate>(100 + id));
                island.organisms.y.push_back(static_cast<physics::Coordinate>(100 + id));
                island.organisms.radius_px.push_back(5);
                island.organisms.health.push_back(50);
            }
        }
        std::vector<runtime::Outbox::NewestSnapshot> taken;
        taken.push_back({.snapshot = std::move(snapshot), .after_change = true});
        streams.deliver(std::move(taken));
        while (streams.distribute(clock.now())) {
            // The next islands.
        }
        clock.advance(std::chrono::seconds{1});
    }
    void send_all() {
        for (const auto& viewer : viewers) {
            while (viewer->queue.next() != nullptr) {
                // The next frame.
            }
            viewer->queue.release();
        }
    }
    std::size_t counted() const {
        std::size_t bytes = memory.bytes();
        for (const auto& viewer : viewers) {
            bytes += viewer->queue.held_bytes();
        }
        return bytes;
    }
    std::size_t shares() const {
        std::size_t bytes = 0;
        for (const auto& [session, share] : streams.shared_bytes()) {
            bytes += share;
        }
        return bytes;
    }

    support::ManualClock clock;
    metrics::Counter dropped;
    streaming::SnapshotStreams streams{&memory};
    std::vector<std::unique_ptr<Viewer>> viewers;
};

TEST_F(SubscriptionAccountTest, OfManyIslandsInEachForm) {
    v1::View density, full;
    density.set_detail(v1::DETAIL_DENSITY);
    full.set_detail(v1::DETAIL_FULL);
    for (const std::size_t organisms : {std::size_t{4}, std::size_t{300}}) {
        for (const int form : {0, 1, 2, 3}) {
            const std::string what = "form " + std::to_string(form) + ", " + std::to_string(organisms) + " organisms";
            const Truth truth;
            for (int i = 0; i < 3; ++i) {
                streaming::SnapshotSubscription subscription;
                subscription.rate_hz = 1 + i % 2; // two share their snapshots
                subscription.unacknowledged_max = 2;
                if (form > 0) {
                    subscription.codec = v1::CODEC_DELTA;
                }
                if (form > 1) {
                    subscription.set_view(form == 2 ? density : full);
                }
                subscribe(std::move(subscription));
            }
            for (std::uint64_t tick = 1; tick <= 3; ++tick) {
                deliver(tick, organisms);
                truth.agrees_with(counted(), what + ", waiting");
                send_all();
            }
            truth.agrees_with(counted(), what + ", sent");
            EXPECT_NEAR(static_cast<double>(shares()) / static_cast<double>(memory.bytes()), 1, 0.2) << what;
            for (std::size_t number = 1; number <= viewers.size(); ++number) {
                streams.unsubscribe(number, viewers[number - 1]->queue, 1);
                EXPECT_LT(viewers[number - 1]->queue.held_bytes(), 1000u);
            }
            EXPECT_EQ(memory.bytes(), 0u) << what;
            viewers.clear();
        }
    }
}

TEST_F(SubscriptionAccountTest, OfRequestedKeyframesThatAreNotRead) {
    const Truth truth;
    streaming::SnapshotSubscription subscription;
    subscription.codec = v1::CODEC_DELTA;
    subscribe(std::move(subscription));
    deliver(1, 4);
    send_all();
    const std::size_t before = viewers[0]->queue.held_bytes();
    for (int i = 0; i < 28; ++i) {
        streams.send_keyframes(viewers[0]->queue, 1);
    }
    truth.agrees_with(counted(), "keyframes");
    EXPECT_LT(viewers[0]->queue.held_bytes() - before, 2 * 24 * island_count) << "an island has one turn";
}

TEST_F(SubscriptionAccountTest, OfManyUnacknowledgedSnapshots) {
    const Truth truth;
    streaming::SnapshotSubscription subscription;
    subscription.codec = v1::CODEC_DELTA;
    subscription.unacknowledged_max = 1000;
    subscribe(std::move(subscription));
    for (std::uint64_t tick = 1; tick <= 100; ++tick) {
        deliver(tick, 1);
        send_all();
    }
    truth.agrees_with(counted(), "unacknowledged");
}

// ---- replays ---------------------------------------------------------------------------------------------------

TEST(ReplayAccount, OfItsWorld) {
    base::InlineExecutor executor;
    struct Case {
        std::uint32_t population, islands, hidden;
        bool scaled;
        int generations;
        std::uint32_t predators = 0; // with births
    };
    for (const Case& of : {Case{50, 1, 0, false, 2}, Case{20'000, 1, 0, true, 1}, Case{2000, 1, 8, true, 1},
                           Case{2000, 1, 32, true, 1}, Case{2000, 1, 0, true, 1}, Case{200, 1, 0, true, 1},
                           Case{30, 100, 0, false, 2}, Case{50, 1, 0, false, 400}, Case{2000, 1, 0, true, 2, 300}}) {
        parameters::Parameters parameters;
        parameters.population_size = of.population;
        parameters.island_count = of.islands;
        parameters.scale_with_population = of.scaled;
        parameters.generation_s = of.generations > 2 ? 0.02 : 1;
        if (of.hidden > 0) {
            parameters.controller = evolution::Controller::Network;
            parameters.brain_hidden = of.hidden;
        }
        if (of.predators > 0) {
            parameters.reproduction = parameters::Reproduction::Births;
            parameters.predator_count = of.predators;
        }
        const Truth truth;
        simulation::World world{parameters, base::Seed{1}};
        for (int generation = 0; generation < of.generations; ++generation) {
            do {
                world.advance_tick(executor);
            } while (!world.generation_over() && world.outcome() == evolution::Outcome::Running);
        }
        for (int tick = 0; tick < 20 && world.outcome() == evolution::Outcome::Running; ++tick) {
            world.advance_tick(executor);
        }
        (void)world.take_events();
        truth.agrees_with(simulation::estimated_bytes(world), std::to_string(of.population) + " organisms, " +
                                                                  std::to_string(of.islands) + " islands, " +
                                                                  std::to_string(of.generations) + " generations");
    }
}

TEST(ReplayAccount, OfChangesThatCome) {
    const Truth truth;
    replay::ComingChanges coming{0};
    {
        std::vector<replay::WorldChange> changes;
        for (std::uint64_t entry = 1; entry <= 100; ++entry) {
            changes.push_back({.entry = entry,
                               .tick = entry,
                               .assignments = {},
                               .checked = std::make_shared<const replay::CheckedCommand>(simulation::SetFitness{
                                   .world = "w", .generation = 1, .fitness = std::vector<double>(1000, 0.5)})});
        }
        const std::size_t before_copy = tests::held_memory();
        ASSERT_TRUE(coming.extend("w.evod", changes));
        EXPECT_LT(tests::held_memory() - before_copy, 100'000u) << "copies of a change share the fitness";
    }
    truth.agrees_with(coming.held_bytes(), "coming changes");
}

} // namespace
} // namespace evod::network
