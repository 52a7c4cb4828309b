#include "server/physics/broad_phase.h"

#include "server/base/assert.h"
#include "server/base/commutative.h"
#include "server/physics/shapes.h"

#include <cmath>

namespace evod::physics {
namespace {

constexpr std::size_t cells_per_block = 1024;

float greatest_radius(const Circles& circles) {
    float greatest[lanes_max] = {}; // one maximum per lane, so that no comparison waits for the previous one
    for (std::size_t i = 0; i < circles.radius.size(); i += lanes_max) {
        for (std::size_t lane = 0; lane < lanes_max; ++lane) {
            greatest[lane] = std::max(greatest[lane], circles.radius[i + lane]);
        }
    }
    return *std::max_element(greatest, greatest + lanes_max);
}

} // namespace

void Strips::choose_cells(std::size_t circles, const Area& area, float reach_px) {
    const double width = std::max(area.width, 1), height = std::max(area.height, 1);
    const double share = width * height / static_cast<double>(std::max<std::size_t>(circles, 1));
    // The reach is increased a little, to allow for rounding in later comparisons.
    const double reach = static_cast<double>(reach_px) * units_per_px * (1 + 1e-5) + 2;
    const double strip_height = std::max({reach, std::sqrt(share) / 2, 256.0});
    const double column_width = std::max(share / std::min(strip_height, height), 256.0);
    const auto cells = [](double size, double cell) { return static_cast<std::uint32_t>(size / cell) + 1; };
    const auto scale = [](double cell) { return static_cast<std::uint64_t>((std::uint64_t{1} << scale_bits) / cell); };
    strips_ = cells(height, strip_height);
    columns_ = cells(width, column_width);
    strip_scale_ = scale(strip_height);
    column_scale_ = scale(column_width);
}

template <bool parallel>
void Strips::count_and_place(const Circles& circles, base::Executor& executor) {
    const std::size_t grain = parallel ? 4 * circles_per_block : circles.size();
    executor.parallel_for(circles.size(), grain, [&](base::Range range) {
        for (std::size_t i = range.begin; i < range.end; ++i) {
            if (!circles.is_void(i)) {
                base::fetch_add<parallel>(first_[cell_of(circles, i)], 1u);
            }
        }
    });
    std::uint32_t end = 0;
    for (std::uint32_t& first : first_) {
        first = end += first;
    }
    order_.resize(end);
    executor.parallel_for(circles.size(), grain, [&](base::Range range) {
        for (std::size_t i = range.begin; i < range.end; ++i) {
            if (!circles.is_void(i)) {
                order_[base::fetch_add<parallel>(first_[cell_of(circles, i)], ~0u) - 1] = static_cast<std::uint32_t>(i);
            }
        }
    });
}

void Strips::sort(const Circles& circles, const Area& area, float reach_px, base::Executor& executor) {
    EVOD_ASSERT(reach_px >= 0);
    EVOD_ASSERT(area.width >= 0);
    EVOD_ASSERT(area.height >= 0);
    choose_cells(circles.size(), area, reach_px);
    first_.assign(std::size_t{strips_} * columns_ + 1, 0);
    if (executor.thread_count() > 1 && circles.size() > 128 * circles_per_block) {
        count_and_place<true>(circles, executor);
    } else {
        count_and_place<false>(circles, executor);
    }

    // Each cell is sorted separately. The result therefore does not depend on the order in which threads filled the
    // cell.
    const auto before = [&](std::uint32_t a, std::uint32_t b) {
        return circles.x[a] != circles.x[b] ? circles.x[a] < circles.x[b] : circles.id[a] < circles.id[b];
    };
    executor.parallel_for(first_.size() - 1, cells_per_block, [&](base::Range range) {
        for (std::size_t cell = range.begin; cell < range.end; ++cell) {
            if (first_[cell + 1] - first_[cell] > 1) {
                std::sort(order_.begin() + first_[cell], order_.begin() + first_[cell + 1], before);
            }
        }
    });
}

void Strips::follow_reordering() {
    for (std::uint32_t k = 0; k < order_.size(); ++k) {
        order_[k] = k;
    }
}

std::uint32_t Strips::strip_of_place(std::size_t k) const {
    EVOD_ASSERT(k < order_.size());
    std::uint32_t low = 0, high = strips_ - 1;
    while (low < high) {
        const std::uint32_t middle = low + (high - low) / 2;
        if (strip(middle).end <= k) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low;
}

bool NearPairs::stale(const Circles& circles, const Boxes& boxes) const {
    // Bodies may move a little less than half the skin, to allow for rounding of distances.
    const float allowed = skin_px_ / 2 - 0.01f;
    if (circles.size() != circle_count_ || boxes.size() != box_anchor_x_.size() || allowed <= 0 ||
        displacement_square_ > allowed * allowed) {
        return true;
    }
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        const float dx = distance_px(box_anchor_x_[i], boxes.x[i]), dy = distance_px(box_anchor_y_[i], boxes.y[i]);
        if (dx * dx + dy * dy > allowed * allowed) {
            return true;
        }
    }
    return false;
}

void NearPairs::sort(const Circles& circles, const Boxes& boxes, const Area& area, base::Executor& executor) {
    radius_max_ = greatest_radius(circles);
    // If circles are distributed evenly, about every second circle has one other circle within this skin. So few pairs
    // can be tested in each tick, and the list remains valid for about twenty ticks. A tick of 20,000 organisms takes
    // a tenth longer with half of this skin, and 4 % longer with twice as much.
    const double share_px2 =
        to_px(area.width) * to_px(area.height) / static_cast<double>(std::max<std::size_t>(circles.size(), 1));
    const auto reach = static_cast<float>(0.56 * std::sqrt(share_px2));
    skin_share_ = std::min(1.0f, skin_share_ * 1.1f); // a crowd may have dispersed since
    // Distances are exact up to this many px (bodies.h).
    constexpr float thickest_px = 4096;
    skin_px_ = std::min(std::max(skin_share_ * (reach - 2 * radius_max_), radius_max_ / 4 + 0.05f), thickest_px);
    strips_.sort(circles, area, 2 * radius_max_ + skin_px_, executor);
    anchor(circles, executor);
    box_anchor_x_ = boxes.x;
    box_anchor_y_ = boxes.y;
}

void NearPairs::anchor(const Circles& circles, base::Executor& executor) {
    anchor_x_.resize(circles.x.size());
    anchor_y_.resize(circles.x.size());
    executor.parallel_for(circles.x.size(), 8 * circles_per_block, [&](base::Range range) {
        std::copy(circles.x.begin() + range.begin, circles.x.begin() + range.end, anchor_x_.begin() + range.begin);
        std::copy(circles.y.begin() + range.begin, circles.y.begin() + range.end, anchor_y_.begin() + range.begin);
    });
    circle_count_ = circles.size();
    displacement_square_ = 0;
}

void NearPairs::follow_reordering(const Circles& circles, base::Executor& executor) {
    EVOD_ASSERT(circles.size() == strips_.order().size());
    strips_.follow_reordering();
    anchor(circles, executor);
}

void NearPairs::list(const Circles& circles, const Boxes& boxes, base::Executor& executor) {
    EVOD_ASSERT(circles.size() == circle_count_);
    EVOD_ASSERT(boxes.size() == box_anchor_x_.size());
    while (!try_list_circle_pairs(circles, executor)) {
        skin_px_ /= 2;
        skin_share_ /= 2;
    }
    list_box_pairs(circles, boxes);
}

void NearPairs::list_none(const Circles& circles) {
    pairs_of_block_.assign(block_count(circles.size()), {});
    circle_box_pairs_.clear();
    box_pairs_.clear();
}

bool NearPairs::try_list_circle_pairs(const Circles& circles, base::Executor& executor) {
    const std::span<const std::uint32_t> order = strips_.order();
    // More pairs than this mean that circles are crowded. A thinner skin is then faster, down to the distance that
    // bodies move in a tick or two.
    constexpr std::size_t pairs_max = 6 * circles_per_block;
    const bool thick = skin_px_ > radius_max_ / 4 + 0.1f;
    const auto window_max = static_cast<Coordinate>((2 * radius_max_ + skin_px_) * units_per_px) + 1;
    std::uint32_t crowded = 0;
    resize_lists(pairs_of_block_, block_count(circles.size()), circles_per_block * 3 / 4);
    for (std::size_t block = block_count(order.size()); block < pairs_of_block_.size(); ++block) {
        pairs_of_block_[block].clear();
    }
    executor.parallel_for(order.size(), circles_per_block * blocks_per_piece(order.size()), [&](base::Range range) {
        for (std::size_t begin = range.begin; begin < range.end; begin += circles_per_block) {
            std::vector<Pair>& pairs = pairs_of_block_[begin / circles_per_block];
            pairs.clear();
            const std::size_t end = std::min(begin + circles_per_block, range.end);
            std::uint32_t strip = strips_.strip_of_place(begin);
            std::size_t strip_end = strips_.strip(strip).end;
            // Places in the next strip: from the left end of the window to the end of the strip.
            std::size_t below = 0, below_end = 0;
            const auto enter_strip = [&](std::size_t k) {
                while (k >= strip_end) {
                    strip_end = strips_.strip(++strip).end;
                }
                const bool last = strip + 1 == strips_.strip_count();
                const std::int64_t left = std::int64_t{circles.x[order[k]]} - window_max;
                below = last ? 0 : strips_.place_of(strip + 1, left);
                below_end = last ? 0 : strips_.strip(strip + 1).end;
            };
            enter_strip(begin);
            for (std::size_t k = begin; k < end; ++k) {
                if (k >= strip_end) {
                    enter_strip(k);
                }
                const std::uint32_t i = order[k];
                const Coordinate x = circles.x[i], y = circles.y[i];
                const float own_reach = circles.radius[i] + skin_px_;
                const auto window = static_cast<Coordinate>((own_reach + radius_max_) * units_per_px) + 1;
                const auto test = [&](std::uint32_t j) {
                    const float dx = distance_px(x, circles.x[j]), dy = distance_px(y, circles.y[j]);
                    const float reach = own_reach + circles.radius[j];
                    if (dx * dx + dy * dy <= reach * reach) {
                        pairs.push_back({i, j});
                    }
                };
                for (std::size_t m = k + 1; m < strip_end && circles.x[order[m]] - x <= window; ++m) {
                    test(order[m]);
                }
                while (below < below_end && circles.x[order[below]] < x - window_max) {
                    ++below;
                }
                for (std::size_t m = below; m < below_end && circles.x[order[m]] - x <= window; ++m) {
                    test(order[m]);
                }
                if (thick && pairs.size() > pairs_max) {
                    base::put<true>(crowded, 1u);
                    return;
                }
            }
        }
    });
    return crowded == 0;
}

void NearPairs::list_box_pairs(const Circles& circles, const Boxes& boxes) {
    circle_box_pairs_.clear();
    box_pairs_.clear();
    circle_box_pairs_.reserve(32 * boxes.size());
    box_pairs_.reserve(8 * boxes.size());
    for (std::uint32_t box = 0; box < boxes.size(); ++box) {
        const BoxShape shape{boxes.half_width[box], boxes.half_height[box]};
        const auto reach = [&](float half) {
            return static_cast<std::int64_t>((half + radius_max_ + skin_px_) * units_per_px) + 1;
        };
        const std::int64_t x = boxes.x[box], y = boxes.y[box], reach_x = reach(shape.half_width),
                           reach_y = reach(shape.half_height);
        strips_.for_each_stretch(x - reach_x, x + reach_x, y - reach_y, y + reach_y, [&](Strips::Stretch stretch) {
            const base::Range places = strips_.places(stretch);
            for (std::size_t k = places.begin; k < places.end; ++k) {
                const std::uint32_t circle = strips_.order()[k];
                if (box_circle(distance_px(boxes.x[box], circles.x[circle]),
                               distance_px(boxes.y[box], circles.y[circle]), shape, circles.radius[circle] + skin_px_)
                        .touching) {
                    circle_box_pairs_.push_back({circle, box});
                }
            }
        });
    }

    // Sort and sweep along x: a box can only touch the following boxes that begin before it ends.
    if (boxes.size() < 2) {
        return;
    }
    const auto left = [&](std::uint32_t i) { return distance_px(0, boxes.x[i]) - boxes.half_width[i]; };
    boxes_by_left_.resize(boxes.size());
    for (std::uint32_t i = 0; i < boxes.size(); ++i) {
        boxes_by_left_[i] = i;
    }
    std::sort(boxes_by_left_.begin(), boxes_by_left_.end(),
              [&](std::uint32_t a, std::uint32_t b) { return left(a) != left(b) ? left(a) < left(b) : a < b; });
    for (std::size_t i = 0; i < boxes_by_left_.size(); ++i) {
        const std::uint32_t a = boxes_by_left_[i];
        // One pixel is added, because far from 0 a float of an absolute position has an error of several hundredths of
        // a pixel.
        const float right = distance_px(0, boxes.x[a]) + boxes.half_width[a] + skin_px_ + 1;
        for (std::size_t j = i + 1; j < boxes_by_left_.size() && left(boxes_by_left_[j]) <= right; ++j) {
            const std::uint32_t b = boxes_by_left_[j];
            if (boxes.inverse_mass[a] + boxes.inverse_mass[b] > 0 &&
                box_box(distance_px(boxes.x[a], boxes.x[b]), distance_px(boxes.y[a], boxes.y[b]),
                        {boxes.half_width[a] + skin_px_, boxes.half_height[a] + skin_px_},
                        {boxes.half_width[b], boxes.half_height[b]})
                    .touching) {
                box_pairs_.push_back({std::min(a, b), std::max(a, b)});
            }
        }
    }
}

} // namespace evod::physics
