#include "proto/wire/snapshot_codec.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numeric>

namespace evod::wire {
namespace {

using Ids = std::vector<std::uint32_t>;
using Fixed = std::vector<std::int32_t>;
using Floats = std::vector<float>;

constexpr std::int32_t px = 4096; // fixed-point units

/// The arrays that IslandColumns looks at.
struct Island {
    double width_px = 1280, height_px = 720;
    struct {
        Ids id;
        Fixed x, y;
        Floats radius, health;
    } organisms;
    struct Items {
        Ids id;
        Fixed x, y;
    } food, poison;
    struct Boxes {
        Fixed x, y;
        Floats half_width, half_height;
    } crates, obstacles;

    IslandColumns columns() const {
        const auto items = [](const Items& i) { return ItemColumns{.id = i.id, .x = i.x, .y = i.y}; };
        const auto boxes = [](const Boxes& b) {
            return BoxColumns{.x = b.x, .y = b.y, .half_width_px = b.half_width, .half_height_px = b.half_height};
        };
        return {.width_px = width_px,
                .height_px = height_px,
                .position_fraction_bits = 12,
                .organisms = {.id = organisms.id,
                              .x = organisms.x,
                              .y = organisms.y,
                              .radius_px = organisms.radius,
                              .health = organisms.health},
                .food = items(food),
                .poison = items(poison),
                .crates = boxes(crates),
                .obstacles = boxes(obstacles)};
    }
};

Island small_island() {
    Island island;
    island.organisms = {.id = {3, 9},
                        .x = {100 * px, 1280 * px},
                        .y = {px / 16, 720 * px},
                        .radius = {10.F, 8.0625F},
                        .health = {100.5F, 5000.F}};
    island.food = {.id = {0, 4}, .x = {px, 2 * px}, .y = {3 * px, 4 * px}};
    island.poison = {.id = {70000}, .x = {5 * px}, .y = {6 * px}};
    island.crates = {.x = {7 * px}, .y = {8 * px}, .half_width = {9.F}, .half_height = {10.F}};
    island.obstacles = {.x = {11 * px}, .y = {12 * px}, .half_width = {13.F}, .half_height = {14.F}};
    return island;
}

evod::v1::SnapshotFrame frame_of(const Island& island) {
    evod::v1::SnapshotFrame frame;
    frame.set_island_count(1);
    encode(island.columns(), frame);
    return frame;
}

TEST(SnapshotCodec, ABodyIsTheseBytes) {
    Island island;
    island.organisms = {.id = {0x01020304}, .x = {16 * px}, .y = {px}, .radius = {10.F}, .health = {0.5F}};
    const auto frame = frame_of(island);
    EXPECT_EQ(frame.body(), std::string("\x04\x03\x02\x01"
                                        "\x00\x01"
                                        "\x10\x00"
                                        "\xa0\x00"
                                        "\x08\x00",
                                        12));
    EXPECT_EQ(frame.position_bytes(), 2U);
}

TEST(SnapshotCodec, APictureComesBack) {
    auto frame = frame_of(small_island());
    frame.set_tick(77);
    const auto picture = decode(frame);
    ASSERT_TRUE(picture) << picture.error().what;
    EXPECT_EQ(picture->about.tick(), 77U);
    EXPECT_TRUE(picture->about.body().empty());
    EXPECT_EQ(picture->organisms.id, (Ids{3, 9}));
    EXPECT_EQ(picture->organisms.x_px, (Floats{100.F, 1280.F}));
    EXPECT_EQ(picture->organisms.y_px, (Floats{0.0625F, 720.F}));
    EXPECT_EQ(picture->organisms.radius_px, (Floats{10.F, 8.0625F}));
    EXPECT_EQ(picture->organisms.health, (Floats{100.5F, 4095.9375F})) << "health stops at its column's end";
    EXPECT_EQ(picture->food.id, (Ids{0, 4}));
    EXPECT_EQ(picture->food.y_px, (Floats{3.F, 4.F}));
    EXPECT_EQ(picture->poison.id, (Ids{70000}));
    EXPECT_EQ(picture->crates.half_height_px, (Floats{10.F}));
    EXPECT_EQ(picture->obstacles.x_px, (Floats{11.F}));
    EXPECT_EQ(picture->obstacles.half_width_px, (Floats{13.F}));
}

TEST(SnapshotCodec, AnEmptyIslandIsAnEmptyBody) {
    const auto frame = frame_of(Island{});
    EXPECT_TRUE(frame.body().empty());
    EXPECT_TRUE(decode(frame));
}

TEST(SnapshotCodec, PositionsTakeFourBytesWhereTwoCannotCountTheIsland) {
    Island island = small_island();
    island.width_px = 4095.9375;
    EXPECT_EQ(frame_of(island).position_bytes(), 2U);
    island.width_px = 286'000;
    island.organisms.x[1] = 285'999 * px + px / 2;
    const auto frame = frame_of(island);
    EXPECT_EQ(frame.position_bytes(), 4U);
    EXPECT_EQ(decode(frame)->organisms.x_px[1], 285'999.5F);
}

TEST(SnapshotCodec, WhatIsBeyondAColumnStandsAtItsEnd) {
    Island island = small_island();
    const auto least = std::numeric_limits<std::int32_t>::min(), most = std::numeric_limits<std::int32_t>::max();
    island.organisms.x = {least, most};
    island.organisms.radius = {-1.F, std::numeric_limits<float>::infinity()};
    island.organisms.health = {std::nanf(""), -0.F};
    auto picture = decode(frame_of(island)).value();
    EXPECT_EQ(picture.organisms.x_px, (Floats{0.F, 4095.9375F}));
    EXPECT_EQ(picture.organisms.radius_px, (Floats{0.F, 4095.9375F}));
    EXPECT_EQ(picture.organisms.health, (Floats{0.F, 0.F}));
    island.width_px = 500'000;
    picture = decode(frame_of(island)).value();
    EXPECT_EQ(picture.organisms.x_px, (Floats{0.F, 524'287.9375F}));
}

RC_GTEST_PROP(SnapshotCodec, PositionsMoveByAtMostHalfAStep, (bool wide)) {
    Island island;
    island.width_px = wide ? 100'000 : 4000;
    const auto positions =
        *rc::gen::container<Fixed>(rc::gen::inRange<std::int32_t>(0, static_cast<std::int32_t>(island.width_px) * px));
    auto& organisms = island.organisms;
    organisms.x = organisms.y = positions;
    organisms.id.resize(positions.size());
    std::iota(organisms.id.begin(), organisms.id.end(), 5U);
    organisms.radius.assign(positions.size(), 1.F);
    organisms.health.assign(positions.size(), 1.F);
    const auto picture = decode(frame_of(island)).value();
    RC_ASSERT(picture.organisms.id == organisms.id);
    RC_ASSERT(picture.organisms.x_px == picture.organisms.y_px);
    for (std::size_t i = 0; i < positions.size(); ++i) {
        RC_ASSERT(std::abs(double{picture.organisms.x_px[i]} - positions[i] / double{px}) <= 1.0 / 32);
    }
}

TEST(SnapshotCodec, ColumnsOfDifferentLengthsAreTheCallersError) {
    Island island = small_island();
    island.food.y.pop_back();
    evod::v1::SnapshotFrame frame;
    EXPECT_THROW(encode(island.columns(), frame), std::invalid_argument);
}

TEST(SnapshotDamage, EveryOtherLengthOfBodyIsRefused) {
    const auto whole = frame_of(small_island());
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
    const auto whole = frame_of(small_island());
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

TEST(SnapshotCodec, TenThousandOrganismsAreEncodedInAFractionOfAMillisecond) {
    Island island;
    const auto fill = [](auto& items, std::uint32_t count) {
        items.id.resize(count);
        std::iota(items.id.begin(), items.id.end(), 0U);
        items.x.assign(count, 100 * px);
        items.y.assign(count, 200 * px);
    };
    fill(island.organisms, 10'000);
    island.organisms.radius.assign(10'000, 10.F);
    island.organisms.health.assign(10'000, 100.F);
    fill(island.food, 25'000);
    fill(island.poison, 15'000);
    evod::v1::SnapshotFrame frame;
    std::chrono::duration<double, std::milli> best{1e9};
    for (int round = 0; round < 50; ++round) {
        const auto start = std::chrono::steady_clock::now();
        encode(island.columns(), frame);
        best = std::min<decltype(best)>(best, std::chrono::steady_clock::now() - start);
    }
    RecordProperty("encode_ms", std::to_string(best.count()));
    EXPECT_LT(best.count(), 20) << "a debug or sanitized build may be far slower than the 0.1 ms of a release build";
}

} // namespace
} // namespace evod::wire
