#include "server/simulation/item_claims.h"

#include "server/base/assert.h"
#include "server/physics/broad_phase.h"

#include <bit>
#include <tuple>

namespace evod::simulation {

void ItemClaims::begin(std::size_t blocks) {
    constexpr std::size_t usually_enough = 32;
    physics::resize_lists(touches_of_block_, blocks, usually_enough);
    first_of_item_.reserve(4 * blocks * usually_enough);
}

void ItemClaims::find_touches(std::size_t block, std::span<const std::uint32_t> at_items,
                              const physics::Circles& bodies, const Items& items) {
    EVOD_ASSERT(block < touches_of_block_.size());
    std::vector<Touch>& touches = touches_of_block_[block];
    touches.clear();
    for (const std::uint32_t i : at_items) {
        EVOD_ASSERT(i < bodies.size());
        items.prefetch(bodies.x[i], bodies.y[i]);
    }
    for (const std::uint32_t i : at_items) {
        items.for_each_within(bodies.x[i], bodies.y[i], bodies.radius[i] + items.radius_px(),
                              [&](std::uint32_t item, std::uint32_t place, float square) {
                                  touches.push_back({item, place, square, bodies.id[i], i, true});
                              });
    }
}

std::size_t ItemClaims::award() {
    std::size_t count = 0;
    for (const std::vector<Touch>& touches : touches_of_block_) {
        count += touches.size();
    }
    const std::size_t slots = std::bit_ceil(2 * count);
    first_of_item_.assign(slots, nullptr);
    for (std::vector<Touch>& touches : touches_of_block_) {
        for (Touch& touch : touches) {
            std::size_t slot = touch.item * 0x9e37'79b9u & (slots - 1);
            while (first_of_item_[slot] != nullptr && first_of_item_[slot]->item != touch.item) {
                slot = (slot + 1) & (slots - 1);
            }
            Touch*& first = first_of_item_[slot];
            if (first == nullptr) {
                first = &touch;
                continue;
            }
            --count;
            const bool nearer = std::tie(touch.square, touch.id) < std::tie(first->square, first->id);
            (nearer ? first : &touch)->gets_it = false;
            first = nearer ? &touch : first;
        }
    }
    return count;
}

} // namespace evod::simulation
