// A snapshot with known content.
#pragma once

#include "proto/codec/snapshot_codec.h"

#include <cstdint>

namespace evod::viewer {

/// Contains everything that is drawn differently, on an island with another shape than the window.
inline evod::v1::SnapshotFrame known_snapshot() {
    constexpr std::uint32_t px = 16; // quantisation steps
    const codec::QuantisedSnapshot quantised{
        .organisms = {.id = {0, 3, 4, 9},
                      .x = {100 * px, 300 * px + 5, 500 * px, 790 * px},
                      .y = {100 * px, 450 * px, 300 * px + 8, 590 * px},
                      .width = {10 * px, 20 * px, 4 * px, 10 * px},
                      .height = {1600, 1011, 6, 112}},
        .food = {.id = {1, 2, 5},
                 .x = {4 * px, 300 * px, 640 * px},
                 .y = {4 * px, 450 * px, 200 * px},
                 .width = {},
                 .height = {}},
        .poison = {.id = {0, 1, 8},
                   .x = {700 * px, 205 * px, 415 * px},
                   .y = {100 * px, 300 * px, 505 * px},
                   .width = {},
                   .height = {}},
        .crates = {.id = {}, .x = {200 * px}, .y = {200 * px}, .width = {15 * px}, .height = {15 * px}},
        .obstacles = {.id = {}, .x = {600 * px}, .y = {450 * px}, .width = {60 * px}, .height = {25 * px}}};
    evod::v1::SnapshotFrame frame;
    frame.set_width_px(800);
    frame.set_height_px(600);
    codec::encode_plain(quantised, frame);
    frame.set_world("default");
    frame.set_run_id(std::string("\x00\x11\x22\x33\x44\x55\x66\x77\x88\x99\xaa\xbb\xcc\xdd\xee\xff", 16));
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
