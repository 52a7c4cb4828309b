// ViewPanel: switches that select what the window shows of an island, and how.
//
// Owner        Panels.
// Threads      none; used on the drawing thread.
#pragma once

#include "client/viewer/panels/panel.h"

namespace evod::viewer {

class ViewPanel : public Panel {
  public:
    std::string_view title() const override { return "View"; }
    void build(Context& context) override;
};

} // namespace evod::viewer
