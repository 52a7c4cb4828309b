// Panels: every panel there is, each shown or hidden with a key, F2 and up, or the strip of their names.
//
// Threads      none; used by the thread that draws.
#pragma once

#include "client/viewer/panels/panel.h"

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace evod::viewer {

/// As many panels as there are keys: F1 is the help.
constexpr std::size_t panel_key_count = 11;
/// "F2" for the first; empty for those beyond the keys.
std::string panel_key(std::size_t index);

class Panels {
  public:
    Panels();

    /// Shows or hides panel `index`; one that is not there is nothing.
    void toggle(std::size_t index);
    /// Hides the panel that is in front; false if none is shown.
    bool close_front();
    /// Another server: what the panels know is forgotten, those that are shown stay.
    void begin_session();

    /// Shows the panel of that title.
    void show(std::string_view title);

    /// Of all panels, in the order of their keys.
    const std::vector<std::string_view>& titles() const { return titles_; }

    /// The strip of names and the panels that are shown, between Gui::begin() and Gui::draw().
    void build(Panel::Context context);

  private:
    struct Place {
        std::unique_ptr<Panel> panel;
        bool shown = false;
        int built = -1; // the last frame of Dear ImGui in which it was
    };
    void build_strip(const Gui& gui);
    std::vector<Place> places_;
    std::vector<std::string_view> titles_;
    std::size_t front_ = 0; // index: the one that was used last
};

} // namespace evod::viewer
