#include "server/simulation/placement.h"

#include "server/base/assert.h"
#include "server/physics/shapes.h"

#include <algorithm>
#include <numeric>

namespace evod::simulation {
namespace {

using physics::Boxes;
using physics::Coordinate;

// A set of parameters is accepted only if there is room, so running out of attempts means a defect.
constexpr int tries_max = 1'000'000;

/// Draws a coordinate that is uniform in margin … size − margin.
///
/// margin  less than half of `size` in px. Rounding may have made it greater than that half: then the coordinate is in
///         the middle.
Coordinate uniform_coordinate(base::RandomStream& random, Coordinate margin, Coordinate size) {
    margin = std::min(margin, size / 2);
    return margin + static_cast<Coordinate>(random.below(static_cast<std::uint32_t>(size - 2 * margin) + 1));
}

Place uniform_place(base::RandomStream& random, float half_size_px, float margin_px, const physics::Area& area) {
    const Coordinate margin = physics::to_units(std::max(half_size_px, margin_px));
    const Coordinate x = uniform_coordinate(random, margin, area.width);
    return {x, uniform_coordinate(random, margin, area.height)};
}

/// Returns the greatest distance, along either axis, between the centre of a body of `half_size_px` and the centre of a
/// body that touches it. A few units are added, because shape tests round.
Coordinate reach_of(float half_size_px, float widest_px) {
    return physics::to_units(half_size_px + widest_px) + 2;
}

// The circles of a batch search for places in parallel, each clear of the circles of earlier batches. Batches are so
// small that their circles seldom overlap each other. The size of batches does not affect the result.
constexpr std::size_t batch_circles_min = 2048, batches = 64;
constexpr std::size_t circles_per_piece = 256;
constexpr std::size_t prefetched_ahead = 8;

/// The attempts of an organism so far.
struct Attempts {
    base::RandomStream random;
    Place last{};
};

} // namespace

void PlacedCircles::prefetch(Place place, float radius_px) const {
    grid_.prefetch(place, reach_of(radius_px, widest_px_));
}

bool PlacedCircles::clear(Place place, float radius_px) const {
    return grid_.empty() || !grid_.any_near(place, reach_of(radius_px, widest_px_), [&](Place other, float other_px) {
        // Does the same test as physics::circle_circle(), but without depth and normal, which are not needed here.
        const float dx = physics::distance_px(other.x, place.x), dy = physics::distance_px(other.y, place.y);
        const float touch = other_px + radius_px;
        return dx * dx + dy * dy <= touch * touch;
    });
}

BoxGrid::BoxGrid(const physics::Area& area, const Boxes& boxes) : BoxGrid{area, boxes.size()} {
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        add({boxes.x[i], boxes.y[i]}, boxes.half_width[i], boxes.half_height[i]);
    }
}

void BoxGrid::add(Place place, float half_width_px, float half_height_px) {
    grid_.add(place, {half_width_px, half_height_px});
    widest_px_ = std::max({widest_px_, half_width_px, half_height_px});
}

bool BoxGrid::clear_of_circle(Place place, float radius_px) const {
    return grid_.empty() || !grid_.any_near(place, reach_of(radius_px, widest_px_), [&](Place box, HalfSize half) {
        return physics::box_circle(physics::distance_px(box.x, place.x), physics::distance_px(box.y, place.y),
                                   {half.width_px, half.height_px}, radius_px)
            .touching;
    });
}

bool BoxGrid::clear_of_box(Place place, float half_size_px) const {
    return grid_.empty() || !grid_.any_near(place, reach_of(half_size_px, widest_px_), [&](Place box, HalfSize half) {
        return physics::box_box(physics::distance_px(box.x, place.x), physics::distance_px(box.y, place.y),
                                {half.width_px, half.height_px}, {half_size_px, half_size_px})
            .touching;
    });
}

Place random_place(base::RandomStream& random, const physics::Area& area, float radius_px, const BoxGrid& boxes,
                   float margin_px) {
    for (int attempt = 0; attempt < tries_max; ++attempt) {
        const Place place = uniform_place(random, radius_px, margin_px, area);
        if (boxes.clear_of_circle(place, radius_px)) {
            return place;
        }
    }
    EVOD_ASSERT(false && "room for an item");
}

