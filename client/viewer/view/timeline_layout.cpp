#include "client/viewer/view/timeline_layout.h"

#include "client/viewer/text/numbers.h"

#include <algorithm>
#include <cmath>

namespace evod::viewer {

double TimeScale::x_of(std::uint64_t tick) const {
    if (last_tick <= first_tick) {
        return left;
    }
    const auto ticks = static_cast<double>(std::clamp(tick, first_tick, last_tick) - first_tick);
    return left + width * ticks / static_cast<double>(last_tick - first_tick);
}

std::uint64_t TimeScale::tick_at(double x) const {
    const double part = std::clamp((x - left) / std::max(width, 1.0), 0.0, 1.0);
    return first_tick + static_cast<std::uint64_t>(std::round(part * static_cast<double>(last_tick - first_tick)));
}

std::vector<std::uint64_t> marked_generations(std::uint64_t first, std::uint64_t last, std::size_t count_max) {
    std::vector<std::uint64_t> marked;
    if (count_max == 0 || last < first) {
        return marked;
    }
    const auto count = [&](std::uint64_t step) {
        return last / step - (first - std::min<std::uint64_t>(first, 1)) / step;
    };
    std::uint64_t step = 1;
    while (count(step) > count_max) {
        step = static_cast<std::uint64_t>(nice_step(1.5 * static_cast<double>(step)));
    }
    for (std::uint64_t generation = (first + step - 1) / step * step; generation <= last; generation += step) {
        marked.push_back(generation);
    }
    return marked;
}

std::vector<std::size_t> separate_labels(std::span<const Label> labels, double gap) {
    std::vector<std::size_t> drawn;
    for (std::size_t i = 0; i < labels.size(); ++i) {
        if (drawn.empty() || labels[i].left >= labels[drawn.back()].left + labels[drawn.back()].width + gap) {
            drawn.push_back(i);
        }
    }
    return drawn;
}

} // namespace evod::viewer
