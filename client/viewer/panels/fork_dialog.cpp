#include "client/viewer/panels/fork_dialog.h"

#include "client/viewer/drawing/widgets.h"

#include <imgui.h>

namespace evod::viewer {

void ForkDialog::build(ViewedWorld& world) {
    const bool may = world.server.may_create();
    ImGui::BeginDisabled(!may);
    if (widgets::button("Fork …")) {
        ImGui::OpenPopup("fork");
    }
    ImGui::EndDisabled();
    widgets::explain(may ? "Creates a world that starts from the tick shown."
                         : "Only the role admin may create worlds.");
    const ImVec2 below{ImGui::GetWindowPos().x + ImGui::GetWindowWidth(),
                       ImGui::GetItemRectMax().y + ImGui::GetStyle().ItemSpacing.y};
    ImGui::SetNextWindowPos(below, ImGuiCond_Always, {1, 0});
    if (!ImGui::BeginPopup("fork")) {
        return;
    }
    ImGui::TextUnformatted("Create a world that starts from the tick shown. Name of the new world:");
    if (ImGui::IsWindowAppearing()) {
        ImGui::SetKeyboardFocusHere();
    }
    const bool entered = ImGui::InputText("##name", name_.data(), name_.size(), ImGuiInputTextFlags_EnterReturnsTrue);
    widgets::mark_field("Name of the new world", name_.data());
    ImGui::SameLine();
    const bool named = name_[0] != '\0';
    ImGui::BeginDisabled(!named);
    if ((widgets::button("Fork") || entered) && named) {
        world.replay.fork(name_.data());
        ImGui::CloseCurrentPopup();
    }
    ImGui::EndDisabled();
    ImGui::EndPopup();
}

} // namespace evod::viewer
