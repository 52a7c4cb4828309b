#include "client/viewer/drawing/ink.h"

#include <cmath>

namespace evod::viewer {

ImVec2 size_of(std::string_view text, const ImFont& font, float wrap_width) {
    return font.CalcTextSizeA(font.FontSize, 1e9f, wrap_width, text.data(), text.data() + text.size());
}

float write(ImDrawList& list, const ImFont& font, ImVec2 place, Colour colour, std::string_view text,
            float wrap_width) {
    place = {std::floor(place.x), std::floor(place.y)};
    list.AddText(&font, font.FontSize, place, ink(colour), text.data(), text.data() + text.size(), wrap_width);
    return place.x + size_of(text, font, wrap_width).x;
}

void write_to_the_left(ImDrawList& list, const ImFont& font, ImVec2 right, Colour colour, std::string_view text) {
    write(list, font, {right.x - size_of(text, font).x, right.y}, colour, text);
}

} // namespace evod::viewer
