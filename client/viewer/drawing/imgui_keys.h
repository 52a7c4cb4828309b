// Keys for Dear ImGui, in a form for all supported versions. Since 1.89 Dear ImGui receives key events. Version 1.86 of
// Debian 12 reads arrays, which the program indexes with numbers of its own: here, with the values of ImGuiKey.
//
// Threads      none; used on the drawing thread.
#pragma once

#include <imgui.h>

namespace evod::viewer {

/// Prepares the keys of a new context.
inline void prepare_keys() {
    ImGuiIO& io = ImGui::GetIO();
#if IMGUI_VERSION_NUM >= 18900
    io.ConfigInputTrickleEventQueue = false; // Gui distributes events over frames
#else
    for (int key = 0; key < ImGuiKey_COUNT; ++key) {
        io.KeyMap[key] = key;
    }
#endif
}

/// Informs Dear ImGui that a key is pressed or released. To be called at most once per key and frame.
inline void set_key(ImGuiKey key, bool down) {
#if IMGUI_VERSION_NUM >= 18900
    ImGui::GetIO().AddKeyEvent(key, down);
#else
    ImGui::GetIO().KeysDown[key] = down;
#endif
}

/// Informs Dear ImGui which modifier keys are held.
inline void set_modifiers(bool control, bool shift, bool alt, bool super) {
    ImGuiIO& io = ImGui::GetIO();
#if IMGUI_VERSION_NUM >= 18900
    io.AddKeyEvent(ImGuiMod_Ctrl, control);
    io.AddKeyEvent(ImGuiMod_Shift, shift);
    io.AddKeyEvent(ImGuiMod_Alt, alt);
    io.AddKeyEvent(ImGuiMod_Super, super);
#else
    io.KeyCtrl = control;
    io.KeyShift = shift;
    io.KeyAlt = alt;
    io.KeySuper = super;
#endif
}

} // namespace evod::viewer
