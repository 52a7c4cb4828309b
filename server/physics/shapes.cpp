#include "server/physics/shapes.h"

#include "server/base/assert.h"

#include <algorithm>
#include <cmath>

namespace evod::physics {

Overlap circle_circle(float dx, float dy, float first_radius, float second_radius) {
    EVOD_ASSERT(first_radius >= 0);
    EVOD_ASSERT(second_radius >= 0);
    const float reach = first_radius + second_radius;
    const float square = dx * dx + dy * dy;
    if (square > reach * reach) {
        return {};
    }
    const float distance = std::sqrt(square);
    if (distance == 0) {
        return {true, reach, 1, 0};
    }
    return {true, std::max(reach - distance, 0.0f), dx / distance, dy / distance};
}

Overlap box_box(float dx, float dy, BoxShape first, BoxShape second) {
    const float overlap_x = first.half_width + second.half_width - std::abs(dx);
    const float overlap_y = first.half_height + second.half_height - std::abs(dy);
    if (overlap_x < 0 || overlap_y < 0) {
        return {};
    }
    if (overlap_x <= overlap_y) {
        return {true, overlap_x, dx < 0 ? -1.0f : 1.0f, 0};
    }
    return {true, overlap_y, 0, dy < 0 ? -1.0f : 1.0f};
}

Overlap box_circle(float dx, float dy, BoxShape box, float radius) {
    EVOD_ASSERT(box.half_width >= 0);
    EVOD_ASSERT(box.half_height >= 0);
    EVOD_ASSERT(radius >= 0);
    const float nearest_x = std::clamp(dx, -box.half_width, box.half_width);
    const float nearest_y = std::clamp(dy, -box.half_height, box.half_height);
    const float out_x = dx - nearest_x, out_y = dy - nearest_y;
    const float square = out_x * out_x + out_y * out_y;
    if (square > radius * radius) {
        return {};
    }
    const float distance = std::sqrt(square);
    if (distance > 0) {
        return {true, std::max(radius - distance, 0.0f), out_x / distance, out_y / distance};
    }
    const float inside_x = box.half_width - std::abs(dx), inside_y = box.half_height - std::abs(dy);
    if (inside_x <= inside_y) {
        return {true, inside_x + radius, dx < 0 ? -1.0f : 1.0f, 0};
    }
    return {true, inside_y + radius, 0, dy < 0 ? -1.0f : 1.0f};
}

} // namespace evod::physics
