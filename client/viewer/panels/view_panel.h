// ViewPanel: the switches of what of an island is shown, and how.
#pragma once

#include "client/viewer/panels/panel.h"

namespace evod::viewer {

class ViewPanel : public Panel {
  public:
    std::string_view title() const override { return "View"; }
    void build(Context& context) override;
};

} // namespace evod::viewer
