#include "client/viewer/panels/breeding/wheel_layout.h"

#include <algorithm>

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
    return palette::at(palette::Ramp::Cividis, contender_count < 2 ? 1 : 1 - rank / (contender_count - 1));
}

} // namespace evod::viewer
