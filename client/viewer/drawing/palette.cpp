#include "client/viewer/drawing/palette.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace evod::viewer::palette {

namespace {

using Stops = std::array<Colour, 18>;

constexpr Stops viridis{{{68, 1, 84},
                         {72, 23, 105},
                         {71, 42, 122},
                         {67, 61, 132},
                         {61, 78, 138},
                         {53, 94, 141},
                         {46, 109, 142},
                         {41, 123, 142},
                         {35, 137, 142},
                         {31, 151, 139},
                         {33, 165, 133},
                         {46, 179, 124},
                         {70, 192, 111},
                         {101, 203, 94},
                         {137, 213, 72},
                         {176, 221, 47},
                         {216, 226, 25},
                         {253, 231, 37}}};
constexpr Stops cividis{{{0, 34, 78},
                         {0, 45, 104},
                         {22, 55, 112},
                         {46, 65, 109},
                         {63, 76, 108},
                         {78, 86, 108},
                         {92, 97, 110},
                         {105, 107, 113},
                         {118, 118, 118},
                         {131, 129, 121},
                         {146, 140, 120},
                         {160, 152, 117},
                         {175, 164, 113},
                         {191, 176, 107},
                         {207, 189, 98},
                         {223, 202, 87},
                         {240, 216, 70},
                         {254, 232, 56}}};

std::uint8_t between(std::uint8_t from, std::uint8_t to, double share) {
    return static_cast<std::uint8_t>(std::lround(from + (to - from) * share));
}

} // namespace

std::string_view name_of(Ramp ramp) {
    return ramp == Ramp::Viridis ? "viridis" : "cividis";
}

Colour at(Ramp ramp, double share) {
    if (std::isnan(share)) {
        return unknown;
    }
    const Stops& stops = ramp == Ramp::Viridis ? viridis : cividis;
    const double place = std::clamp(share, 0.0, 1.0) * static_cast<double>(stops.size() - 1);
    const auto before = std::min(static_cast<std::size_t>(place), stops.size() - 2);
    const Colour from = stops[before], to = stops[before + 1];
    const double beyond = place - static_cast<double>(before);
    return {between(from.red, to.red, beyond), between(from.green, to.green, beyond),
            between(from.blue, to.blue, beyond)};
}

Colour text_on(Colour paper) {
    const double opaque = paper.alpha / 255.0;
    const double light = (0.299 * paper.red + 0.587 * paper.green + 0.114 * paper.blue) * opaque + 240 * (1 - opaque);
    return light > 140 ? text : note_text;
}

} // namespace evod::viewer::palette
