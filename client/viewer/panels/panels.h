// Panels: every panel there is, each shown or hidden with a key, F2 and up, or the strip of their names.
//
// Threads      none; used by the thread that draws.
#pragma once

#include "client/viewer/panels/panel.h"

#include <memory>
#include <string_view>
#include <vector>

namespace evod::viewer {

class Panels {
  public:
    Panels();

    /// Shows or hides panel `index`; one that is not there is nothing.
    void toggle(std::size_t index);

    /// Shows the panel of that title.
    void show(std::string_view title);

    /// Between Gui::begin() and Gui::draw().
    void build(Panel::Context context);

  private:
    struct Place {
        std::unique_ptr<Panel> panel;
        bool shown = false;
    };
    std::vector<Place> places_;
};

} // namespace evod::viewer
