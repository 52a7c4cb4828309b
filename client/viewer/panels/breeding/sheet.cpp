#include "client/viewer/panels/breeding/sheet.h"

namespace evod::viewer {

void Sheet::write(ImVec2 place, Colour colour, std::string_view text) const {
    viewer::write(list, font, place, colour, text);
}

void Sheet::write_centred(ImVec2 centre, Colour colour, std::string_view text, float scale) const {
    viewer::write_centred(list, font, centre, colour, text, scale);
}

void Sheet::write_to_the_left(ImVec2 right, Colour colour, std::string_view text) const {
    viewer::write_to_the_left(list, font, right, colour, text);
}

bool pointed_at(ImVec2 corner, ImVec2 end) {
    return ImGui::IsWindowHovered(ImGuiHoveredFlags_ChildWindows) && ImGui::IsMouseHoveringRect(corner, end);
}

} // namespace evod::viewer
