#include "client/viewer/panels/breeding/sheet.h"

namespace evod::viewer {

void Sheet::write(ImVec2 place, Colour colour, std::string_view text) const {
    viewer::write(list, font, place, colour, text);
}

void Sheet::write_centred(ImVec2 centre, Colour colour, std::string_view text) const {
    viewer::write_centred(list, font, centre, colour, text);
}

void Sheet::write_to_the_left(ImVec2 right, Colour colour, std::string_view text) const {
    viewer::write_to_the_left(list, font, right, colour, text);
}

Colour text_on(Colour paper) {
    const double opaque = paper.alpha / 255.0;
    const double light = (0.299 * paper.red + 0.587 * paper.green + 0.114 * paper.blue) * opaque + 240 * (1 - opaque);
    return light > 140 ? palette::text : palette::note_text;
}

bool pointed_at(ImVec2 corner, ImVec2 end) {
    return ImGui::IsWindowHovered(ImGuiHoveredFlags_ChildWindows) && ImGui::IsMouseHoveringRect(corner, end);
}

} // namespace evod::viewer
