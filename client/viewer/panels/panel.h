// Panel: a group of widgets in the sidebar. It sends queries and commands only through the
// ViewedWorld, which uses the public protocol.
//
// Owner        Panels.
// Threads      none; used on the drawing thread.
#pragma once

#include "client/viewer/drawing/gui.h"
#include "client/viewer/island/island_view.h"
#include "client/viewer/world/viewed_world.h"

#include <string_view>

namespace evod::viewer {

class Panel {
  public:
    struct Context {
        ViewedWorld& world;
        const Gui& gui;
        core::SnapshotInterpolator::Clock::time_point now;
        IslandView& island_view;
        IslandData& island_data;
        /// Whether this is the first frame after the panel was hidden; set by Panels. A hidden panel receives no
        /// events.
        bool just_shown = false;
    };
    virtual ~Panel() = default;

    /// The title of the tab: "Parameters".
    virtual std::string_view title() const = 0;

    /// Builds the widgets. Called between ImGui::Begin() and ImGui::End(), only while the panel is shown.
    virtual void build(Context& context) = 0;
};

} // namespace evod::viewer
