#include "client/viewer/shell/settings.h"

#include "client/viewer/world/user_folder.h"

#include <imgui.h>
#include <imgui_internal.h> // ImGuiSettingsHandler

#include <algorithm>
#include <array>
#include <cstdlib>
#include <iterator>
#include <string_view>
#include <system_error>
#include <utility>

namespace evod::viewer {

namespace {

constexpr float width_max = 4000; // pixels; a larger number in the file is not a width

/// A line "name=value". Both are empty if the line has no equals sign.
struct Field {
    explicit Field(std::string_view line) {
        if (const std::size_t equals = line.find('='); equals != std::string_view::npos) {
            name = line.substr(0, equals);
            value = line.substr(equals + 1);
        }
    }
    std::string name, value;
};

/// Reads one line of the section into the settings. Ignores lines that it does not know.
void read_line(SidebarSettings& settings, const Field& field) {
    if (field.name == "width") {
        const float width = std::strtof(field.value.c_str(), nullptr);
        settings.width = width >= sidebar_width_min && width <= width_max ? width : settings.width;
    } else if (field.name == "collapsed") {
        settings.collapsed = field.value == "1";
    } else if (field.name == "tab") {
        settings.tab = field.value;
    } else if (field.name == "tour_seen") {
        settings.tour_seen = field.value == "1";
    }
}

constexpr std::array<std::string_view, 3> colourings{"nothing", "gene", "health"}; // by ColourBy

constexpr std::pair<std::string_view, bool ViewOptions::*> switches[] = {
    {"trails", &ViewOptions::trails},
    {"flashes", &ViewOptions::flashes},
    {"density", &ViewOptions::density},
    {"minimap", &ViewOptions::minimap},
};

/// Sets `chosen` to the value with this name. Ignores unknown names.
template <class Value, class Names>
void read_name(const Names& names, const std::string& name, Value& chosen) {
    if (const auto found = std::ranges::find(names, name); found != std::end(names)) {
        chosen = static_cast<Value>(found - std::begin(names));
    }
}

std::array<std::string_view, palette::ramps.size()> ramp_names() {
    std::array<std::string_view, palette::ramps.size()> names;
    std::ranges::transform(palette::ramps, names.begin(), palette::name_of);
    return names;
}

void read_line(ViewOptions& view, const Field& field) {
    if (field.name == "skin") {
        read_name(skin_names, field.value, view.look.skin);
    } else if (field.name == "background") {
        read_name(background_names, field.value, view.look.background);
    } else if (field.name == "colour_by") {
        read_name(colourings, field.value, view.colour_by);
    } else if (field.name == "palette") {
        read_name(ramp_names(), field.value, view.ramp);
    } else if (field.name == "radii") {
        read_name(which_names, field.value, view.radii);
    } else if (field.name == "forces") {
        read_name(which_names, field.value, view.forces);
    } else if (field.name == "gene") {
        view.gene = std::strtoul(field.value.c_str(), nullptr, 10);
    }
    for (const auto& [name, shown] : switches) {
        view.*shown = field.name == name ? field.value == "1" : view.*shown;
    }
}

std::string text_of(const ViewOptions& view) {
    const auto name = [](const auto& names, auto value) { return std::string{names[static_cast<std::size_t>(value)]}; };
    std::string text = "skin=" + name(skin_names, view.look.skin) +
                       "\nbackground=" + name(background_names, view.look.background) +
                       "\ncolour_by=" + name(colourings, view.colour_by) + "\ngene=" + std::to_string(view.gene) +
                       "\npalette=" + std::string{palette::name_of(view.ramp)} +
                       "\nradii=" + name(which_names, view.radii) + "\nforces=" + name(which_names, view.forces) + "\n";
    for (const auto& [name, shown] : switches) {
        text.append(name).append(view.*shown ? "=1\n" : "=0\n");
    }
    return text;
}

/// Makes a section of the file, without functions to read and write it.
ImGuiSettingsHandler section(const char* name, void* user_data) {
    ImGuiSettingsHandler handler;
    handler.TypeName = name;
    handler.TypeHash = ImHashStr(name);
    handler.UserData = user_data;
    handler.ReadOpenFn = [](ImGuiContext*, ImGuiSettingsHandler* self, const char*) -> void* { return self->UserData; };
    return handler;
}

Panels& panels_of(const ImGuiSettingsHandler* handler) {
    return *static_cast<Panels*>(handler->UserData);
}

} // namespace

std::optional<std::filesystem::path> in_state_folder(const char* name) {
    const std::filesystem::path state = user_folder("XDG_STATE_HOME", ".local/state");
    return state.empty() ? std::nullopt : std::optional{state / name};
}

Settings::Settings(std::optional<std::filesystem::path> file, Panels& panels)
    : file_{std::move(file)}, panels_{panels} {
    if (!file_) {
        return;
    }
    add_sidebar();
    add_view();
    ImGui::LoadIniSettingsFromDisk(file_->c_str());
}

void Settings::add_sidebar() {
    ImGuiSettingsHandler handler = section("Sidebar", &panels_);
    handler.ReadLineFn = [](ImGuiContext*, ImGuiSettingsHandler* self, void*, const char* line) {
        SidebarSettings settings = panels_of(self).settings();
        read_line(settings, Field{line});
        panels_of(self).set(std::move(settings));
    };
    handler.WriteAllFn = [](ImGuiContext*, ImGuiSettingsHandler* self, ImGuiTextBuffer* out) {
        const SidebarSettings& settings = panels_of(self).settings();
        out->appendf("[%s][Data]\nwidth=%.0f\ncollapsed=%d\ntab=%s\ntour_seen=%d\n\n", self->TypeName,
                     double{settings.width}, settings.collapsed ? 1 : 0, settings.tab.c_str(),
                     settings.tour_seen ? 1 : 0);
    };
    ImGui::GetCurrentContext()->SettingsHandlers.push_back(handler);
}

void Settings::add_view() {
    ImGuiSettingsHandler handler = section("Island", &view_);
    handler.ReadLineFn = [](ImGuiContext*, ImGuiSettingsHandler* self, void*, const char* line) {
        read_line(*static_cast<ViewOptions*>(self->UserData), Field{line});
    };
    handler.WriteAllFn = [](ImGuiContext*, ImGuiSettingsHandler* self, ImGuiTextBuffer* out) {
        out->appendf("[%s][Data]\n%s\n", self->TypeName, text_of(*static_cast<ViewOptions*>(self->UserData)).c_str());
    };
    ImGui::GetCurrentContext()->SettingsHandlers.push_back(handler);
}

Settings::~Settings() {
    if (!file_) {
        return;
    }
    std::error_code error;
    std::filesystem::create_directories(file_->parent_path(), error);
    ImGui::SaveIniSettingsToDisk(file_->c_str());
    ImGui::GetCurrentContext()->SettingsHandlers.pop_back();
    ImGui::GetCurrentContext()->SettingsHandlers.pop_back();
}

} // namespace evod::viewer
