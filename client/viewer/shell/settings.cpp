#include "client/viewer/shell/settings.h"

#include <imgui.h>
#include <imgui_internal.h> // ImGuiSettingsHandler

#include <cstdlib>
#include <string_view>
#include <system_error>
#include <utility>

namespace evod::viewer {

namespace {

constexpr const char* section = "Sidebar";
constexpr float width_max = 4000; // pixels; a larger number in the file is not a width

/// Reads one line of the section into the settings. Ignores lines that it does not know.
void read_line(SidebarSettings& settings, std::string_view line) {
    const std::size_t equals = line.find('=');
    if (equals == std::string_view::npos) {
        return;
    }
    const std::string name{line.substr(0, equals)}, value{line.substr(equals + 1)};
    if (name == "width") {
        const float width = std::strtof(value.c_str(), nullptr);
        settings.width = width >= sidebar_width_min && width <= width_max ? width : settings.width;
    } else if (name == "collapsed") {
        settings.collapsed = value == "1";
    } else if (name == "tab") {
        settings.tab = value;
    } else if (name == "tour_seen") {
        settings.tour_seen = value == "1";
    }
}

Panels& panels_of(const ImGuiSettingsHandler* handler) {
    return *static_cast<Panels*>(handler->UserData);
}

} // namespace

std::optional<std::filesystem::path> in_state_folder(const char* name) {
    const auto from = [](const char* variable) -> std::filesystem::path {
        const char* value = std::getenv(variable);
        return value == nullptr ? "" : value;
    };
    if (const auto state = from("XDG_STATE_HOME");
        state.is_absolute()) { // the XDG specification requires that relative paths are ignored
        return state / "evod" / name;
    }
    if (const auto home = from("HOME"); !home.empty()) {
        return home / ".local" / "state" / "evod" / name;
    }
    return std::nullopt;
}

Settings::Settings(std::optional<std::filesystem::path> file, Panels& panels)
    : file_{std::move(file)}, panels_{panels} {
    if (!file_) {
        return;
    }
    ImGuiSettingsHandler handler;
    handler.TypeName = section;
    handler.TypeHash = ImHashStr(section);
    handler.UserData = &panels_;
    handler.ReadOpenFn = [](ImGuiContext*, ImGuiSettingsHandler* self, const char*) -> void* { return self->UserData; };
    handler.ReadLineFn = [](ImGuiContext*, ImGuiSettingsHandler* self, void*, const char* line) {
        SidebarSettings settings = panels_of(self).settings();
        read_line(settings, line);
        panels_of(self).set(std::move(settings));
    };
    handler.WriteAllFn = [](ImGuiContext*, ImGuiSettingsHandler* self, ImGuiTextBuffer* out) {
        const SidebarSettings& settings = panels_of(self).settings();
        out->appendf("[%s][Data]\nwidth=%.0f\ncollapsed=%d\ntab=%s\ntour_seen=%d\n\n", section, double{settings.width},
                     settings.collapsed ? 1 : 0, settings.tab.c_str(), settings.tour_seen ? 1 : 0);
    };
    ImGui::GetCurrentContext()->SettingsHandlers.push_back(handler);
    ImGui::LoadIniSettingsFromDisk(file_->c_str());
}

Settings::~Settings() {
    if (!file_) {
        return;
    }
    std::error_code error;
    std::filesystem::create_directories(file_->parent_path(), error);
    ImGui::SaveIniSettingsToDisk(file_->c_str());
    ImGui::GetCurrentContext()->SettingsHandlers.pop_back();
}

} // namespace evod::viewer
