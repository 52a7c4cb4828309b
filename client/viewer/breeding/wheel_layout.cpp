#include "client/viewer/breeding/wheel_layout.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace evod::viewer {

std::vector<Arc> wheel_arcs(const Contenders& contenders, double circumference_px) {
    const double pixel = 1 / circumference_px;
    std::vector<Arc> arcs;
    bool open = false; // the last arc is still narrower than a pixel
    for (int i = 0; i < contenders.size(); ++i) {
        const evod::v1::Contender& contender = contenders[i];
        const double width = contender.slot_end() - contender.slot_begin();
        if (width <= 0) {
            continue;
        }
        const auto organism = static_cast<std::uint32_t>(i);
        if (open && width < pixel) {
            Arc& arc = arcs.back();
            const double before = arc.end - arc.begin;
            arc.rank = (arc.rank * before + contender.rank() * width) / (before + width);
            arc.end = contender.slot_end();
            arc.last = organism;
        } else {
            arcs.push_back(
                {contender.slot_begin(), contender.slot_end(), organism, organism, double(contender.rank())});
        }
        open = width < pixel && arcs.back().end - arcs.back().begin < pixel;
    }
    return arcs;
}

const evod::v1::Contender* slot_at(const Contenders& contenders, double turns) {
    const auto slot = std::ranges::upper_bound(contenders, turns, {}, &evod::v1::Contender::slot_end);
    return slot == contenders.end() ? nullptr : &*slot;
}

Colour rank_colour(double rank, std::uint32_t contender_count) {
    static constexpr std::array<Colour, 6> scale{
        {{253, 231, 55}, {203, 186, 105}, {151, 145, 119}, {107, 108, 112}, {49, 68, 107}, {0, 34, 78}}};
    const double place =
        contender_count < 2 ? 0 : std::clamp(rank / (contender_count - 1), 0.0, 1.0) * (scale.size() - 1);
    const auto below = std::min(static_cast<std::size_t>(place), scale.size() - 2);
    const double share = place - static_cast<double>(below);
    const auto mix = [share](std::uint8_t a, std::uint8_t b) {
        return static_cast<std::uint8_t>(std::lround(a + (b - a) * share));
    };
    const Colour &a = scale[below], &b = scale[below + 1];
    return {mix(a.red, b.red), mix(a.green, b.green), mix(a.blue, b.blue)};
}

} // namespace evod::viewer