PlacedBoxes place_boxes(const BoxRules& rules, base::Seed seed, std::uint32_t island, std::uint64_t generation,
                        const physics::Area& area) {
    PlacedBoxes placed;
    BoxGrid grid{area, std::size_t{rules.obstacle_count} + rules.crate_count};
    const base::RandomKey obstacle_key{seed, base::Purpose::ObstaclePlacement, island, 0};
    for (std::uint32_t i = 0; i < rules.obstacle_count; ++i) {
        base::RandomStream random{obstacle_key, i};
        const Place place = uniform_place(random, rules.obstacle_half_size_px, rules.margin_px, area);
        placed.obstacles.add(place.x, place.y, rules.obstacle_half_size_px, rules.obstacle_half_size_px, 0);
        grid.add(place, rules.obstacle_half_size_px, rules.obstacle_half_size_px);
    }
    const base::RandomKey crate_key{seed, base::Purpose::CratePlacement, island, generation};
    const float half = rules.crate_half_size_px;
    for (std::uint32_t i = 0; i < rules.crate_count; ++i) {
        base::RandomStream random{crate_key, i};
        bool done = false;
        for (int attempt = 0; attempt < tries_max && !done; ++attempt) {
            const Place place = uniform_place(random, half, rules.margin_px, area);
            done = grid.clear_of_box(place, half);
            if (done) {
                placed.crates.add(place.x, place.y, half, half, 1 / rules.crate_mass_kg);
                grid.add(place, half, half);
            }
        }
        EVOD_ASSERT(done && "room for a crate");
    }
    return placed;
}

std::vector<Place> place_circles(const std::vector<float>& radius_px, base::Seed seed, std::uint32_t island,
                                 std::uint64_t generation, const physics::Area& area, const BoxGrid& boxes,
                                 base::Executor& executor, float margin_px) {
    const std::size_t count = radius_px.size();
    const base::RandomKey key{seed, base::Purpose::OrganismPlacement, island, generation};
    PlacedCircles placed{area, count, count == 0 ? 0 : *std::ranges::max_element(radius_px)};
    std::vector<Place> places(count);
    const std::size_t batch_size = std::max(batch_circles_min, count / batches);
    std::vector<Attempts> attempts(std::min(batch_size, count), Attempts{{key, 0}});
    const auto make_attempt = [&](Attempts& of, std::size_t id) {
        of.last = uniform_place(of.random, radius_px[id], margin_px, area);
    };
    const auto succeeds = [&](const Attempts& of, std::size_t id) {
        return placed.clear(of.last, radius_px[id]) && boxes.clear_of_circle(of.last, radius_px[id]);
    };

    for (std::size_t first = 0; first < count; first += batch_size) {
        const std::size_t batch = std::min(batch_size, count - first);
        // Placed bodies are not removed, so an attempt that fails now would also fail later.
        executor.parallel_for(batch, circles_per_piece, [&](base::Range piece) {
            std::vector<std::size_t> looking(piece.end - piece.begin);
            std::iota(looking.begin(), looking.end(), piece.begin);
            for (const std::size_t i : looking) {
                attempts[i] = {{key, static_cast<std::uint32_t>(first + i)}};
            }
            for (int round = 0; !looking.empty(); ++round) {
                EVOD_ASSERT(round < tries_max && "room for an organism");
                for (const std::size_t i : looking) {
                    make_attempt(attempts[i], first + i);
                    placed.prefetch(attempts[i].last, radius_px[first + i]);
                }
                std::erase_if(looking, [&](std::size_t i) { return succeeds(attempts[i], first + i); });
            }
        });
        // Only conflicts with earlier organisms of the batch remain to be checked.
        for (std::size_t i = 0; i < batch; ++i) {
            const std::size_t id = first + i;
            if (i + prefetched_ahead < batch) {
                placed.prefetch(attempts[i + prefetched_ahead].last, radius_px[id + prefetched_ahead]);
            }
            for (int tries = 0; !succeeds(attempts[i], id); ++tries) {
                EVOD_ASSERT(tries < tries_max && "room for an organism");
                make_attempt(attempts[i], id);
            }
            places[id] = attempts[i].last;
            placed.add(places[id], radius_px[id]);
        }
    }
    return places;
}

} // namespace evod::simulation
