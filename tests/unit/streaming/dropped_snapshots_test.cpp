// Viewers who miss pictures, of every kind at once: what each of them makes of what comes is, whole number for whole
// number, what the server had, whatever was dropped on the way.
//
// FRAMES, in the environment, says how many pictures are compared; docs/LONG_TESTS.md.
#include "server/streaming/delta_stream.h"

#include "proto/codec/snapshot_decoder.h"
#include "tests/support/everyday.h"
#include "tests/unit/codec/living_island.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace evod::streaming {
namespace {

using namespace std::chrono_literals;
using codec::below;
using codec::Random;
using runtime::Clock;

/// The server's end: an island that lives, dies out, is born again, stands still; and its chain.
class Server {
  public:
    Server(std::uint64_t seed, double side_px) : random_{seed} {
        island_.side_px = side_px;
        island_.populate(random_);
    }

    DeltaSnapshotPtr next() {
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
        scene_ = std::make_shared<const codec::QuantisedSnapshot>(island_.scene());
        now_ += between;
        return chain_.add(std::make_shared<const v1::SnapshotFrame>(std::move(about)), scene_, compressor_, now_,
                          between);
    }
    const codec::QuantisedSnapshot& scene() const { return *scene_; }

  private:
    static constexpr auto between = 50ms;
    Random random_;
    codec::LivingIsland island_;
    std::shared_ptr<const codec::QuantisedSnapshot> scene_;
    codec::Compressor compressor_;
    std::uint64_t sequence_ = 0, tick_ = 0, generation_ = 1;
    Clock::time_point now_{1h};
    DeltaStream chain_;
};

/// How a viewer fares, each a share of 1000.
struct Habits {
    std::uint64_t slow = 0;    // pictures that are replaced by newer ones before they are sent
    std::uint64_t lost = 0;    // what is sent and not looked at
    std::uint64_t damaged = 0; // what comes with a bit turned
    std::uint64_t asks = 0;    // asks for a keyframe without need
    v1::Compression compression = v1::COMPRESSION_NONE;
};

class DroppingViewer {
  public:
    DroppingViewer(const Habits& habits, std::uint64_t seed) : habits_{habits}, random_{seed} {}

    /// Returns whether a picture came to be compared.
    bool take(DeltaSnapshot& picture, const codec::QuantisedSnapshot& scene) {
        if (hiccup_ > 0 || happens(habits_.slow)) { // often several one after another
            hiccup_ = hiccup_ > 0 ? hiccup_ - 1 : below(random_, 6);
            return false;
        }
        if (happens(habits_.asks)) {
            sent_ = 0;
        }
        v1::SnapshotFrame frame;
        EXPECT_TRUE(frame.ParseFromString(*picture.after(sent_, habits_.compression)));
        sent_ = picture.sequence();
        (frame.base_sequence() == 0 ? keyframes_ : deltas_) += 1;
        if (happens(habits_.lost)) {
            return false;
        }
        if (happens(habits_.damaged) && !frame.body().empty()) {
            char& byte = (*frame.mutable_body())[below(random_, frame.body().size())];
            byte = static_cast<char>(byte ^ (1 << below(random_, 8)));
            // A few bits of a zstd frame mean nothing; any other must be found out.
            const bool means_nothing = decoder_.decode(std::move(frame)).has_value();
            if (means_nothing) {
                EXPECT_EQ(*decoder_.scene(), scene) << "picture " << picture.sequence();
            }
            decoded_ = picture.sequence();
            if (!means_nothing) {
                refused();
            }
            return means_nothing;
        }
        const bool has_base = frame.base_sequence() == 0 || frame.base_sequence() == decoded_;
        const auto decoded = decoder_.decode(std::move(frame));
        EXPECT_EQ(decoded.has_value(), has_base) << "picture " << picture.sequence();
        if (!decoded) {
            refused();
            return false;
        }
        decoded_ = picture.sequence();
        EXPECT_EQ(*decoder_.scene(), scene) << "picture " << picture.sequence();
        return true;
    }
    std::uint64_t keyframes() const { return keyframes_; }
    std::uint64_t deltas() const { return deltas_; }
    std::uint64_t refusals() const { return refusals_; }

  private:
    bool happens(std::uint64_t share) { return below(random_, 1000) < share; }
    /// Asks for a keyframe, as clients do.
    void refused() {
        EXPECT_TRUE(decoder_.needs_keyframe());
        sent_ = decoded_ = 0;
        ++refusals_;
    }

    Habits habits_;
    Random random_;
    codec::SnapshotDecoder decoder_;
    std::uint64_t sent_ = 0;    // as the server has it
    std::uint64_t decoded_ = 0; // what the decoder stands on
    std::uint64_t hiccup_ = 0, keyframes_ = 0, deltas_ = 0, refusals_ = 0;
};

TEST(DroppedSnapshots, WhatIsDecodedIsWhatTheServerHad) {
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
            const DeltaSnapshotPtr picture = server.next();
            for (DroppingViewer& viewer : viewers) {
                compared += viewer.take(*picture, server.scene());
            }
            ASSERT_FALSE(HasFailure()) << "seed " << seed << ", after picture " << n;
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
