#include "server/physics/step.h"

#include "server/base/assert.h"
#include "server/base/instructions.h"

#include <algorithm>
#include <cmath>

namespace evod::physics {

extern const MotionKernels motion_kernels_baseline, motion_kernels_avx2, motion_kernels_avx512;

const MotionKernels& motion_kernels() {
    return base::chosen(motion_kernels_baseline, motion_kernels_avx2, motion_kernels_avx512);
}

namespace {

/// Reduces the speed to `limit`, px/s. Returns whether it was above the limit.
bool limit_speed(float& vx, float& vy, float limit) {
    const float square = vx * vx + vy * vy;
    if (square <= limit * limit) {
        return false;
    }
    const float share = limit / std::sqrt(square);
    vx *= share;
    vy *= share;
    return true;
}

/// Calls `wall` for each axis of each movable box, with its half side in units.
template <class Wall>
void for_each_axis(Boxes& boxes, const Area& area, Wall&& wall) {
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        if (boxes.inverse_mass[i] == 0) {
            continue;
        }
        wall(boxes.x[i], boxes.velocity_x[i], to_units(boxes.half_width[i]), area.width);
        wall(boxes.y[i], boxes.velocity_y[i], to_units(boxes.half_height[i]), area.height);
    }
}

} // namespace

StepCounts Stepper::step(Circles& circles, Boxes& boxes, const Area& area, const StepParameters& parameters,
                         const Forces& force, base::Executor& executor) {
    if (near_.stale(circles, boxes)) {
        near_.renew(circles, boxes, area, executor);
    }
    begin(circles, boxes, area, parameters);
    executor.parallel_for(block_count(circles.size()), blocks_per_piece(circles.size()), [&](base::Range blocks) {
        for (std::size_t block = blocks.begin; block < blocks.end; ++block) {
            accelerate(circles, block, {force.x + block * circles_per_block, force.y + block * circles_per_block});
        }
    });
    collide(circles, boxes, executor);
    executor.parallel_for(block_count(circles.size()), blocks_per_piece(circles.size()), [&](base::Range blocks) {
        for (std::size_t block = blocks.begin; block < blocks.end; ++block) {
            move(circles, block);
        }
    });
    return finish(boxes);
}

void Stepper::begin(Circles& circles, const Boxes& boxes, const Area& area, const StepParameters& parameters) {
    EVOD_ASSERT(parameters.integration.tick_s > 0);
    EVOD_ASSERT(parameters.integration.velocity_kept >= 0);
    EVOD_ASSERT(parameters.restitution >= 0);
    EVOD_ASSERT(parameters.max_speed_px_s > 0);
    EVOD_ASSERT(near_.anchor_x().size() == circles.x.size());
    parameters_ = parameters;
    area_ = area;
    rules_ = {.tick_s = parameters.integration.tick_s,
              .velocity_kept = parameters.integration.velocity_kept,
              .restitution = parameters.restitution,
              .max_speed = parameters.max_speed_px_s,
              .width = area.width,
              .height = area.height};
    if (is_explicit()) {
        drift_x_.resize(circles.x.size());
        drift_y_.resize(circles.x.size());
    }
    contacts_.begin(circles, boxes);
    counts_of_block_.assign(block_count(circles.size()), {});
}

MotionColumns Stepper::columns(Circles& circles) {
    return {.x = circles.x.data(),
            .y = circles.y.data(),
            .velocity_x = circles.velocity_x.data(),
            .velocity_y = circles.velocity_y.data(),
            .inverse_mass = circles.inverse_mass.data(),
            .radius = circles.radius.data(),
            .drift_x = is_explicit() ? drift_x_.data() : nullptr,
            .drift_y = is_explicit() ? drift_y_.data() : nullptr,
            .anchor_x = near_.anchor_x().data(),
            .anchor_y = near_.anchor_y().data()};
}

void Stepper::accelerate(Circles& circles, std::size_t block, const Forces& force) {
    EVOD_ASSERT(block < counts_of_block_.size());
    const base::Range range = circles_of_block(circles.size(), block);
    motion_kernels().accelerate(columns(circles), force, range.begin, range.end, rules_);
    contacts_.find_among_circles(circles, near_, block);
}

void Stepper::collide(Circles& circles, Boxes& boxes, base::Executor& executor) {
    box_drift_x_ = boxes.velocity_x;
    box_drift_y_ = boxes.velocity_y;
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        boxes.velocity_x[i] = physics::accelerate(parameters_.integration, boxes.velocity_x[i], 0);
        boxes.velocity_y[i] = physics::accelerate(parameters_.integration, boxes.velocity_y[i], 0);
        box_drift_x_[i] -= boxes.velocity_x[i];
        box_drift_y_[i] -= boxes.velocity_y[i];
    }
    for_each_axis(boxes, area_, [&](Coordinate position, float& velocity, Coordinate extent, Coordinate size) {
        if ((position <= extent && velocity < 0) || (position >= size - extent && velocity > 0)) {
            velocity *= -parameters_.restitution;
        }
    });
    contacts_.find_with_boxes(circles, boxes, near_);
    contacts_.resolve(circles, boxes, parameters_.restitution, executor);
}

void Stepper::move(Circles& circles, std::size_t block) {
    EVOD_ASSERT(block < counts_of_block_.size());
    const base::Range range = circles_of_block(circles.size(), block);
    counts_of_block_[block] = motion_kernels().move(columns(circles), range.begin, range.end, rules_);
}

StepCounts Stepper::finish(Boxes& boxes) {
    StepCounts counts;
    float displacement_square = 0;
    for (const MoveCounts& block : counts_of_block_) {
        counts.too_fast += block.too_fast;
        counts.speed_limited += block.speed_limited;
        displacement_square = std::max(displacement_square, block.displacement_square);
    }
    near_.set_displacement_square(displacement_square);

    const float limit = parameters_.max_speed_px_s, tick_s = rules_.tick_s;
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        float &vx = boxes.velocity_x[i], &vy = boxes.velocity_y[i];
        float moving_x = is_explicit() ? vx + box_drift_x_[i] : vx;
        float moving_y = is_explicit() ? vy + box_drift_y_[i] : vy;
        counts.speed_limited += limit_speed(vx, vy, limit);
        limit_speed(moving_x, moving_y, limit);
        const float shift_x = moving_x * tick_s, shift_y = moving_y * tick_s;
        boxes.x[i] += to_units(shift_x);
        boxes.y[i] += to_units(shift_y);
        const float extent = std::min(boxes.half_width[i], boxes.half_height[i]);
        counts.too_fast += shift_x * shift_x + shift_y * shift_y > extent * extent;
    }
    for_each_axis(boxes, area_, [&](Coordinate& position, float& velocity, Coordinate extent, Coordinate size) {
        if (position < extent || position > size - extent) {
            const bool below = position < extent;
            position = below ? extent : size - extent;
            if (below ? velocity < 0 : velocity > 0) {
                velocity *= -parameters_.restitution;
            }
        }
    });
    return counts;
}

} // namespace evod::physics
