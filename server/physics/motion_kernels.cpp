// This file is a kernel: it is compiled once for each instruction set. base/lanes.h describes what it may include.
#include "server/physics/motion_kernels.h"

#include "server/base/lanes.h"
#include "server/physics/units.h"

namespace evod::physics {
namespace {

using namespace evod::base; // the vector types of lanes.h

Floats accelerated(Floats velocity, Floats force, Floats inverse_mass, const MotionRules& rules) {
    return (velocity + force * inverse_mass * rules.tick_s) * rules.velocity_kept;
}

Floats bounced(Integers position, Floats velocity, Integers extent, std::int32_t size, const MotionRules& rules) {
    const Integers outward =
        ((position <= extent) & (velocity < 0.0f)) | ((position >= size - extent) & (velocity > 0.0f));
    return outward ? velocity * -rules.restitution : velocity;
}

void accelerate(const MotionColumns& columns, const Forces& force, std::size_t begin, std::size_t end,
                const MotionRules& rules) {
    for (std::size_t i = begin; i < end; i += lanes) {
        prefetch_ahead(i, columns.inverse_mass);
        const Floats inverse_mass = load<Floats>(columns.inverse_mass + i);
        const Floats old_x = load<Floats>(columns.velocity_x + i), old_y = load<Floats>(columns.velocity_y + i);
        const Floats vx = accelerated(old_x, load<Floats>(force.x + (i - begin)), inverse_mass, rules);
        const Floats vy = accelerated(old_y, load<Floats>(force.y + (i - begin)), inverse_mass, rules);
        if (columns.drift_x != nullptr) {
            store(columns.drift_x + i, old_x - vx);
            store(columns.drift_y + i, old_y - vy);
        }
        const Integers extent = round_to_integers(load<Floats>(columns.radius + i) * static_cast<float>(units_per_px));
        store(columns.velocity_x + i, bounced(load<Integers>(columns.x + i), vx, extent, rules.width, rules));
        store(columns.velocity_y + i, bounced(load<Integers>(columns.y + i), vy, extent, rules.height, rules));
    }
}

/// Reduces the speed to the limit in the lanes that `over` selects.
void limit(Floats& vx, Floats& vy, Floats square, Integers over, float limit) {
    const Floats share = limit / square_root(square);
    vx = over ? vx * share : vx;
    vy = over ? vy * share : vy;
}

struct Axis {
    Integers position;
    Floats velocity;
};

Axis kept_inside(Axis axis, Integers extent, std::int32_t size, Integers movable, const MotionRules& rules) {
    const Integers most = size - extent;
    const Integers below = (axis.position < extent) & movable, above = (axis.position > most) & ~below & movable;
    const Integers outward = (below & (axis.velocity < 0.0f)) | (above & (axis.velocity > 0.0f));
    axis.position = below ? extent : axis.position;
    axis.position = above ? most : axis.position;
    axis.velocity = outward ? axis.velocity * -rules.restitution : axis.velocity;
    return axis;
}

MoveCounts move(const MotionColumns& columns, std::size_t begin, std::size_t end, const MotionRules& rules) {
    MoveCounts counts;
    Floats displacement{};
    const float limit_square = rules.max_speed * rules.max_speed;
    for (std::size_t i = begin; i < end; i += lanes) {
        prefetch_ahead(i, columns.x, columns.y, columns.velocity_x, columns.velocity_y, columns.radius,
                       columns.anchor_x, columns.anchor_y);
        Floats vx = load<Floats>(columns.velocity_x + i), vy = load<Floats>(columns.velocity_y + i);
        Floats moving_x = vx, moving_y = vy;
        if (columns.drift_x != nullptr) {
            moving_x += load<Floats>(columns.drift_x + i);
            moving_y += load<Floats>(columns.drift_y + i);
            const Floats square = moving_x * moving_x + moving_y * moving_y;
            if (const Integers over = square > limit_square; bits_of(over) != 0) {
                limit(moving_x, moving_y, square, over, rules.max_speed);
            }
        }
        const Floats square = vx * vx + vy * vy;
        if (const Integers over = square > limit_square; bits_of(over) != 0) {
            counts.speed_limited += static_cast<unsigned>(__builtin_popcount(bits_of(over)));
            limit(vx, vy, square, over, rules.max_speed);
            if (columns.drift_x == nullptr) {
                moving_x = vx;
                moving_y = vy;
            }
        }
        const Floats shift_x = moving_x * rules.tick_s, shift_y = moving_y * rules.tick_s;
        const Floats radius = load<Floats>(columns.radius + i);
        if (const unsigned too_fast = bits_of(shift_x * shift_x + shift_y * shift_y > radius * radius); too_fast != 0) {
            counts.too_fast += static_cast<unsigned>(__builtin_popcount(too_fast));
        }

        const Integers old_x = load<Integers>(columns.x + i);
        const Integers movable = old_x != void_position;
        const Integers extent = round_to_integers(radius * static_cast<float>(units_per_px));
        const Axis x = kept_inside({old_x + round_to_integers(shift_x * static_cast<float>(units_per_px)), vx}, extent,
                                   rules.width, movable, rules);
        const Axis y = kept_inside(
            {load<Integers>(columns.y + i) + round_to_integers(shift_y * static_cast<float>(units_per_px)), vy}, extent,
            rules.height, movable, rules);
        store(columns.x + i, x.position);
        store(columns.y + i, y.position);
        store(columns.velocity_x + i, x.velocity);
        store(columns.velocity_y + i, y.velocity);
        const Floats away_x = to_floats(x.position - load<Integers>(columns.anchor_x + i)) * px_per_unit;
        const Floats away_y = to_floats(y.position - load<Integers>(columns.anchor_y + i)) * px_per_unit;
        displacement = greater(displacement, away_x * away_x + away_y * away_y);
    }
    for (std::size_t lane = 0; lane < lanes; ++lane) {
        counts.displacement_square =
            displacement[lane] > counts.displacement_square ? displacement[lane] : counts.displacement_square;
    }
    return counts;
}

} // namespace

extern const MotionKernels EVOD_KERNEL(motion_kernels);
const MotionKernels EVOD_KERNEL(motion_kernels) = {accelerate, move};

} // namespace evod::physics
