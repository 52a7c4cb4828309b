#include "proto/codec/snapshot_decoder.h"

#include "proto/codec/compression.h"
#include "tests/unit/codec/living_island.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>

namespace evod::codec {
namespace {

/// The server's end: each snapshot as a keyframe and, except for the first, as a delta.
class Sender {
  public:
    struct Sent {
        evod::v1::SnapshotFrame plain, keyframe, delta;
    };

    Sent send(const LivingIsland& island, std::uint16_t ticks) {
        Sent sent{.plain = island.about(), .keyframe = island.about(), .delta = {}};
        const auto snapshot = std::make_shared<const QuantisedSnapshot>(island.snapshot());
        encode_plain(*snapshot, sent.plain);
        const bool has_base = baseline_.snapshot && follows(*snapshot, *baseline_.snapshot);
        sent.keyframe.set_sequence(++sequence_);
        sent.keyframe.set_codec(evod::v1::CODEC_DELTA);
        sent.delta = sent.keyframe;
        if (has_base) {
            sent.delta.set_base_sequence(sequence_ - 1);
            sent.delta.set_body(encode_delta(baseline_, *snapshot, ticks));
            sent.delta.set_checksum(checksum_of(sent.delta, sent.delta.body()));
            clear_unchanging(sent.delta);
        }
        baseline_ = has_base ? advanced_baseline(baseline_, snapshot, ticks) : initial_baseline(snapshot);
        sent.keyframe.set_body(encode_keyframe(baseline_));
        sent.keyframe.set_checksum(checksum_of(sent.keyframe, sent.keyframe.body()));
        if (!has_base) {
            sent.delta = sent.keyframe;
        }
        return sent;
    }

