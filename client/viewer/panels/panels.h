// Panels: the sidebar at the right of the window. It contains the summary of the focused world, the run controls, and
// one panel at a time, chosen by a tab or by its function key. A detached panel is a window of its own over the
// worlds; closing this window returns the panel to the sidebar.
//
// Owner        WindowRenderer.
// Threads      none; used on the drawing thread.
#pragma once

#include "client/viewer/drawing/window_layout.h"
#include "client/viewer/panels/new_world_dialog.h"
#include "client/viewer/panels/panel.h"
#include "client/viewer/panels/summary.h"
#include "client/viewer/world/freezer.h"
#include "client/viewer/world/mouse_tool.h"

#include <SFML/Window/Event.hpp>

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace evod::viewer {

/// What evoview stores between two starts.
struct SidebarSettings {
    float width = sidebar_width; // pixels at scale 1
    bool collapsed = false;
    std::string tab = "Parameters"; // title of the panel that the sidebar shows
    bool tour_seen = false;         // whether the tour was shown
};

class Panels {
  public:
    Panels();

    /// Shows panel `index` and gives it the keyboard: expands the sidebar and chooses the tab, or brings the detached
    /// window to the front. Ignores an index beyond the last panel.
    void show(std::size_t index);
    /// Shows the panel with this title.
    void show(std::string_view title);
    bool shown(std::size_t index) const;
    void toggle_sidebar() { settings_.collapsed = !settings_.collapsed; }
    /// Detaches panel `index` from the sidebar, or returns it there.
    void set_detached(std::size_t index, bool detached);
    /// Returns the detached panel that was used last to the sidebar. Returns false if no panel is detached.
    bool close_front();
    /// Whether the panel with the keyboard focus handles this key. If not, the key goes to the main window.
    bool handles(const sf::Event::KeyEvent& key) const;
    /// Call when evoview has connected to another server. Every panel clears its data; places and tab stay.
    void begin_session();

    /// The panel with this function key, such as 4 for F4; nullopt: none.
    std::optional<std::size_t> panel_at(unsigned function_key) const;
    /// The name of the panel's key: "F2" for the first panel.
    std::string key_of(std::size_t index) const { return "F" + std::to_string(places_[index].function_key); }
    /// The titles of all panels, in the order of their keys.
    const std::vector<std::string_view>& titles() const { return titles_; }
    std::span<const Panel::Key> keys_of(std::size_t index) const { return places_[index].panel->keys(); }

    /// What a click in an island does.
    MouseTool& tool() { return tool_; }
    const MouseTool& tool() const { return tool_; }
    /// Sets the folder of the freezer.
    void set_freezer(std::filesystem::path folder) { freezer_ = Freezer{std::move(folder)}; }

    const SidebarSettings& settings() const { return settings_; }
    void set(SidebarSettings settings);
    void set_tour_seen() { settings_.tour_seen = true; }

    /// The width of the sidebar in pixels, in a window of this width.
    double width(unsigned window_pixels, double scale) const;

    /// Builds the sidebar and the detached panels. Call between Gui::begin() and Gui::draw().
    ///
    /// sidebar  the part of the window beside the worlds
    void build(Panel::Context context, Rectangle sidebar);

  private:
    struct Place {
        std::unique_ptr<Panel> panel;
        unsigned function_key = 0;
        bool detached = false;
        bool to_front = false; // give the panel the keyboard in the next frame
        int built = -1;        // the last frame of Dear ImGui in which it was built
    };
    void build_sidebar(Panel::Context& context, Rectangle sidebar);
    void build_edge(Rectangle sidebar, float scale);
    void build_collapsed(Rectangle sidebar, float scale);
    void build_corner(float scale);
    void build_tabs(const Gui& gui);
    void build_detached(std::size_t index, Panel::Context& context, Rectangle sidebar);
    void build_panel(std::size_t index, Panel::Context& context);
    void use(std::size_t index);
    std::size_t tab() const;

    SidebarSettings settings_;
    std::vector<Place> places_;
    std::vector<std::string_view> titles_;
    Summary summary_;
    Freezer freezer_;
    NewWorldDialog new_world_;
    MouseTool tool_;
    std::vector<std::size_t> used_;       // indices of detached panels, the most recently used last
    std::optional<std::size_t> keyboard_; // index of the panel with the keyboard focus
};

} // namespace evod::viewer
