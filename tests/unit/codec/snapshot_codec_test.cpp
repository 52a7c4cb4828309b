#include "proto/codec/snapshot_codec.h"

#include "proto/codec/snapshot_decoder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

namespace evod::codec {
namespace {

using testing::HasSubstr;

QuantisedSnapshot small_snapshot() {
    return {
        .organisms = {.id = {3, 9}, .x = {1600, 20480}, .y = {1, 11520}, .width = {160, 129}, .height = {1608, 65535}},
        .food = {.id = {0, 4}, .x = {16, 32}, .y = {48, 64}, .width = {}, .height = {}},
        .poison = {.id = {70000}, .x = {80}, .y = {96}, .width = {}, .height = {}},
        .crates = {.id = {}, .x = {112}, .y = {128}, .width = {144}, .height = {160}},
        .obstacles = {.id = {}, .x = {176}, .y = {192}, .width = {208}, .height = {224}}};
}

evod::v1::SnapshotFrame frame_of(const QuantisedSnapshot& snapshot) {
    evod::v1::SnapshotFrame frame;
    frame.set_island_count(1);
    frame.set_width_px(1280);
    frame.set_height_px(720);
    encode_plain(snapshot, frame);
    return frame;
}

TEST(PlainCodec, TheColumnsAreNumbersInPx) {
    const auto frame = frame_of({.organisms = {.id = {77}, .x = {256}, .y = {24}, .width = {160}, .height = {1601}}});
    EXPECT_EQ(frame.codec(), evod::v1::CODEC_PLAIN);
    const evod::v1::PlainOrganisms& organisms = frame.plain().organisms();
    EXPECT_THAT(organisms.id(), testing::ElementsAre(77));
    EXPECT_THAT(organisms.x_px(), testing::ElementsAre(16.F));
    EXPECT_THAT(organisms.y_px(), testing::ElementsAre(1.5F));
    EXPECT_THAT(organisms.radius_px(), testing::ElementsAre(10.F));
    EXPECT_THAT(organisms.health(), testing::ElementsAre(100.0625F));
    EXPECT_TRUE(frame.body().empty());
    EXPECT_EQ(frame.organism_count(), 1U);
}

TEST(PlainCodec, DecodingRestoresTheSnapshot) {
    auto frame = frame_of(small_snapshot());
    frame.set_tick(77);
    const auto snapshot = decode_plain(frame);
    ASSERT_TRUE(snapshot) << snapshot.error().what;
    EXPECT_EQ(snapshot->about.tick(), 77U);
    EXPECT_FALSE(snapshot->about.has_plain());
    EXPECT_EQ(*snapshot->entities, small_snapshot());
}

TEST(PlainCodec, SpeciesAreNumbers) {
    QuantisedSnapshot snapshot;
    snapshot.organisms = {.id = {1, 4}, .x = {0, 0}, .y = {0, 0}, .width = {16, 16}, .height = {0, 0}};
    EXPECT_TRUE(frame_of(snapshot).plain().organisms().species().empty());
    snapshot.organisms.species = {0, 1};
    evod::v1::SnapshotFrame frame = frame_of(snapshot);
    EXPECT_THAT(frame.plain().organisms().species(), testing::ElementsAre(0, 1));
    EXPECT_EQ(*decode_plain(frame).value().entities, snapshot);
    frame.mutable_plain()->mutable_organisms()->set_species(1, 256);
    EXPECT_THAT(decode_plain(frame).error().what, HasSubstr("plain.organisms.species is 256, not 0 to 255"));
    frame.mutable_plain()->mutable_organisms()->add_species(0);
    EXPECT_THAT(decode_plain(frame).error().what, HasSubstr("species is 3 numbers long, not 2 as the count says"));
}

TEST(PlainCodec, HeadingsAreRadians) {
    QuantisedSnapshot snapshot = small_snapshot();
    EXPECT_TRUE(frame_of(snapshot).plain().organisms().heading().empty());
    snapshot.organisms.heading = {64, 128};
    auto frame = frame_of(snapshot);
    const auto& headings = frame.plain().organisms().heading();
    ASSERT_EQ(headings.size(), 2);
    EXPECT_FLOAT_EQ(headings.Get(0), 1.5707964F);
    EXPECT_FLOAT_EQ(headings.Get(1), -3.1415927F);
    EXPECT_EQ(*decode_plain(frame).value().entities, snapshot);
    frame.mutable_plain()->mutable_organisms()->set_heading(1, 3.2F);
    EXPECT_THAT(decode_plain(frame).error().what, HasSubstr("plain.organisms.heading is 3.2"));
    frame.mutable_plain()->mutable_organisms()->set_heading(1, std::nanf(""));
    EXPECT_THAT(decode_plain(frame).error().what, HasSubstr("not -pi to pi"));
    frame.mutable_plain()->mutable_organisms()->add_heading(0);
    EXPECT_THAT(decode_plain(frame).error().what, HasSubstr("heading is 3 numbers long, not 2 as the count says"));
}

TEST(PlainCodec, TheAccessorsConvertToPx) {
    const QuantisedSnapshot snapshot = small_snapshot();
    EXPECT_EQ(snapshot.organisms.x_px(1), 1280.F);
    EXPECT_EQ(snapshot.organisms.y_px(0), 0.0625F);
    EXPECT_EQ(snapshot.organisms.radius_px(1), 8.0625F);
    EXPECT_EQ(snapshot.organisms.health(1), 4095.9375F);
    EXPECT_EQ(snapshot.organisms.index_of(9), 1U);
    EXPECT_EQ(snapshot.organisms.index_of(4), std::nullopt);
    EXPECT_EQ(snapshot.organisms.index_of(10), std::nullopt);
    EXPECT_EQ(snapshot.crates.half_height_px(0), 10.F);
    EXPECT_EQ(snapshot.crates.id_of(0), 0U);
    EXPECT_EQ(snapshot.poison.id_of(0), 70000U);
    EXPECT_EQ(snapshot.obstacles.half_width_px(0), 13.F);
}

TEST(PlainCodec, AnEmptyIslandIsDecoded) {
    const auto snapshot = decode_plain(frame_of({}));
    ASSERT_TRUE(snapshot);
    EXPECT_TRUE(snapshot->entities->organisms.id.empty());
}

TEST(PlainCodec, WideIslandsKeepTheirPrecision) {
    QuantisedSnapshot snapshot = small_snapshot();
    snapshot.position_bytes = 4;
    snapshot.organisms.x[1] = 16 * 499'999 + 9;
    const auto decoded = decode_plain(frame_of(snapshot)).value();
    EXPECT_EQ(decoded.entities->organisms, snapshot.organisms);
    EXPECT_EQ(decoded.entities->organisms.x_px(1), 499'999.5625F);
}

TEST(PlainCodec, TheDecoderNeedsNoKeyframeBeforeIt) {
    SnapshotDecoder decoder;
    for (int i = 0; i < 2; ++i) {
        EXPECT_TRUE(decoder.decode(frame_of(small_snapshot())));
    }
}

TEST(PlainCodec, ColumnsOfDifferentLengthsThrow) {
    for (const auto column : {&Entities::id, &Entities::x, &Entities::y}) {
        QuantisedSnapshot snapshot = small_snapshot();
        (snapshot.food.*column).pop_back();
        evod::v1::SnapshotFrame frame;
        EXPECT_THROW(encode_plain(snapshot, frame), std::invalid_argument);
    }
    QuantisedSnapshot snapshot = small_snapshot();
    snapshot.poison.y.clear();
    evod::v1::SnapshotFrame frame;
    EXPECT_THROW(encode_plain(snapshot, frame), std::invalid_argument);
}

TEST(PlainCodec, DamageNamesTheField) {
    const auto whole = frame_of(small_snapshot());
    const auto complaint = [&](const auto& change) {
        auto frame = whole;
        change(frame, *frame.mutable_plain());
        const auto snapshot = decode_plain(frame);
        return snapshot ? std::string{} : snapshot.error().what;
    };
    const double nan = std::nan(""), infinity = std::numeric_limits<double>::infinity();
    EXPECT_EQ(complaint([](auto&, auto&) {}), "");
    EXPECT_EQ(complaint([](auto& f, auto&) { f.set_island(1); }), "a snapshot's island is 1, not one of 1");
    EXPECT_EQ(complaint([](auto& f, auto&) { f.set_food_count(3); }),
              "a snapshot's plain.food.id is 2 numbers long, not 3 as the count says");
    EXPECT_EQ(complaint([](auto& f, auto&) { f.set_organism_count(std::numeric_limits<std::uint32_t>::max()); }),
              "a snapshot's plain.organisms.id is 2 numbers long, not 4294967295 as the count says");
    EXPECT_EQ(complaint([](auto&, auto& p) { p.mutable_organisms()->add_health(1); }),
              "a snapshot's plain.organisms.health is 3 numbers long, not 2 as the count says");
    EXPECT_EQ(complaint([](auto&, auto& p) { p.clear_obstacles(); }),
              "a snapshot's plain.obstacles.x_px is 0 numbers long, not 1 as the count says");
    EXPECT_EQ(complaint([](auto&, auto& p) { p.mutable_organisms()->set_id(0, 9); }),
              "a snapshot's plain.organisms.id is out of order, not rising");
    EXPECT_EQ(complaint([&](auto&, auto& p) { p.mutable_poison()->set_y_px(0, static_cast<float>(infinity)); }),
              "a snapshot's plain.poison.y_px is inf, not a finite number");
    EXPECT_THAT(complaint([](auto& f, auto&) { f.set_codec(evod::v1::CODEC_UNSPECIFIED); }), HasSubstr("codec"));
    EXPECT_THAT(complaint([&](auto& f, auto&) { f.set_width_px(nan); }), HasSubstr("width_px"));
    EXPECT_THAT(complaint([&](auto& f, auto&) { f.set_height_px(infinity); }), HasSubstr("height_px"));
    EXPECT_THAT(complaint([&](auto& f, auto&) { f.set_height_px(0); }), HasSubstr("height_px"));
    EXPECT_THAT(complaint([&](auto& f, auto&) { f.set_item_radius_px(-1); }), HasSubstr("item_radius_px"));
    EXPECT_THAT(complaint([&](auto& f, auto&) { f.set_ticks_per_s(nan); }), HasSubstr("ticks_per_s"));
    EXPECT_THAT(complaint([&](auto& f, auto&) { f.mutable_live()->set_health_mean(nan); }), HasSubstr("health_mean"));
}

} // namespace
} // namespace evod::codec
