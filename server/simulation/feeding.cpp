#include "server/simulation/feeding.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace evod::simulation {

const std::vector<Meal>& Feeding::meals(const physics::Circles& bodies, const Items& items, const Sight& sight,
                                        const std::vector<float>& seen_distance, base::Executor& executor) {
    constexpr std::size_t bodies_per_block = 1024;
    constexpr float margin_px = 0.05f; // far more than the rounding of any distance here
    const std::size_t n = bodies.size();
    touches_of_block_.resize((n + bodies_per_block - 1) / bodies_per_block);
    executor.parallel_for(n, bodies_per_block, [&](base::Range range) {
        for (std::size_t begin = range.begin; begin < range.end; begin += bodies_per_block) {
            std::vector<Touch>& touches = touches_of_block_[begin / bodies_per_block];
            touches.clear();
            for (std::size_t i = begin; i < std::min(begin + bodies_per_block, range.end); ++i) {
                const float reach = bodies.radius[i] + items.radius_px();
                // Items rest: what was further away than the reach and the way since cannot be touched.
                const float way_x = physics::distance_px(sight.x[i], bodies.x[i]);
                const float way_y = physics::distance_px(sight.y[i], bodies.y[i]);
                if (seen_distance[i] > reach + std::sqrt(way_x * way_x + way_y * way_y) + margin_px)
                    continue;
                items.for_each_within(bodies.x[i], bodies.y[i], reach, [&](std::uint32_t item, float square) {
                    touches.push_back({item, square, bodies.id[i], static_cast<std::uint32_t>(i)});
                });
            }
        }
    });

    touches_.clear();
    for (const std::vector<Touch>& touches : touches_of_block_)
        touches_.insert(touches_.end(), touches.begin(), touches.end());
    std::sort(touches_.begin(), touches_.end(), [](const Touch& a, const Touch& b) {
        return std::tie(a.item, a.square, a.id) < std::tie(b.item, b.square, b.id);
    });
    meals_.clear();
    for (const Touch& touch : touches_)
        if (meals_.empty() || meals_.back().item != touch.item)
            meals_.push_back({touch.item, touch.body});
    return meals_;
}

} // namespace evod::simulation