  private:
    Baseline baseline_;
    std::uint64_t sequence_ = 100;
};

void compress(evod::v1::SnapshotFrame& frame) {
    Compressor compressor;
    frame.set_body(compressor.compress(frame.body()));
    frame.set_compression(evod::v1::COMPRESSION_ZSTD);
}

/// A keyframe and the delta after it.
Sender::Sent two_snapshots(std::uint64_t seed, SnapshotDecoder& decoder) {
    Random random{seed};
    LivingIsland island;
    island.populate(random);
    Sender sender;
    EXPECT_TRUE(decoder.decode(sender.send(island, 0).keyframe));
    island.live(random, 2);
    return sender.send(island, 2);
}

RC_GTEST_PROP(DeltaCodec, EverySnapshotIsRestoredExactly,
              (std::uint64_t seed, bool wide, bool headings, bool species)) {
    Random random{seed};
    LivingIsland island;
    island.headings = headings;
    island.species = species;
    island.side_px = wide ? 500'000 : 4000;
    island.populate(random);
    Sender sender;
    SnapshotDecoder always, sometimes, compressed;
    for (int n = 0; n < 40; ++n) {
        const auto ticks = static_cast<std::uint16_t>(n == 0 ? 0 : below(random, 5));
        if (ticks > 0) {
            island.live(random, ticks);
        }
        auto sent = sender.send(island, ticks);
        const QuantisedSnapshot snapshot = island.snapshot();
        RC_ASSERT(*decode_plain(sent.plain).value().entities == snapshot);
        const auto same = [&](const Result<ReceivedSnapshot>& decoded, const SnapshotDecoder& decoder) {
            RC_ASSERT(decoded.has_value());
            RC_ASSERT(*decoded->entities == snapshot);
            RC_ASSERT(decoded->entities.get() == decoder.snapshot());
            RC_ASSERT(decoded->about.world() == "w");
            RC_ASSERT(decoded->about.width_px() == island.side_px);
        };
        same(always.decode(sent.delta), always);
        // After a keyframe or a delta, the next delta is the same.
        same(sometimes.decode(n % 7 == 0 ? sent.keyframe : sent.delta), sometimes);
        compress(sent.delta);
        same(compressed.decode(sent.delta), compressed);
    }
}

/// Organisms without radius and health, with these ids and headings.
QuantisedSnapshot heading_to(Column ids, Column headings) {
    QuantisedSnapshot snapshot;
    Entities& organisms = snapshot.organisms;
    organisms.x = organisms.y = organisms.width = organisms.height = Column(ids.size(), 0);
    organisms.id = std::move(ids);
    organisms.heading = std::move(headings);
    return snapshot;
}

TEST(DeltaCodec, HeadingsTakeAByteAndTurnThroughZero) {
    const auto base = std::make_shared<QuantisedSnapshot>(heading_to({1, 2, 5}, {250, 128, 0}));
    const Baseline baseline = initial_baseline(base);
    const QuantisedSnapshot next = heading_to({1, 3, 5}, {5, 77, 255});
    const std::string body = encode_delta(baseline, next, 1);
    const auto decoded = decode_body(body, {.counts = counts_of(next)}, &baseline);
    ASSERT_TRUE(decoded) << decoded.error().what;
    EXPECT_EQ(*decoded->snapshot, next);
    const std::string still = encode_delta(baseline, *base, 1);
    const QuantisedSnapshot turned = heading_to({1, 2, 5}, {122, 1, 129});
    EXPECT_EQ(encode_delta(baseline, turned, 1).size(), still.size() + 3) << "a signed byte for each organism";
}

TEST(DeltaCodec, ABodyWithoutHeadingsDoesNotMentionThem) {
    QuantisedSnapshot headless = heading_to({1, 2}, {});
    const std::string without = encode_keyframe(initial_baseline(std::make_shared<QuantisedSnapshot>(headless)));
    const std::string with =
        encode_keyframe(initial_baseline(std::make_shared<QuantisedSnapshot>(heading_to({1, 2}, {3, 4}))));
    EXPECT_EQ(without[2], 2) << "the parts of the organisms: some have come";
    EXPECT_EQ(with[2], 2 + 4);
    EXPECT_EQ(with.size(), without.size() + 2);
}

/// Organisms without radius and health, with these ids and species.
QuantisedSnapshot of_species(Column ids, Column species) {
    QuantisedSnapshot snapshot = heading_to(std::move(ids), {});
    snapshot.organisms.species = std::move(species);
    return snapshot;
}

TEST(DeltaCodec, ASpeciesIsSentOnlyWhenAnOrganismComes) {
    const auto base = std::make_shared<QuantisedSnapshot>(of_species({1, 2, 5}, {0, 1, 0}));
    const Baseline baseline = initial_baseline(base);
    const std::string keyframe = encode_keyframe(baseline);
    EXPECT_EQ(keyframe[2], 2 + 8) << "the parts of the organisms: some have come, with species";
    EXPECT_EQ(keyframe.size(),
              encode_keyframe(initial_baseline(std::make_shared<QuantisedSnapshot>(of_species({1, 2, 5}, {})))).size() +
                  3);
    const std::string still = encode_delta(baseline, *base, 1);
    EXPECT_EQ(still.size(),
              encode_delta(initial_baseline(std::make_shared<QuantisedSnapshot>(of_species({1, 2, 5}, {}))),
                           of_species({1, 2, 5}, {}), 1)
                  .size());
    for (const QuantisedSnapshot& next : {*base, of_species({1, 3, 5}, {0, 1, 0}), of_species({1, 2, 5}, {1, 1, 0})}) {
        const auto decoded = decode_body(encode_delta(baseline, next, 1), {.counts = counts_of(next)}, &baseline);
        ASSERT_TRUE(decoded) << decoded.error().what;
        EXPECT_EQ(*decoded->snapshot, next);
    }
}

TEST(DeltaCodec, SpeciesMustNotVanishOrAppear) {
    const auto with = std::make_shared<QuantisedSnapshot>(of_species({1, 2}, {0, 1}));
    const auto without = std::make_shared<QuantisedSnapshot>(of_species({1, 2}, {}));
    for (const auto& [base, next] : {std::pair{with, without}, std::pair{without, with}}) {
        EXPECT_FALSE(follows(*next, *base));
        const Baseline right = initial_baseline(next), wrong = initial_baseline(base);
        const auto refused = decode_body(encode_delta(right, *next, 1), {.counts = counts_of(*next)}, &wrong);
        ASSERT_FALSE(refused);
        EXPECT_THAT(refused.error().what, testing::HasSubstr("species, unlike its base"));
    }
}

TEST(DeltaCodec, HeadingsMustNotVanishOrAppear) {
    const auto with = std::make_shared<QuantisedSnapshot>(heading_to({1, 2}, {3, 4}));
    const auto without = std::make_shared<QuantisedSnapshot>(heading_to({1, 2}, {}));
    for (const auto& [base, next] : {std::pair{with, without}, std::pair{without, with}}) {
        EXPECT_FALSE(follows(*next, *base));
        const Baseline right = initial_baseline(next), wrong = initial_baseline(base);
        const auto refused =
            decode_body(encode_delta(right, *next, 1), {.counts = counts_of(*next)}, &wrong); // of another base
        ASSERT_FALSE(refused);
        EXPECT_THAT(refused.error().what, testing::HasSubstr("headings, unlike its base"));
    }
    std::string of_food = encode_keyframe(initial_baseline(std::make_shared<QuantisedSnapshot>()));
    of_food[3] = 4; // the parts of the food
    const auto refused = decode_body(of_food, {}, nullptr);
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().what, testing::HasSubstr("has parts 4, not 0 to 3"));
}

TEST(DeltaCodec, SnapshotsWithoutOrganismsHaveNoHeadings) {
    const auto some = std::make_shared<QuantisedSnapshot>(heading_to({1, 2}, {3, 4}));
    const auto none = std::make_shared<QuantisedSnapshot>(heading_to({}, {}));
    const auto delta = [](const auto& base, const auto& next) {
        EXPECT_TRUE(follows(*next, *base));
        const Baseline baseline = initial_baseline(base);
        std::string body = encode_delta(baseline, *next, 1);
        const auto decoded = decode_body(body, {.counts = counts_of(*next)}, &baseline);
        EXPECT_TRUE(decoded && *decoded->snapshot == *next);
        return body;
    };
    EXPECT_EQ(delta(some, none)[2], 1) << "the parts of the organisms: some are gone";
    EXPECT_EQ(delta(none, some)[2], 2 + 4);
}

RC_GTEST_PROP(DeltaCodec, BothEndsPredictTheSame, (std::uint64_t seed)) {
    Random random{seed};
    const auto any = [&](std::uint64_t bits) {
        const auto number = static_cast<std::uint32_t>(random());
        return static_cast<std::uint32_t>(static_cast<std::int32_t>(number) >> (32 - bits));
    };
    constexpr std::size_t count = 300;
    for (const std::uint32_t bits : {12U, 16U, 17U, 21U, 22U, 32U}) { // of displacements, with their sign
        const auto ticks = static_cast<std::uint16_t>(any(1 + below(random, 17)));
        Baseline base;
        base.ticks = static_cast<std::uint16_t>(any(1 + below(random, 17)));
        auto there = std::make_shared<QuantisedSnapshot>(), here = std::make_shared<QuantisedSnapshot>();
        for (QuantisedSnapshot* snapshot : {there.get(), here.get()}) {
            snapshot->position_bytes = 4;
            snapshot->organisms.id.resize(count);
            std::iota(snapshot->organisms.id.begin(), snapshot->organisms.id.end(), 0U);
            for (Column* column : {&snapshot->organisms.x, &snapshot->organisms.y}) {
                for (std::size_t i = 0; i < count; ++i) {
                    column->push_back(any(32));
                }
            }
            snapshot->organisms.width.assign(count, 5);
            snapshot->organisms.height.assign(count, 6);
        }
        base.snapshot = there;
        for (Column* column : {&base.organisms.x, &base.organisms.y}) {
            for (std::size_t i = 0; i < count; ++i) {
                column->push_back(any(bits));
            }
        }
        const std::string body = encode_delta(base, *here, ticks);
        const auto decoded = decode_body(body, {.counts = counts_of(*here), .position_bytes = 4}, &base);
        RC_ASSERT(decoded.has_value());
        RC_ASSERT(*decoded->snapshot == *here);
    }
}

TEST(DeltaCodec, MostlyNewItemsTakeNoMoreThanAKeyframe) {
    constexpr std::uint32_t id_end = 6000;
    constexpr std::uint64_t all = 100;
    Random random{7};
    for (const std::uint64_t stays_percent : {0, 5, 20, 40, 90, 100}) {
        auto there = std::make_shared<QuantisedSnapshot>(), here = std::make_shared<QuantisedSnapshot>();
        const auto lie = [&](QuantisedSnapshot& snapshot, std::uint32_t id, std::uint64_t place) {
            snapshot.food.id.push_back(id);
            snapshot.food.x.push_back(place & 0xffff);
            snapshot.food.y.push_back(place >> 16 & 0xffff);
        };
        for (std::uint32_t id = 0; id < id_end; ++id) {
            const bool stays = below(random, all) < stays_percent;
            const std::uint64_t place = random();
            if (stays || below(random, all) < 80) {
                lie(*there, id, place);
            }
            if (stays || below(random, all) < 80) {
                lie(*here, id, stays ? place : random());
            }
        }
        const Baseline base = initial_baseline(there);
        const std::string delta = encode_delta(base, *here, 300), keyframe = encode_keyframe(initial_baseline(here));
        const auto decoded = decode_body(delta, {.counts = counts_of(*here)}, &base);
        ASSERT_TRUE(decoded.has_value()) << stays_percent;
        EXPECT_TRUE(*decoded->snapshot == *here) << stays_percent;
        EXPECT_LT(delta.size(), keyframe.size() + 100) << stays_percent;
        if (stays_percent >= 40) {
            EXPECT_LT(delta.size(), keyframe.size() * 9 / 10) << stays_percent;
        }
    }
}

TEST(DeltaCodec, ADeltaIsTheseBytes) {
    LivingIsland island;
    island.organisms = {{.id = 3, .x = 100 * px, .y = 50 * px, .dx = 0, .dy = 0, .radius = 10.F, .health = 100.F}};
    island.food = {{.id = 0, .x = px, .y = px}, {.id = 7, .x = 2 * px, .y = 3 * px}};
    Sender sender;
    sender.send(island, 0);
    island.organisms[0].x += px; // 16 steps
    sender.send(island, 2);
    island.organisms[0].x += 2 * px; // 16 more than predicted
    island.organisms[0].health -= 0.5F;
    island.food.erase(island.food.begin());
    const auto delta = sender.send(island, 2).delta;
    EXPECT_EQ(delta.body(), std::string("\x02\x00"
                                        "\x00\x01\x10\x00\x01\xf8" // organisms: x +16, y as predicted, health -8
                                        "\x01\x01\x00\x00\x00\x00" // food: one is gone, the first
                                        "\x00\x00\x00",            // the other kinds: unchanged
                                        17));
}

TEST(DeltaCodec, AFewLargeNumbersAreExceptions) {
    LivingIsland island;
    for (std::uint32_t id = 0; id < 1000; ++id) {
        island.organisms.push_back({.id = id, .x = 0, .y = 0, .dx = 0, .dy = 0, .radius = 10.F, .health = 100.F});
    }
    Sender sender;
    sender.send(island, 0);
    island.organisms[500].x = 4000 * px;
    const auto sent = sender.send(island, 2);
    EXPECT_EQ(sent.delta.body().size(), 2U + 1 + (1 + 4 + 8) + 1 + 1 + 4);
}

TEST(DeltaDamage, EveryOtherByteIsRefused) {
    SnapshotDecoder first;
    const auto sent = two_snapshots(5, first);
    ASSERT_TRUE(SnapshotDecoder{first}.decode(sent.delta));
    for (const auto* whole : {&sent.delta, &sent.keyframe}) {
        ASSERT_GT(whole->body().size(), 100U);
        for (std::size_t i = 0; i < whole->body().size(); ++i) {
            for (const int change : {1, 0x80, 0xff}) {
                auto damaged = *whole;
                (*damaged.mutable_body())[i] = static_cast<char>(damaged.body()[i] ^ change);
                SnapshotDecoder decoder{first};
                const auto decoded = decoder.decode(damaged);
                ASSERT_FALSE(decoded) << i;
                EXPECT_THAT(decoded.error().what, testing::HasSubstr("checksum"));
                EXPECT_TRUE(decoder.needs_keyframe());
            }
        }
    }
}

TEST(DeltaDamage, CutBodiesWithRightChecksumsAreRefused) {
    SnapshotDecoder first;
    const auto sent = two_snapshots(6, first);
    for (const auto* whole : {&sent.delta, &sent.keyframe}) {
        for (std::size_t length = 0; length <= whole->body().size() + 1; ++length) {
            auto cut = *whole;
            cut.mutable_body()->resize(length);
            cut.set_checksum(checksum_of(cut, cut.body()));
            EXPECT_EQ(SnapshotDecoder{first}.decode(cut).has_value(), length == whole->body().size()) << length;
        }
        Random random{7};
        for (int round = 0; round < 20'000; ++round) { // each is refused or gives some snapshot
            auto changed = *whole;
            (*changed.mutable_body())[below(random, changed.body().size())] = static_cast<char>(random());
            changed.set_checksum(checksum_of(changed, changed.body()));
            SnapshotDecoder decoder{first};
            if (const auto decoded = decoder.decode(changed)) {
                ASSERT_EQ(decoded->entities->organisms.x.size(), changed.organism_count());
                ASSERT_TRUE(std::ranges::is_sorted(decoded->entities->food.id));
            }
        }
    }
}

TEST(DeltaDamage, AnotherBaseIsRefused) {
    SnapshotDecoder first;
    const auto sent = two_snapshots(8, first);
    auto other = sent.delta;
    other.set_base_sequence(99);
    EXPECT_THAT(SnapshotDecoder{first}.decode(other).error().what, testing::HasSubstr("base_sequence is 99"));
    EXPECT_THAT(SnapshotDecoder{}.decode(sent.delta).error().what, testing::HasSubstr("keyframe"));
    SnapshotDecoder elsewhere = first;
    EXPECT_FALSE(elsewhere.decode(other));
    EXPECT_FALSE(elsewhere.decode(sent.delta)) << "after damage only a keyframe helps";
    EXPECT_TRUE(elsewhere.decode(sent.keyframe));
    // Correcting the number does not help, because the checksum covers it.
    other = sent.delta;
    other.set_sequence(other.sequence() + 1);
    EXPECT_THAT(SnapshotDecoder{first}.decode(other).error().what, testing::HasSubstr("checksum"));
}

TEST(DeltaDamage, FalseCountsTakeNoMemory) {
    SnapshotDecoder first;
    const auto sent = two_snapshots(9, first);
    for (const auto set : {&evod::v1::SnapshotFrame::set_organism_count, &evod::v1::SnapshotFrame::set_food_count,
                           &evod::v1::SnapshotFrame::set_crate_count}) {
        for (const auto* whole : {&sent.delta, &sent.keyframe}) {
            auto frame = *whole;
            (frame.*set)(std::numeric_limits<std::uint32_t>::max());
            frame.set_checksum(checksum_of(frame, frame.body()));
            EXPECT_FALSE(SnapshotDecoder{first}.decode(frame));
        }
    }
    // A keyframe without entities but with a count of those that come.
    evod::v1::SnapshotFrame frame = LivingIsland{}.about();
    frame.set_codec(evod::v1::CODEC_DELTA);
    frame.set_organism_count(0xffffffff);
    frame.set_body(std::string("\0\0\2\xff\xff\xff\xff\0\0\0\0", 11));
    frame.set_checksum(checksum_of(frame, frame.body()));
    EXPECT_THAT(SnapshotDecoder{}.decode(frame).error().what, testing::HasSubstr("adds more entities"));
}

TEST(DeltaDamage, CountsLimitTheSizeOfACompressedBody) {
    evod::v1::SnapshotFrame frame = LivingIsland{}.about();
    frame.set_codec(evod::v1::CODEC_DELTA);
    frame.set_body(std::string(100'000, '\0'));
    compress(frame);
    ASSERT_LT(frame.body().size(), 100U);
    EXPECT_THAT(SnapshotDecoder{}.decode(frame).error().what, testing::HasSubstr("has 100000 bytes of content"));
    frame.set_body("no zstd");
    EXPECT_THAT(SnapshotDecoder{}.decode(frame).error().what, testing::HasSubstr("not a zstd frame"));
    SnapshotDecoder first;
    auto sent = two_snapshots(10, first);
    compress(sent.keyframe);
    for (std::size_t length = 0; length < sent.keyframe.body().size(); ++length) {
        auto cut = sent.keyframe;
        cut.mutable_body()->resize(length);
        EXPECT_FALSE(SnapshotDecoder{}.decode(cut)) << length;
    }
    sent.keyframe.set_compression(static_cast<evod::v1::Compression>(9));
    EXPECT_THAT(SnapshotDecoder{}.decode(sent.keyframe).error().what, testing::HasSubstr("compression is 9"));
}

TEST(DeltaDamage, TheOtherFieldsAreCheckedToo) {
    SnapshotDecoder first;
    auto keyframe = two_snapshots(11, first).keyframe;
    keyframe.set_width_px(std::nan(""));
    EXPECT_THAT(SnapshotDecoder{}.decode(keyframe).error().what, testing::HasSubstr("width_px"));
}

TEST(Crc32, EqualsThatOfZlib) {
    EXPECT_EQ(crc32("123456789"), 0xcbf43926U);
    EXPECT_EQ(crc32("56789", crc32("1234")), 0xcbf43926U);
    EXPECT_EQ(crc32(std::string(1'000'000, 'a')), 0xdc25bfbcU); // Python's zlib.crc32(b"a" * 1000000)
}
TEST(Crc32, IsTheSameForBytesInPieces) {
    std::string bytes(3000, '\0');
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        bytes[i] = static_cast<char>(i * i >> 3);
    }
    const std::string_view all = bytes;
    for (std::size_t cut = 0; cut <= all.size(); ++cut) {
        EXPECT_EQ(crc32(all.substr(cut), crc32(all.substr(0, cut))), crc32(all)) << cut;
    }
}

} // namespace
} // namespace evod::codec
