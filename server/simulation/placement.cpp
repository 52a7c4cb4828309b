#include "server/simulation/placement.h"

#include "server/base/assert.h"
#include "server/physics/shapes.h"

#include <algorithm>

namespace evod::simulation {
namespace {

using physics::Boxes;
using physics::Coordinate;

// Room is checked before a set of parameters is accepted, so that running out of tries means a defect.
constexpr int tries_max = 1'000'000;

/// Uniform in margin … size − margin.
Coordinate uniform_coordinate(base::RandomStream& random, Coordinate margin, Coordinate size) {
    EVOD_ASSERT(size >= 2 * std::int64_t{margin});
    return margin + static_cast<Coordinate>(random.below(static_cast<std::uint32_t>(size - 2 * margin) + 1));
}

Place uniform_place(base::RandomStream& random, Coordinate margin, const physics::Area& area) {
    const Coordinate x = uniform_coordinate(random, margin, area.width);
    return {x, uniform_coordinate(random, margin, area.height)};
}

bool circle_is_clear(Place place, float radius, const Boxes& boxes) {
    for (std::size_t i = 0; i < boxes.size(); ++i)
        if (physics::box_circle(physics::distance_px(boxes.x[i], place.x), physics::distance_px(boxes.y[i], place.y),
                                {boxes.half_width[i], boxes.half_height[i]}, radius)
                .touching)
            return false;
    return true;
}

bool box_is_clear(Place place, float half_size, const Boxes& boxes) {
    for (std::size_t i = 0; i < boxes.size(); ++i)
        if (physics::box_box(physics::distance_px(boxes.x[i], place.x), physics::distance_px(boxes.y[i], place.y),
                             {boxes.half_width[i], boxes.half_height[i]}, {half_size, half_size})
                .touching)
            return false;
    return true;
}

/// Circles already placed, in lists per square cell at least as wide as the widest circle.
class PlacedCircles {
  public:
    PlacedCircles(const std::vector<float>& radius, const physics::Area& area) : radius_{radius} {
        const float widest = radius.empty() ? 0 : 2 * *std::max_element(radius.begin(), radius.end());
        const double share = static_cast<double>(area.width) * area.height /
                             static_cast<double>(std::max<std::size_t>(radius.size(), 1));
        while (shift_ < 30 &&
               (static_cast<double>(1u << shift_) < static_cast<double>(widest) * physics::units_per_px ||
                static_cast<double>(1u << shift_) * static_cast<double>(1u << shift_) * 4 < share))
            ++shift_;
        columns_ = (area.width >> shift_) + 1;
        rows_ = (area.height >> shift_) + 1;
        head_.assign(static_cast<std::size_t>(rows_) * static_cast<std::size_t>(columns_), none);
        next_.assign(radius.size(), none);
        places_.reserve(radius.size());
    }

    bool clear(Place place, float radius) const {
        const Coordinate column = place.x >> shift_, row = place.y >> shift_;
        for (Coordinate r = std::max(row - 1, 0); r <= std::min(row + 1, rows_ - 1); ++r)
            for (Coordinate c = std::max(column - 1, 0); c <= std::min(column + 1, columns_ - 1); ++c)
                for (std::uint32_t i = head_[cell(r, c)]; i != none; i = next_[i])
                    if (physics::circle_circle(physics::distance_px(places_[i].x, place.x),
                                               physics::distance_px(places_[i].y, place.y), radius_[i], radius)
                            .touching)
                        return false;
        return true;
    }

    void add(Place place) {
        std::uint32_t& head = head_[cell(place.y >> shift_, place.x >> shift_)];
        next_[places_.size()] = head;
        head = static_cast<std::uint32_t>(places_.size());
        places_.push_back(place);
    }

    std::vector<Place> take() { return std::move(places_); }

  private:
    static constexpr std::uint32_t none = ~0u;
    std::size_t cell(Coordinate row, Coordinate column) const {
        return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column);
    }

    const std::vector<float>& radius_;
    unsigned shift_ = 12;
    Coordinate rows_ = 0, columns_ = 0;
    std::vector<std::uint32_t> head_, next_;
    std::vector<Place> places_;
};

} // namespace

Place random_place(base::RandomStream& random, const physics::Area& area, float radius_px, const Boxes& boxes) {
    const Coordinate margin = physics::to_units(radius_px);
    for (int attempt = 0; attempt < tries_max; ++attempt) {
        const Place place = uniform_place(random, margin, area);
        if (circle_is_clear(place, radius_px, boxes))
            return place;
    }
    EVOD_ASSERT(false && "room for an item");
}

PlacedBoxes place_boxes(const BoxRules& rules, base::Seed seed, std::uint32_t island, std::uint64_t generation,
                        const physics::Area& area) {
    PlacedBoxes placed;
    const base::RandomKey obstacle_key{seed, base::Purpose::ObstaclePlacement, island, 0};
    for (std::uint32_t i = 0; i < rules.obstacle_count; ++i) {
        base::RandomStream random{obstacle_key, i};
        const Place place = uniform_place(random, physics::to_units(rules.obstacle_half_size_px), area);
        placed.obstacles.add(place.x, place.y, rules.obstacle_half_size_px, rules.obstacle_half_size_px, 0);
    }
    const base::RandomKey crate_key{seed, base::Purpose::CratePlacement, island, generation};
    const float half = rules.crate_half_size_px;
    for (std::uint32_t i = 0; i < rules.crate_count; ++i) {
        base::RandomStream random{crate_key, i};
        bool done = false;
        for (int attempt = 0; attempt < tries_max && !done; ++attempt) {
            const Place place = uniform_place(random, physics::to_units(half), area);
            done = box_is_clear(place, half, placed.obstacles) && box_is_clear(place, half, placed.crates);
            if (done)
                placed.crates.add(place.x, place.y, half, half, 1 / rules.crate_mass_kg);
        }
        EVOD_ASSERT(done && "room for a crate");
    }
    return placed;
}

std::vector<Place> place_circles(const std::vector<float>& radius_px, base::Seed seed, std::uint32_t island,
                                 std::uint64_t generation, const physics::Area& area, const Boxes& boxes) {
    const base::RandomKey key{seed, base::Purpose::OrganismPlacement, island, generation};
    PlacedCircles placed{radius_px, area};
    for (std::uint32_t id = 0; id < radius_px.size(); ++id) {
        base::RandomStream random{key, id};
        const Coordinate margin = physics::to_units(radius_px[id]);
        bool done = false;
        for (int attempt = 0; attempt < tries_max && !done; ++attempt) {
            const Place place = uniform_place(random, margin, area);
            done = placed.clear(place, radius_px[id]) && circle_is_clear(place, radius_px[id], boxes);
            if (done)
                placed.add(place);
        }
        EVOD_ASSERT(done && "room for an organism");
    }
    return placed.take();
}

} // namespace evod::simulation
