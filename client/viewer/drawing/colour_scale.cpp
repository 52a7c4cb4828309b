#include "client/viewer/drawing/colour_scale.h"

#include "client/viewer/drawing/ink.h"

#include <algorithm>

namespace evod::viewer {

void draw_ramp(ImDrawList& list, ImVec2 corner, ImVec2 size, palette::Ramp ramp) {
    for (float x = 0; x < size.x; ++x) {
        list.AddRectFilled({corner.x + x, corner.y}, {corner.x + std::min(x + 1, size.x), corner.y + size.y},
                           ink(palette::at(ramp, (x + 0.5) / size.x)));
    }
}

} // namespace evod::viewer
