// Sheet: a rectangle of the window that one of the glass box's pictures fills.
//
// Threads      none; used by the thread that draws.
#pragma once

#include "client/viewer/drawing/ink.h"

#include <string_view>

namespace evod::viewer {

struct Sheet {
    ImDrawList& list;
    ImFont& font;
    ImVec2 corner, size; // pixels
    ImVec2 end() const { return {corner.x + size.x, corner.y + size.y}; }
    float line_height() const { return font.FontSize + 4; }

    void write(ImVec2 place, Colour colour, std::string_view text) const;
    void write_centred(ImVec2 centre, Colour colour, std::string_view text) const;
    void write_to_the_left(ImVec2 right, Colour colour, std::string_view text) const;
};

/// Black or white, whichever can be read on it; what can be seen through is on light paper.
Colour text_on(Colour paper);

/// Whether the mouse is on a part of the window that is built.
bool pointed_at(ImVec2 corner, ImVec2 end);

} // namespace evod::viewer
