// Sheet: a rectangle of the panel's window for one drawing of the glass box.
//
// Owner        the function that draws; a Sheet lives for one frame.
// Threads      none; used on the drawing thread.
#pragma once

#include "client/viewer/drawing/ink.h"

#include <string_view>

namespace evod::viewer {

struct Sheet {
    ImDrawList& list;
    ImFont& font;
    ImVec2 corner, size; // upper left corner and size in pixels
    ImVec2 end() const { return {corner.x + size.x, corner.y + size.y}; }
    float line_height() const { return font.FontSize + 4; }

    void write(ImVec2 place, Colour colour, std::string_view text) const;
    void write_centred(ImVec2 centre, Colour colour, std::string_view text, float scale = 1) const;
    void write_to_the_left(ImVec2 right, Colour colour, std::string_view text) const;
};

/// Returns whether the mouse is inside this rectangle of the current window.
bool pointed_at(ImVec2 corner, ImVec2 end);

} // namespace evod::viewer
