// Panel: a window of widgets over the island, which can be hidden. It asks and commands through the ViewedWorld alone, so
// everything it does goes over the public protocol.
//
// Threads      none; used by the thread that draws.
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
        /// The first time since it was hidden: the events of meanwhile were not heard.
        bool shown_anew = false;
    };
    struct Size {
        float width, height; // in pixels at scale 1
    };

    /// A key that the panel takes while it has the keyboard, and what the help says of it.
    struct Key {
        sf::Keyboard::Key key;
        std::string_view help; // empty: what the one before does
        bool control = false, shift = false;
    };

    virtual ~Panel() = default;

    /// Also of the window, and of its line in the help: "Parameters".
    virtual std::string_view title() const = 0;

    /// Until a person makes it another.
    virtual Size first_size() const { return {380, 480}; }

    /// All other keys are the window's, whatever panel is in front.
    virtual std::span<const Key> keys() const { return {}; }
    /// Whether there is something now that they act upon.
    virtual bool takes_keys() const { return true; }

    /// The widgets, between ImGui::Begin() and ImGui::End(); called only while it is shown.
    virtual void build(Context& context) = 0;
};

} // namespace evod::viewer
