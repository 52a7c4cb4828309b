#include "client/core/world_view.h"

#include <gtest/gtest.h>

namespace evod::core {
namespace {

using namespace std::chrono_literals;

struct Stand {
    std::uint32_t id;
    float x, y;
};

std::shared_ptr<codec::DecodedSnapshot> snapshot(std::uint64_t tick, std::initializer_list<Stand> organisms) {
    auto snapshot = std::make_shared<codec::DecodedSnapshot>();
    snapshot->about.set_tick(tick);
    snapshot->about.set_generation(1);
    snapshot->about.set_simulated_s(static_cast<double>(tick) / 60);
    for (const Stand& stand : organisms) {
        snapshot->organisms.id.push_back(stand.id);
        snapshot->organisms.x_px.push_back(stand.x);
        snapshot->organisms.y_px.push_back(stand.y);
    }
    return snapshot;
}

const WorldView::Clock::time_point start{};

TEST(WorldView, InterpolatesOrganismsInBothSnapshots) {
    WorldView view;
    view.add(snapshot(10, {{1, 0, 0}, {2, 50, 50}, {4, 10, 20}}), start);
    // 2 has died, and 3 was not seen before.
    view.add(snapshot(12, {{1, 4, 8}, {3, 70, 70}, {4, 20, 20}}), start + 40ms);
    const double blend = view.blend_at(start + 50ms);
    EXPECT_DOUBLE_EQ(blend, 0.25);
    const auto& at = view.organisms_at(blend);
    EXPECT_EQ(at.x_px, (std::vector<float>{1, 70, 12.5}));
    EXPECT_EQ(at.y_px, (std::vector<float>{2, 70, 20}));
}

TEST(WorldView, StaysAtTheLatest) {
    WorldView view;
    view.add(snapshot(10, {{1, 0, 0}}), start);
    view.add(snapshot(12, {{1, 4, 8}}), start + 40ms);
    EXPECT_EQ(view.blend_at(start + 40ms), 0);
    EXPECT_EQ(view.blend_at(start + 10s), 1);
    EXPECT_EQ(view.organisms_at(1).x_px, (std::vector<float>{4}));
}

TEST(WorldView, AStepAfterALongPauseIsShownSoon) {
    WorldView view;
    view.add(snapshot(10, {{1, 0, 0}}), start);
    view.add(snapshot(11, {{1, 4, 8}}), start + 60s);
    EXPECT_EQ(view.blend_at(start + 60s + 250ms), 1);
}

TEST(WorldView, DoesNotInterpolateLivesOrLongLeaps) {
    const auto alone_after = [](const auto& change) {
        WorldView view;
        view.add(snapshot(10, {{1, 0, 0}}), start);
        auto next = snapshot(12, {{1, 4, 8}});
        change(next->about);
        view.add(next, start + 40ms);
        EXPECT_EQ(view.organisms_at(view.blend_at(start + 41ms)).x_px.size(), 1U);
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

TEST(WorldView, ASnapshotOfTheSameTickReplacesTheLatest) {
    WorldView view;
    view.add(snapshot(10, {{1, 0, 0}, {2, 0, 0}}), start);
    view.add(snapshot(12, {{1, 4, 8}}), start + 40ms);
    view.add(snapshot(12, {{1, 4, 8}, {2, 8, 8}, {3, 5, 5}}), start + 50ms); // another region was asked for
    const double blend = view.blend_at(start + 60ms);
    EXPECT_DOUBLE_EQ(blend, 0.5);
    EXPECT_EQ(view.organisms_at(blend).x_px, (std::vector<float>{2, 4, 5}));
}

TEST(WorldView, InterpolatesCratesInBothSnapshots) {
    WorldView view;
    auto first = snapshot(1, {}), second = snapshot(2, {});
    first->crates = {.x_px = {0, 10}, .y_px = {0, 0}, .half_width_px = {1, 1}, .half_height_px = {1, 1}, .id = {3, 7}};
    // Another one is seen, and the first not any more.
    second->crates = {.x_px = {2, 20}, .y_px = {4, 0}, .half_width_px = {1, 1}, .half_height_px = {1, 1}, .id = {5, 7}};
    view.add(first, start);
    view.add(second, start + 10ms);
    EXPECT_EQ(view.crates_at(0.5).x_px, (std::vector<float>{2, 15}));
    view.clear();
    EXPECT_EQ(view.latest(), nullptr);
    EXPECT_TRUE(view.crates_at(0.5).x_px.empty());
}

} // namespace
} // namespace evod::core
