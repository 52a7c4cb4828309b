// Panels: the sidebar at the right of the window. It contains the summary of the focused world, the run controls, and
// one panel at a time, chosen by a tab or by its function key.
//
// Owner        WindowRenderer.
// Threads      none; used on the drawing thread.
#pragma once

#include "client/viewer/drawing/window_layout.h"
#include "client/viewer/panels/panel.h"
#include "client/viewer/panels/summary.h"

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace evod::viewer {

class Panels {
  public:
    Panels();

    /// Shows panel `index` and gives it the keyboard: expands the sidebar and chooses the tab. Ignores an index beyond
    /// the last panel.
    void show(std::size_t index);
    /// Shows the panel with this title.
    void show(std::string_view title);
    bool shown(std::size_t index) const;
    void toggle_sidebar() { collapsed_ = !collapsed_; }

    /// The panel with this function key, such as 4 for F4; nullopt: none.
    std::optional<std::size_t> panel_at(unsigned function_key) const;
    /// The name of the panel's key: "F2" for the first panel.
    std::string key_of(std::size_t index) const { return "F" + std::to_string(places_[index].function_key); }
    /// The titles of all panels, in the order of their keys.
    const std::vector<std::string_view>& titles() const { return titles_; }

    /// The width of the sidebar in pixels, in a window of this width.
    double width(unsigned window_pixels, double scale) const;

    /// Builds the sidebar. Call between Gui::begin() and Gui::draw().
    ///
    /// sidebar  the part of the window beside the worlds
    void build(Panel::Context context, Rectangle sidebar);

  private:
    struct Place {
        std::unique_ptr<Panel> panel;
        unsigned function_key = 0;
        bool to_front = false; // give the panel the keyboard in the next frame
        int built = -1;        // the last frame of Dear ImGui in which it was built
    };
    void build_sidebar(Panel::Context& context, Rectangle sidebar);
    void build_collapsed(Rectangle sidebar, float scale);
    void build_corner(float scale);
    void build_tabs(const Gui& gui);
    void build_panel(std::size_t index, Panel::Context& context);

    bool collapsed_ = false;
    std::size_t tab_ = 0; // index of the panel that the sidebar shows
    std::vector<Place> places_;
    std::vector<std::string_view> titles_;
    Summary summary_;
};

} // namespace evod::viewer
