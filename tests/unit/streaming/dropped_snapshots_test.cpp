// Dropped snapshots: viewers that miss snapshots in every combination of ways. What each of them decodes equals what
// the server had, whole number for whole number, whatever was dropped.
//
// The environment variable FRAMES sets how many snapshots are compared; docs/LONG_TESTS.md.
#include "tests/support/everyday.h"
#include "tests/unit/codec/living_island.h"
#include "tests/unit/streaming/viewer.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace evod::streaming {
namespace {

using namespace std::chrono_literals;
using codec::below;
using codec::Random;
using runtime::Clock;

/// The server's end: an island that lives, dies out, is populated again and pauses; and its delta stream.
class Server {
  public:
    Server(std::uint64_t seed, double side_px) : random_{seed} {
        island_.side_px = side_px;
        island_.populate(random_);
    }

    StreamedSnapshotPtr next() {
        std::uint64_t ticks = below(random_, 8) == 0 ? 0 : 1 + below(random_, 4); // 0: it is paused
        if (below(random_, 60) == 0) {
            ticks += 300; // a command took long
        }
        if (ticks > 0) {
            island_.live(random_, ticks);
        }
        tick_ += ticks;
        if (below(random_, 150) == 0) { // the next generation, or another run
            const double side_px = island_.side_px;
            island_ = {};
            island_.side_px = side_px;
            island_.populate(random_);
            tick_ = below(random_, 3);
            ++generation_;
        }
        if (below(random_, 40) == 0) {
            island_.organisms.clear();
        }
        if (below(random_, 40) == 0) {
            island_.food.clear();
        }
        v1::SnapshotFrame about = island_.about();
        about.set_sequence(++sequence_);
        about.set_generation(generation_);
        about.set_generation_tick(tick_);
        snapshot_ = island_.snapshot();
        now_ += between;
        return latest_ = std::make_shared<StreamedSnapshot>(
                   std::make_shared<EncodedIsland>(std::move(about), snapshot_, compressor_), Form::Whole, latest_,
                   now_, between);
    }
    const codec::QuantisedSnapshot& snapshot() const { return snapshot_; }

  private:
    static constexpr auto between = 50ms;
    Random random_;
    codec::LivingIsland island_;
    codec::QuantisedSnapshot snapshot_;
    codec::Compressor compressor_;
    std::uint64_t sequence_ = 0, tick_ = 0, generation_ = 1;
    Clock::time_point now_{1h};
    StreamedSnapshotPtr latest_;
};

/// What happens to a viewer, each in 1/1000 of the snapshots.
struct Habits {
    std::uint64_t slow = 0;    // replaced by newer ones before they are sent
    std::uint64_t lost = 0;    // sent, but not decoded
    std::uint64_t damaged = 0; // received with one bit flipped
    std::uint64_t asks = 0;    // preceded by an unnecessary request for a keyframe
    v1::Compression compression = v1::COMPRESSION_NONE;
};

class DroppingViewer {
  public:
    DroppingViewer(const Habits& habits, std::uint64_t seed)
        : habits_{habits}, random_{seed}, viewer_{habits.compression} {}

    /// Returns whether a snapshot was received and compared.
    bool take(StreamedSnapshot& snapshot, const codec::QuantisedSnapshot& expected) {
        if (skipped_ > 0 || happens(habits_.slow)) { // often several in a row
            skipped_ = skipped_ > 0 ? skipped_ - 1 : below(random_, 6);
            return false;
        }
        if (happens(habits_.asks)) {
            viewer_.request_keyframe();
        }
        v1::SnapshotFrame frame = viewer_.send(snapshot);
        (frame.base_sequence() == 0 ? keyframes_ : deltas_) += 1;
        if (happens(habits_.lost)) {
            return false;
        }
        if (happens(habits_.damaged) && !frame.body().empty()) {
            char& byte = (*frame.mutable_body())[below(random_, frame.body().size())];
            byte = static_cast<char>(byte ^ (1 << below(random_, 8)));
            // A few bits of a zstd frame are unused; every other flip must be detected.
            const bool unused = viewer_.decode(std::move(frame)).has_value();
            if (unused) {
                EXPECT_EQ(*viewer_.snapshot(), expected) << "snapshot " << snapshot.sequence();
            }
            decoded_ = snapshot.sequence();
            if (!unused) {
                refused();
            }
            return unused;
        }
        const bool has_base = frame.base_sequence() == 0 || frame.base_sequence() == decoded_;
        const auto decoded = viewer_.decode(std::move(frame));
        EXPECT_EQ(decoded.has_value(), has_base) << "snapshot " << snapshot.sequence();
        if (!decoded) {
            refused();
            return false;
        }
        decoded_ = snapshot.sequence();
        EXPECT_EQ(*viewer_.snapshot(), expected) << "snapshot " << snapshot.sequence();
        return true;
    }
    std::uint64_t keyframes() const { return keyframes_; }
    std::uint64_t deltas() const { return deltas_; }
    std::uint64_t refusals() const { return refusals_; }

  private:
    bool happens(std::uint64_t share) { return below(random_, 1000) < share; }
    /// Requests a keyframe, as clients do after damage.
    void refused() {
        EXPECT_TRUE(viewer_.needs_keyframe());
        viewer_.request_keyframe();
        decoded_ = 0;
        ++refusals_;
    }

    Habits habits_;
    Random random_;
    Viewer viewer_;
    std::uint64_t decoded_ = 0; // sequence of the decoder's baseline
    std::uint64_t skipped_ = 0, keyframes_ = 0, deltas_ = 0, refusals_ = 0;
};

TEST(DroppedSnapshots, DecodedSnapshotsEqualThoseOfTheServer) {
    const std::vector<Habits> all_habits{
        {},
        {.compression = v1::COMPRESSION_ZSTD},
        {.slow = 100},
        {.slow = 300, .compression = v1::COMPRESSION_ZSTD},
        {.slow = 50, .lost = 50},
        {.slow = 20, .lost = 20, .damaged = 20, .asks = 20, .compression = v1::COMPRESSION_ZSTD},
        {.slow = 700, .lost = 200, .damaged = 100, .asks = 100},
    };
    const std::uint64_t wanted = everyday_size("FRAMES", 4000);
    std::uint64_t compared = 0, refusals = 0;
    for (std::uint64_t seed = 1; compared < wanted; ++seed) {
        Server server{seed, seed % 2 == 0 ? 4000.0 : 200'000.0};
        std::vector<DroppingViewer> viewers;
        for (const Habits& habits : all_habits) {
            viewers.emplace_back(habits, 1000 * seed + viewers.size());
        }
        for (int n = 0; n < 250; ++n) {
            const StreamedSnapshotPtr snapshot = server.next();
            for (DroppingViewer& viewer : viewers) {
                compared += viewer.take(*snapshot, server.snapshot());
            }
            ASSERT_FALSE(HasFailure()) << "seed " << seed << ", after snapshot " << n;
        }
        for (std::size_t v = 0; v < viewers.size(); ++v) {
            EXPECT_GT(viewers[v].keyframes(), 0U) << "viewer " << v;
            EXPECT_GT(viewers[v].deltas(), v + 1 < viewers.size() ? 20U : 0U) << "viewer " << v;
            refusals += viewers[v].refusals();
        }
    }
    EXPECT_GT(refusals, 0U);
    RecordProperty("compared", std::to_string(compared));
}

} // namespace
} // namespace evod::streaming
