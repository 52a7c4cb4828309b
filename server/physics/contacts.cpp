#include "server/physics/contacts.h"

#include "server/physics/shapes.h"

#include <algorithm>
#include <cmath>

namespace evod::physics {
namespace {

constexpr std::uint64_t pair_of(std::size_t first, std::size_t second) {
    return static_cast<std::uint64_t>(first) << 32 | static_cast<std::uint64_t>(second);
}

bool touch(const CircleGrid::Sorted& a, const CircleGrid::Sorted& b) {
    const float dx = distance_px(a.x, b.x), dy = distance_px(a.y, b.y);
    const float reach = a.radius + b.radius;
    return dx * dx + dy * dy <= reach * reach;
}

BoxShape shape_of(const Boxes& boxes, std::size_t i) {
    return {boxes.half_width[i], boxes.half_height[i]};
}

Overlap overlap_of(const Boxes& boxes, std::size_t a, std::size_t b) {
    return box_box(distance_px(boxes.x[a], boxes.x[b]), distance_px(boxes.y[a], boxes.y[b]), shape_of(boxes, a),
                   shape_of(boxes, b));
}

Overlap overlap_of(const Boxes& boxes, std::size_t box, const Circles& circles, std::size_t circle) {
    return box_circle(distance_px(boxes.x[box], circles.x[circle]), distance_px(boxes.y[box], circles.y[circle]),
                      shape_of(boxes, box), circles.radius[circle]);
}

struct Body {
    Bodies& bodies;
    std::size_t index;
};

/// overlap.normal points from a to b.
void resolve_contact(Body a, Body b, const Overlap& overlap, float restitution) {
    const float mass_a = a.bodies.inverse_mass[a.index], mass_b = b.bodies.inverse_mass[b.index];
    const float total = mass_a + mass_b;
    const float nx = overlap.normal_x, ny = overlap.normal_y;
    const auto move = [&](Body body, float way) {
        body.bodies.x[body.index] += to_units(nx * way);
        body.bodies.y[body.index] += to_units(ny * way);
    };
    move(a, -overlap.depth * (mass_a / total));
    move(b, overlap.depth * (mass_b / total));

    float &ax = a.bodies.velocity_x[a.index], &ay = a.bodies.velocity_y[a.index];
    float &bx = b.bodies.velocity_x[b.index], &by = b.bodies.velocity_y[b.index];
    const float approach = (bx - ax) * nx + (by - ay) * ny;
    if (approach >= 0)
        return;
    const float impulse = -(1 + restitution) * approach / total;
    ax -= impulse * mass_a * nx;
    ay -= impulse * mass_a * ny;
    bx += impulse * mass_b * nx;
    by += impulse * mass_b * ny;
}

} // namespace

void Contacts::find(const Circles& circles, const Boxes& boxes, const Area& area, base::Executor& executor) {
    pairs_.clear();
    float radius_max = 0;
    for (const float radius : circles.radius)
        radius_max = std::max(radius_max, radius);
    if (circles.size() > 1 || (circles.size() > 0 && boxes.size() > 0)) {
        grid_.build(circles, area, 2 * radius_max);
        find_circle_pairs(executor);
        find_box_circle_pairs(circles, boxes, radius_max);
    }
    find_box_pairs(circles, boxes);
    std::sort(pairs_.begin(), pairs_.end());
}

void Contacts::find_circle_pairs(base::Executor& executor) {
    constexpr std::size_t rows_per_block = 16;
    pairs_of_block_.resize((grid_.rows() + rows_per_block - 1) / rows_per_block);
    executor.parallel_for(grid_.rows(), rows_per_block, [&](base::Range range) {
        // One piece may hold several blocks when the loop was not cut.
        for (std::size_t block = range.begin / rows_per_block; block * rows_per_block < range.end; ++block) {
            std::vector<Pair>& found = pairs_of_block_[block];
            found.clear();
            const std::vector<CircleGrid::Sorted>& circle = grid_.sorted();
            const auto test = [&](std::size_t k, base::Range others) {
                for (std::size_t other = others.begin; other < others.end; ++other)
                    if (touch(circle[k], circle[other]))
                        found.push_back(pair_of(std::min(circle[k].index, circle[other].index),
                                                std::max(circle[k].index, circle[other].index)));
            };
            const std::size_t end = std::min<std::size_t>((block + 1) * rows_per_block, grid_.rows());
            for (auto row = static_cast<std::uint32_t>(block * rows_per_block); row < end; ++row)
                for (std::uint32_t column = 0; column < grid_.columns(); ++column) {
                    const base::Range here = grid_.in_row(row, column, column);
                    if (here.begin == here.end)
                        continue;
                    // Each pair is met once: the rest of the cell and its right neighbour stand side by side in memory,
                    // and so do the three neighbours in the next row.
                    const std::uint32_t left = column > 0 ? column - 1 : 0;
                    const std::uint32_t right = std::min(column + 1, grid_.columns() - 1);
                    const std::size_t row_end = grid_.in_row(row, column, right).end;
                    const base::Range below =
                        row + 1 < grid_.rows() ? grid_.in_row(row + 1, left, right) : base::Range{0, 0};
                    for (std::size_t k = here.begin; k < here.end; ++k) {
                        test(k, {k + 1, row_end});
                        test(k, below);
                    }
                }
        }
    });
    for (const std::vector<Pair>& found : pairs_of_block_)
        pairs_.insert(pairs_.end(), found.begin(), found.end());
}

void Contacts::find_box_circle_pairs(const Circles& circles, const Boxes& boxes, float radius_max) {
    for (std::size_t box = 0; box < boxes.size(); ++box) {
        const std::int64_t reach_x = to_units(boxes.half_width[box] + radius_max) + 1;
        const std::int64_t reach_y = to_units(boxes.half_height[box] + radius_max) + 1;
        const std::int64_t x = boxes.x[box], y = boxes.y[box];
        for (std::uint32_t row = grid_.row_of(y - reach_y); row <= grid_.row_of(y + reach_y); ++row)
            for (std::uint32_t column = grid_.column_of(x - reach_x); column <= grid_.column_of(x + reach_x); ++column)
                for (const std::uint32_t circle : grid_.cell(row, column))
                    if (overlap_of(boxes, box, circles, circle).touching)
                        pairs_.push_back(pair_of(circle, circles.size() + box));
    }
}

void Contacts::find_box_pairs(const Circles& circles, const Boxes& boxes) {
    // Sweep along x: a box can only touch those that begin before it ends.
    if (boxes.size() < 2)
        return;
    const auto left = [&](std::uint32_t i) { return boxes.x[i] - to_units(boxes.half_width[i]); };
    boxes_by_left_.resize(boxes.size());
    for (std::uint32_t i = 0; i < boxes.size(); ++i)
        boxes_by_left_[i] = i;
    std::sort(boxes_by_left_.begin(), boxes_by_left_.end(),
              [&](std::uint32_t a, std::uint32_t b) { return left(a) != left(b) ? left(a) < left(b) : a < b; });
    for (std::size_t i = 0; i < boxes_by_left_.size(); ++i) {
        const std::uint32_t a = boxes_by_left_[i];
        // One unit more, because both halves have been rounded.
        const Coordinate right = boxes.x[a] + to_units(boxes.half_width[a]) + 1;
        for (std::size_t j = i + 1; j < boxes_by_left_.size() && left(boxes_by_left_[j]) <= right; ++j) {
            const std::uint32_t b = boxes_by_left_[j];
            if (boxes.inverse_mass[a] + boxes.inverse_mass[b] > 0 && overlap_of(boxes, a, b).touching)
                pairs_.push_back(pair_of(circles.size() + std::min(a, b), circles.size() + std::max(a, b)));
        }
    }
}

void Contacts::resolve(Circles& circles, Boxes& boxes, float restitution) const {
    for (const Pair pair : pairs_) {
        const std::size_t first = pair >> 32, second = pair & 0xffff'ffff;
        if (second < circles.size()) {
            const Overlap overlap = circle_circle(distance_px(circles.x[first], circles.x[second]),
                                                  distance_px(circles.y[first], circles.y[second]),
                                                  circles.radius[first], circles.radius[second]);
            if (overlap.touching)
                resolve_contact({circles, first}, {circles, second}, overlap, restitution);
        } else if (first < circles.size()) {
            const std::size_t box = second - circles.size();
            const Overlap overlap = overlap_of(boxes, box, circles, first);
            if (overlap.touching)
                resolve_contact({boxes, box}, {circles, first}, overlap, restitution);
        } else {
            const std::size_t a = first - circles.size(), b = second - circles.size();
            const Overlap overlap = overlap_of(boxes, a, b);
            if (overlap.touching)
                resolve_contact({boxes, a}, {boxes, b}, overlap, restitution);
        }
    }
}

namespace {

/// Applies `wall` to each axis of each movable body, with its half extent in units.
template <class Wall>
void for_each_axis(Circles& circles, Boxes& boxes, const Area& area, Wall&& wall) {
    for (std::size_t i = 0; i < circles.size(); ++i) {
        const Coordinate extent = to_units(circles.radius[i]);
        wall(circles.x[i], circles.velocity_x[i], extent, area.width);
        wall(circles.y[i], circles.velocity_y[i], extent, area.height);
    }
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        if (boxes.inverse_mass[i] == 0)
            continue;
        wall(boxes.x[i], boxes.velocity_x[i], to_units(boxes.half_width[i]), area.width);
        wall(boxes.y[i], boxes.velocity_y[i], to_units(boxes.half_height[i]), area.height);
    }
}

} // namespace

void bounce_off_walls(Circles& circles, Boxes& boxes, const Area& area, float restitution) {
    for_each_axis(circles, boxes, area, [&](Coordinate position, float& velocity, Coordinate extent, Coordinate size) {
        if ((position <= extent && velocity < 0) || (position >= size - extent && velocity > 0))
            velocity *= -restitution;
    });
}

void keep_inside(Circles& circles, Boxes& boxes, const Area& area, float restitution) {
    for_each_axis(circles, boxes, area, [&](Coordinate& position, float& velocity, Coordinate extent, Coordinate size) {
        if (position < extent) {
            position = extent;
            if (velocity < 0)
                velocity *= -restitution;
        } else if (position > size - extent) {
            position = size - extent;
            if (velocity > 0)
                velocity *= -restitution;
        }
    });
}

} // namespace evod::physics
