#include "client/core/snapshot_interpolator.h"

#include "tests/unit/codec/px_column.h"

#include <gtest/gtest.h>

#include <utility>

namespace evod::core {
namespace {

using namespace std::chrono_literals;

struct Stand {
    std::uint32_t id;
    float x, y;
};

std::shared_ptr<codec::ReceivedSnapshot> snapshot(std::uint64_t tick, std::initializer_list<Stand> organisms) {
    auto snapshot = std::make_shared<codec::ReceivedSnapshot>();
    snapshot->about.set_tick(tick);
    snapshot->about.set_generation(1);
    snapshot->about.set_simulated_s(static_cast<double>(tick) / 60);
    codec::Entities entities;
    for (const Stand& stand : organisms) {
        entities.id.push_back(stand.id);
        entities.x.push_back(codec::steps_of(stand.x));
        entities.y.push_back(codec::steps_of(stand.y));
    }
    snapshot->entities = codec::snapshot_with(std::move(entities));
    return snapshot;
}

std::shared_ptr<codec::ReceivedSnapshot> snapshot_of_crates(std::uint64_t tick, codec::Entities crates) {
    auto snapshot = core::snapshot(tick, {});
    codec::QuantisedSnapshot entities;
    entities.crates = std::move(crates);
    snapshot->entities = std::make_shared<const codec::QuantisedSnapshot>(std::move(entities));
    return snapshot;
}

std::vector<float> x_px(const Positions& positions) {
    std::vector<float> column;
    for (std::size_t i = 0; i < positions.size(); ++i) {
        column.push_back(positions[i].x_px);
    }
    return column;
}

const SnapshotInterpolator::Clock::time_point start{};

TEST(Positions, HeadingsTurnByTheSmallerAngle) {
    const codec::Entities before{
        .id = {1, 2}, .x = {0, 0}, .y = {0, 0}, .width = {}, .height = {}, .heading = {250, 0}};
    const codec::Entities now{.id = {1, 2}, .x = {0, 0}, .y = {0, 0}, .width = {}, .height = {}, .heading = {6, 64}};
    const std::vector<std::uint32_t> match{0, Positions::no_match};
    constexpr float step = 6.2831853f / 256;
    const Positions half{.entities = &now, .previous = &before, .match = match, .blend = 0.5};
    EXPECT_FLOAT_EQ(half.heading_radians(0), 0) << "halfway between -6 and 6 steps";
    EXPECT_FLOAT_EQ(half.heading_radians(1), 64 * step) << "not in the previous snapshot";
    const Positions begin{.entities = &now, .previous = &before, .match = match, .blend = 0};
    EXPECT_FLOAT_EQ(begin.heading_radians(0), -6 * step);
    EXPECT_FLOAT_EQ(Positions{.entities = &now}.heading_radians(0), 6 * step);
}

TEST(SnapshotInterpolator, InterpolatesOrganismsInBothSnapshots) {
    SnapshotInterpolator view;
    view.add(snapshot(10, {{1, 0, 0}, {2, 50, 50}, {4, 10, 20}}), start);
    // 2 has died, and 3 was not seen before.
    view.add(snapshot(12, {{1, 4, 8}, {3, 70, 70}, {4, 20, 20}}), start + 40ms);
    const double blend = view.blend_at(start + 50ms);
    EXPECT_DOUBLE_EQ(blend, 0.25);
    const Positions at = view.organisms_at(blend);
    EXPECT_EQ(x_px(at), (std::vector<float>{1, 70, 12.5}));
    EXPECT_EQ(at[0].y_px, 2);
    EXPECT_EQ(at[1].y_px, 70);
    EXPECT_EQ(at[2].y_px, 20);
}

TEST(SnapshotInterpolator, StaysAtTheLatest) {
    SnapshotInterpolator view;
    view.add(snapshot(10, {{1, 0, 0}}), start);
    view.add(snapshot(12, {{1, 4, 8}}), start + 40ms);
    EXPECT_EQ(view.blend_at(start + 40ms), 0);
    EXPECT_EQ(view.blend_at(start + 10s), 1);
    EXPECT_EQ(x_px(view.organisms_at(1)), (std::vector<float>{4}));
}

TEST(SnapshotInterpolator, AStepAfterALongPauseIsShownSoon) {
    SnapshotInterpolator view;
    view.add(snapshot(10, {{1, 0, 0}}), start);
    view.add(snapshot(11, {{1, 4, 8}}), start + 60s);
    EXPECT_EQ(view.blend_at(start + 60s + 250ms), 1);
}

TEST(SnapshotInterpolator, DoesNotInterpolateLivesOrLongLeaps) {
    const auto alone_after = [](const auto& change) {
        SnapshotInterpolator view;
        view.add(snapshot(10, {{1, 0, 0}}), start);
        auto next = snapshot(12, {{1, 4, 8}});
        change(next->about);
        view.add(next, start + 40ms);
        EXPECT_EQ(view.organisms_at(view.blend_at(start + 41ms)).size(), 1U);
        return view.previous() == nullptr && view.blend_at(start + 41ms) == 1;
    };
    EXPECT_FALSE(alone_after([](auto&) {}));
    EXPECT_TRUE(alone_after([](auto& about) { about.set_generation(2); }));
    EXPECT_TRUE(alone_after([](auto& about) { about.set_run_id("another"); }));
    EXPECT_TRUE(alone_after([](auto& about) { about.set_world("another"); }));
    EXPECT_TRUE(alone_after([](auto& about) { about.set_island(1); }));
    EXPECT_TRUE(alone_after([](auto& about) { about.set_tick(9); }));
    EXPECT_TRUE(alone_after([](auto& about) { about.set_simulated_s(2.5); }));
}

TEST(SnapshotInterpolator, ASnapshotOfTheSameTickReplacesTheLatest) {
    SnapshotInterpolator view;
    view.add(snapshot(10, {{1, 0, 0}, {2, 0, 0}}), start);
    view.add(snapshot(12, {{1, 4, 8}}), start + 40ms);
    view.add(snapshot(12, {{1, 4, 8}, {2, 8, 8}, {3, 5, 5}}), start + 50ms); // another region was asked for
    const double blend = view.blend_at(start + 60ms);
    EXPECT_DOUBLE_EQ(blend, 0.5);
    EXPECT_EQ(x_px(view.organisms_at(blend)), (std::vector<float>{2, 4, 5}));
}

TEST(SnapshotInterpolator, InterpolatesCratesInBothSnapshots) {
    SnapshotInterpolator view;
    const codec::Column zero{0, 0}, one = codec::px_column({1, 1});
    view.add(snapshot_of_crates(1, {{3, 7}, codec::px_column({0, 10}), zero, one, one}), start);
    // Another one is seen, and the first not any more.
    view.add(snapshot_of_crates(2, {{5, 7}, codec::px_column({2, 20}), zero, one, one}), start + 10ms);
    EXPECT_EQ(x_px(view.crates_at(0.5)), (std::vector<float>{2, 15}));
    // On a whole island crates have no ids: a crate is matched by its index.
    view.clear();
    view.add(snapshot_of_crates(1, {{}, codec::px_column({0, 10}), zero, one, one}), start);
    view.add(snapshot_of_crates(2, {{}, codec::px_column({2, 20}), zero, one, one}), start + 10ms);
    EXPECT_EQ(x_px(view.crates_at(0.5)), (std::vector<float>{1, 15}));
    view.clear();
    EXPECT_EQ(view.latest(), nullptr);
    EXPECT_EQ(view.crates_at(0.5).size(), 0U);
}

} // namespace
} // namespace evod::core
