#include "proto/codec/snapshot_codec.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

namespace evod::codec {
namespace {

using Ids = std::vector<std::uint32_t>;
using Floats = std::vector<float>;

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
    encode(snapshot, frame);
    return frame;
}

TEST(SnapshotCodec, ABodyIsTheseBytes) {
    const auto frame =
        frame_of({.organisms = {.id = {0x01020304}, .x = {256}, .y = {16}, .width = {160}, .height = {8}}});
    EXPECT_EQ(frame.body(), std::string("\x04\x03\x02\x01"
                                        "\x00\x01"
                                        "\x10\x00"
                                        "\xa0\x00"
                                        "\x08\x00",
                                        12));
    EXPECT_EQ(frame.position_bytes(), 2U);
}

TEST(SnapshotCodec, APictureComesBack) {
    auto frame = frame_of(small_snapshot());
    frame.set_tick(77);
    const auto picture = decode(frame);
    ASSERT_TRUE(picture) << picture.error().what;
    EXPECT_EQ(picture->about.tick(), 77U);
    EXPECT_TRUE(picture->about.body().empty());
    EXPECT_EQ(picture->organisms.id, (Ids{3, 9}));
    EXPECT_EQ(picture->organisms.x_px, (Floats{100.F, 1280.F}));
    EXPECT_EQ(picture->organisms.y_px, (Floats{0.0625F, 720.F}));
    EXPECT_EQ(picture->organisms.radius_px, (Floats{10.F, 8.0625F}));
    EXPECT_EQ(picture->organisms.health, (Floats{100.5F, 4095.9375F}));
    EXPECT_EQ(picture->food.id, (Ids{0, 4}));
    EXPECT_EQ(picture->food.y_px, (Floats{3.F, 4.F}));
    EXPECT_EQ(picture->poison.id, (Ids{70000}));
    EXPECT_EQ(picture->crates.half_height_px, (Floats{10.F}));
    EXPECT_EQ(picture->obstacles.x_px, (Floats{11.F}));
    EXPECT_EQ(picture->obstacles.half_width_px, (Floats{13.F}));
}

TEST(SnapshotCodec, AnEmptyIslandIsAnEmptyBody) {
    const auto frame = frame_of({});
    EXPECT_TRUE(frame.body().empty());
    EXPECT_TRUE(decode(frame));
}

TEST(SnapshotCodec, PositionsMayTakeFourBytes) {
    QuantisedSnapshot snapshot = small_snapshot();
    snapshot.position_bytes = 4;
    snapshot.organisms.x[1] = 16 * 285'999 + 8;
    const auto frame = frame_of(snapshot);
    EXPECT_EQ(frame.position_bytes(), 4U);
    EXPECT_EQ(decode(frame)->organisms.x_px, (Floats{100.F, 285'999.5F}));
    EXPECT_EQ(decode(frame)->obstacles.half_height_px, (Floats{14.F}));
}

TEST(SnapshotCodec, ColumnsOfDifferentLengthsAreTheCallersError) {
    for (const auto column : {&Entities::id, &Entities::x, &Entities::y}) {
        QuantisedSnapshot snapshot = small_snapshot();
        (snapshot.food.*column).pop_back();
        evod::v1::SnapshotFrame frame;
        EXPECT_THROW(encode(snapshot, frame), std::invalid_argument);
    }
    QuantisedSnapshot snapshot = small_snapshot();
    snapshot.poison.y.clear();
    evod::v1::SnapshotFrame frame;
    EXPECT_THROW(encode(snapshot, frame), std::invalid_argument);
}

TEST(SnapshotDamage, EveryOtherLengthOfBodyIsRefused) {
    const auto whole = frame_of(small_snapshot());
    for (std::size_t length = 0; length < whole.body().size(); ++length) {
        auto cut = whole;
        cut.mutable_body()->resize(length);
        EXPECT_FALSE(decode(cut)) << length;
    }
    auto longer = whole;
    longer.mutable_body()->push_back('x');
    EXPECT_FALSE(decode(longer));
}

TEST(SnapshotDamage, IsNamed) {
    const auto whole = frame_of(small_snapshot());
    const auto complaint = [&](const auto& change) {
        auto frame = whole;
        change(frame);
        const auto picture = decode(frame);
        return picture ? std::string{} : picture.error().what;
    };
    const double nan = std::nan(""), infinity = std::numeric_limits<double>::infinity();
    EXPECT_EQ(complaint([](auto&) {}), "");
    EXPECT_EQ(complaint([](auto& f) { f.set_position_bytes(3); }), "a snapshot's position_bytes is 3, not 2 or 4");
    EXPECT_EQ(complaint([](auto& f) { f.set_island(1); }), "a snapshot's island is 1, not one of 1");
    EXPECT_EQ(complaint([](auto& f) { f.set_food_count(3); }),
              "a snapshot's body is 64 bytes long, not 72 as its counts say");
    EXPECT_EQ(complaint([](auto& f) {
                  for (const auto set :
                       {&evod::v1::SnapshotFrame::set_organism_count, &evod::v1::SnapshotFrame::set_food_count}) {
                      (f.*set)(std::numeric_limits<std::uint32_t>::max());
                  }
              }),
              "a snapshot's body is 64 bytes long, not 85899345924 as its counts say");
    EXPECT_THAT(complaint([](auto& f) { f.set_codec(evod::v1::CODEC_UNSPECIFIED); }), testing::HasSubstr("codec"));
    EXPECT_THAT(complaint([&](auto& f) { f.set_width_px(nan); }), testing::HasSubstr("width_px"));
    EXPECT_THAT(complaint([&](auto& f) { f.set_height_px(infinity); }), testing::HasSubstr("height_px"));
    EXPECT_THAT(complaint([&](auto& f) { f.set_height_px(0); }), testing::HasSubstr("height_px"));
    EXPECT_THAT(complaint([&](auto& f) { f.set_item_radius_px(-1); }), testing::HasSubstr("item_radius_px"));
    EXPECT_THAT(complaint([&](auto& f) { f.set_ticks_per_s(nan); }), testing::HasSubstr("ticks_per_s"));
    EXPECT_THAT(complaint([&](auto& f) { f.mutable_live()->set_health_mean(nan); }), testing::HasSubstr("health_mean"));
    EXPECT_THAT(complaint([](auto& f) { (*f.mutable_body())[0] = '\x09'; }), testing::HasSubstr("rising"));
}

} // namespace
} // namespace evod::codec
