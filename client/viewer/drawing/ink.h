// Ink: draws text on a draw list of Dear ImGui and converts colours for it.
//
// Owner        none: functions.
// Threads      none; called on the drawing thread.
#pragma once

#include "client/viewer/drawing/palette.h"

#include <imgui.h>

#include <string_view>

namespace evod::viewer {

constexpr ImU32 ink(Colour colour) {
    return IM_COL32(colour.red, colour.green, colour.blue, colour.alpha);
}

constexpr Colour faint(Colour colour, std::uint8_t alpha) {
    colour.alpha = alpha;
    return colour;
}

/// wrap_width  maximum line width in pixels; 0: lines end only at the line breaks of the text
ImVec2 size_of(std::string_view text, const ImFont& font, float wrap_width = 0);

/// Draws text. Rounds the upper left corner down to whole pixels, which keeps letters sharp. Returns the x coordinate
/// of the end of the text.
float write(ImDrawList& list, const ImFont& font, ImVec2 place, Colour colour, std::string_view text,
            float wrap_width = 0);
void write_to_the_left(ImDrawList& list, const ImFont& font, ImVec2 right, Colour colour, std::string_view text);

} // namespace evod::viewer
