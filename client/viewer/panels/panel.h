// Panel: a window of widgets over the island that the user can show and hide. It queries and commands the server only
// through the ViewedWorld, so everything it does uses the public protocol.
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
        core::WorldView::Clock::time_point now;
        IslandView& island_view;
        /// First frame since the panel was hidden: it has missed the events in between.
        bool just_shown = false;
    };
    struct Size {
        float width, height; // in pixels at scale 1
    };

    /// A key that the panel handles while it has the keyboard focus, and its text in the help.
    struct Key {
        sf::Keyboard::Key key;
        std::string_view help; // empty: the same as the key before
        bool control = false, shift = false;
    };

    virtual ~Panel() = default;

    /// The title of the window and of its section in the help: "Parameters".
    virtual std::string_view title() const = 0;

    /// The size until the user changes it.
    virtual Size first_size() const { return {380, 480}; }

    /// All other keys go to the main window, also while this panel has the focus.
    virtual std::span<const Key> keys() const { return {}; }
    /// Whether the keys have something to act on now.
    virtual bool takes_keys() const { return true; }

    /// Builds the widgets; called between ImGui::Begin() and ImGui::End(), only while the panel is shown.
    virtual void build(Context& context) = 0;
};

} // namespace evod::viewer
