// Panel: a group of widgets in the sidebar. It sends queries and commands only through the
// ViewedWorld, which uses the public protocol.
//
// Owner        Panels.
// Threads      none; used on the drawing thread.
#pragma once

#include "client/viewer/drawing/gui.h"
#include "client/viewer/island/island_view.h"
#include "client/viewer/world/viewed_world.h"

#include <SFML/Window/Keyboard.hpp>

#include <span>
#include <string_view>

namespace evod::viewer {

class Panel {
  public:
    struct Context {
        ViewedWorld& world;
        const Gui& gui;
        core::SnapshotInterpolator::Clock::time_point now;
        IslandView& island_view;
        /// Whether this is the first frame after the panel was hidden; set by Panels. A hidden panel receives no events.
        bool just_shown = false;
    };
    /// A key that the panel handles while it has the keyboard focus, and the text that explains it in the help.
    struct Key {
        sf::Keyboard::Key key;
        std::string_view help; // empty: this key has the same effect as the key before it
        bool control = false, shift = false;
    };

    virtual ~Panel() = default;

    /// The title of the tab and of its section in the help: "Parameters".
    virtual std::string_view title() const = 0;

    /// The keys that the panel handles. While the panel has the focus, all other keys still go to the main window.
    virtual std::span<const Key> keys() const { return {}; }

    /// Builds the widgets. Called between ImGui::Begin() and ImGui::End(), only while the panel is shown.
    virtual void build(Context& context) = 0;
};

} // namespace evod::viewer
