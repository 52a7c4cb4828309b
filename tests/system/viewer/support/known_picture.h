// A picture of which a test knows everything.
#pragma once

#include "proto/wire/snapshot_codec.h"

#include <array>
#include <cstdint>

namespace evod::viewer {

/// One of everything that can be told apart, on an island of another shape than the window's.
inline evod::v1::SnapshotFrame known_picture() {
    constexpr std::int32_t px = 1 << 12; // in the fixed point of the columns
    const std::array<std::uint32_t, 4> ids{0, 3, 4, 9};
    const std::array<std::int32_t, 4> x{100 * px, 300 * px + px / 3, 500 * px, 790 * px};
    const std::array<std::int32_t, 4> y{100 * px, 450 * px, 300 * px + px / 2, 590 * px};
    const std::array<float, 4> radius{10, 20, 4, 10}, health{100, 63.2f, 0.4f, 7};
    const std::array<std::uint32_t, 3> food_ids{1, 2, 5}, poison_ids{0, 1, 8};
    const std::array<std::int32_t, 3> food_x{4 * px, 300 * px, 640 * px}, food_y{4 * px, 450 * px, 200 * px};
    const std::array<std::int32_t, 3> poison_x{700 * px, 205 * px, 415 * px}, poison_y{100 * px, 300 * px, 505 * px};
    const std::array<std::int32_t, 1> crate_x{200 * px}, crate_y{200 * px}, rock_x{600 * px}, rock_y{450 * px};
    const std::array<float, 1> crate_half{15}, rock_width{60}, rock_height{25};
    evod::v1::SnapshotFrame frame;
    wire::encode({.width_px = 800,
                  .height_px = 600,
                  .organisms = {ids, x, y, radius, health},
                  .food = {food_ids, food_x, food_y},
                  .poison = {poison_ids, poison_x, poison_y},
                  .crates = {crate_x, crate_y, crate_half, crate_half},
                  .obstacles = {rock_x, rock_y, rock_width, rock_height}},
                 frame);
    frame.set_world("default");
    frame.set_run_id("00112233445566778899aabbccddeeff");
    frame.set_island_count(1);
    frame.set_tick(36'034);
    frame.set_generation(16);
    frame.set_simulated_s(600.56);
    frame.set_state(evod::v1::RUN_STATE_RUNNING);
    frame.mutable_speed()->set_real_time_factor(4);
    frame.set_ticks_per_s(240);
    frame.set_item_radius_px(5);
    frame.mutable_live()->set_organism_count(50);
    frame.mutable_live()->set_alive_count(4);
    frame.mutable_live()->set_health_mean(42.65);
    frame.mutable_live()->set_food_eaten(312);
    frame.mutable_live()->set_poison_eaten(45);
    return frame;
}

} // namespace evod::viewer
