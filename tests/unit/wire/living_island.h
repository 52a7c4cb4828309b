// LivingIsland: an island to take pictures of, on which everything happens that can happen between two of them.
#pragma once

#include "proto/wire/delta_codec.h"
#include "proto/wire/snapshot_codec.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

namespace evod::wire {

constexpr std::int32_t px = 4096; // fixed-point units

using Random = std::mt19937_64; // its numbers are the same everywhere; what distributions make of them is not

inline std::uint64_t below(Random& random, std::uint64_t end) {
    return random() % end;
}

/// An island that lives: everything that can happen between two pictures does.
struct LivingIsland {
    double side_px = 4000; // of a square
    struct Organism {
        std::uint32_t id;
        std::int64_t x, y, dx, dy;
        float radius, health;
    };
    struct Item {
        std::uint32_t id;
        std::int64_t x, y;
    };
    struct Box {
        std::int64_t x, y;
        float half_width, half_height;
    };
    std::vector<Organism> organisms;
    std::vector<Item> food, poison;
    std::vector<Box> crates, obstacles;

    std::int64_t anywhere(Random& random) const {
        return static_cast<std::int64_t>(below(random, static_cast<std::uint64_t>(side_px) * px));
    }

    void populate(Random& random) {
        for (std::uint64_t left = below(random, 60); left > 0; --left) {
            add_organism(random);
        }
        for (auto* items : {&food, &poison}) {
            std::uint32_t id = 0;
            for (std::uint64_t left = below(random, 90); left > 0; --left) {
                id += 1 + static_cast<std::uint32_t>(below(random, 3));
                items->push_back({id, anywhere(random), anywhere(random)});
            }
        }
        for (auto* boxes : {&crates, &obstacles}) {
            for (std::uint64_t left = below(random, 4); left > 0; --left) {
                boxes->push_back({anywhere(random), anywhere(random), 9.F, 12.5F});
            }
        }
    }

    void add_organism(Random& random) {
        const std::uint32_t before = organisms.empty() ? 0 : organisms.back().id;
        organisms.push_back({before + 1 + static_cast<std::uint32_t>(below(random, 300)), anywhere(random),
                             anywhere(random), static_cast<std::int64_t>(below(random, 40 * px)) - 20 * px,
                             static_cast<std::int64_t>(below(random, 40 * px)) - 20 * px, 10.F, 100.F});
    }

    void live(Random& random, std::uint64_t ticks) {
        const auto top = static_cast<std::int64_t>(side_px * px);
        for (Organism& organism : organisms) {
            organism.dx += static_cast<std::int64_t>(below(random, px)) - px / 2;
            organism.x = std::clamp<std::int64_t>(organism.x + organism.dx * static_cast<std::int64_t>(ticks), 0, top);
            organism.y = std::clamp<std::int64_t>(organism.y + organism.dy * static_cast<std::int64_t>(ticks), 0, top);
            organism.health -= 0.1F * static_cast<float>(ticks);
            if (below(random, 50) == 0) { // from one end to the other, and health that is none or too much
                organism.x = below(random, 2) == 0 ? 0 : top;
                organism.y = anywhere(random);
                organism.health = below(random, 2) == 0 ? std::nanf("") : 1e9F;
            }
            if (below(random, 90) == 0) { // another one of the same name
                organism.radius += 1.F;
            }
        }
        std::erase_if(organisms, [&](const Organism&) { return below(random, 40) == 0; });
        for (std::uint64_t left = below(random, 3); left > 0; --left) {
            add_organism(random);
        }
        for (auto* items : {&food, &poison}) {
            for (Item& item : *items) {
                if (below(random, 30) == 0) { // eaten, and back elsewhere
                    item.x = anywhere(random);
                }
            }
            std::erase_if(*items, [&](const Item&) { return below(random, 30) == 0; });
            if (below(random, 3) == 0 && (items->empty() || items->front().id > 0)) {
                items->insert(items->begin(), {0, anywhere(random), anywhere(random)});
            }
        }
        for (Box& box : crates) {
            box.x = std::clamp<std::int64_t>(box.x + static_cast<std::int64_t>(below(random, px)), 0, top);
        }
    }

    /// What encoders are handed.
    struct Arrays {
        double side_px;
        struct Places {
            std::vector<std::uint32_t> id;
            std::vector<std::int32_t> x, y;
            std::vector<float> width, height;
        };
        std::array<Places, 5> all;

        IslandColumns columns() const {
            return {.width_px = side_px,
                    .height_px = side_px,
                    .position_fraction_bits = 12,
                    .organisms = {all[0].id, all[0].x, all[0].y, all[0].width, all[0].height},
                    .food = {all[1].id, all[1].x, all[1].y},
                    .poison = {all[2].id, all[2].x, all[2].y},
                    .crates = {all[3].x, all[3].y, all[3].width, all[3].height},
                    .obstacles = {all[4].x, all[4].y, all[4].width, all[4].height}};
        }
    };

    Arrays arrays() const {
        Arrays arrays{.side_px = side_px, .all = {}};
        auto& all = arrays.all;
        const auto place = [](Arrays::Places& places, const auto& entity) {
            places.x.push_back(static_cast<std::int32_t>(std::min<std::int64_t>(entity.x, 0x7fffffff)));
            places.y.push_back(static_cast<std::int32_t>(std::min<std::int64_t>(entity.y, 0x7fffffff)));
        };
        for (const Organism& organism : organisms) {
            place(all[0], organism);
            all[0].id.push_back(organism.id);
            all[0].width.push_back(organism.radius);
            all[0].height.push_back(organism.health);
        }
        const std::array<const std::vector<Item>*, 2> items{&food, &poison};
        const std::array<const std::vector<Box>*, 2> boxes{&crates, &obstacles};
        for (std::size_t k = 0; k < 2; ++k) {
            for (const Item& item : *items[k]) {
                place(all[1 + k], item);
                all[1 + k].id.push_back(item.id);
            }
            for (const Box& box : *boxes[k]) {
                place(all[3 + k], box);
                all[3 + k].width.push_back(box.half_width);
                all[3 + k].height.push_back(box.half_height);
            }
        }
        return arrays;
    }

    Scene scene() const { return scene_of(arrays().columns()); }

    /// All of a frame but its body, codec and sequence.
    evod::v1::SnapshotFrame about() const {
        evod::v1::SnapshotFrame frame;
        frame.set_world("w");
        frame.set_run_id("r");
        frame.set_island_count(1);
        describe(arrays().columns(), frame);
        return frame;
    }
};

} // namespace evod::wire
