// Living island: an island to take snapshots of, on which everything happens that can happen between two snapshots.
#pragma once

#include "proto/codec/delta_codec.h"
#include "proto/codec/snapshot_codec.h"
#include "proto/codec/steps.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

namespace evod::codec {

constexpr std::int32_t px = 4096; // fixed-point units

using Random = std::mt19937_64; // the same on every platform, unlike the distributions

inline std::uint64_t below(Random& random, std::uint64_t end) {
    return random() % end;
}

struct LivingIsland {
    double side_px = 4000; // of a square
    bool headings = false; // whether organisms have headings
    bool species = false;  // whether organisms have a species
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
            if (below(random, 50) == 0) { // it jumps across the island, and its health is NaN or too large
                organism.x = below(random, 2) == 0 ? 0 : top;
                organism.y = anywhere(random);
                organism.health = below(random, 2) == 0 ? std::nanf("") : 1e9F;
            }
            if (below(random, 90) == 0) { // another organism with the same id
                organism.radius += 1.F;
            }
        }
        std::erase_if(organisms, [&](const Organism&) { return below(random, 40) == 0; });
        for (std::uint64_t left = below(random, 3); left > 0; --left) {
            add_organism(random);
        }
        for (auto* items : {&food, &poison}) {
            for (Item& item : *items) {
                if (below(random, 30) == 0) { // eaten, and reappeared elsewhere
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

    QuantisedSnapshot snapshot() const {
        QuantisedSnapshot snapshot;
        snapshot.position_bytes = position_bytes_of(side_px, side_px);
        const PositionInSteps in_steps{12, snapshot.position_bytes};
        const auto place = [&](Entities& entities, const auto& entity) {
            entities.x.push_back(in_steps(static_cast<std::int32_t>(std::min<std::int64_t>(entity.x, 0x7fffffff))));
            entities.y.push_back(in_steps(static_cast<std::int32_t>(std::min<std::int64_t>(entity.y, 0x7fffffff))));
        };
        const auto size = [](Entities& entities, float width, float height) {
            entities.width.push_back(size_in_steps(width));
            entities.height.push_back(size_in_steps(height));
        };
        for (const Organism& organism : organisms) {
            snapshot.organisms.id.push_back(organism.id);
            place(snapshot.organisms, organism);
            size(snapshot.organisms, organism.radius, organism.health);
            if (headings) {
                snapshot.organisms.heading.push_back(static_cast<std::uint32_t>(organism.dx >> 6 & 0xff));
            }
            if (species) {
                snapshot.organisms.species.push_back(organism.id % 2);
            }
        }
        for (const auto& [items, entities] : {std::pair{&food, &snapshot.food}, std::pair{&poison, &snapshot.poison}}) {
            for (const Item& item : *items) {
                entities->id.push_back(item.id);
                place(*entities, item);
            }
        }
        for (const auto& [boxes, entities] :
             {std::pair{&crates, &snapshot.crates}, std::pair{&obstacles, &snapshot.obstacles}}) {
            for (const Box& box : *boxes) {
                place(*entities, box);
                size(*entities, box.half_width, box.half_height);
            }
        }
        return snapshot;
    }

    /// A frame without body, codec and sequence.
    evod::v1::SnapshotFrame about() const {
        evod::v1::SnapshotFrame frame;
        frame.set_world("w");
        frame.set_run_id("r");
        frame.set_island_count(1);
        frame.set_width_px(side_px);
        frame.set_height_px(side_px);
        describe(snapshot(), frame);
        return frame;
    }
};

} // namespace evod::codec
