// Script: actions of a user in the window, as text with one action per line. Used for tests and reproducible
// screenshots.
//
//     # changes a parameter and saves the window in generation 2
//     wait connected
//     key F4
//     set Search mutation_chance
//     set mutation_chance 0.2
//     click Apply
//     wait generation 2
//     screenshot out.png
//     quit
//
// A line contains a verb and its arguments. An argument that contains spaces is put in double quotes. Each line waits
// until it can be executed; a click, for example, waits until its widget is on the screen and enabled. A line that has
// no effect fails. script.cpp contains the tables of verbs and conditions.
//
// Owner        Screen, which executes one step at a time, after the effect of the previous step has been drawn.
// Threads      none.
#pragma once

#include "client/core/connection.h"
#include "client/viewer/drawing/camera.h"
#include "client/viewer/drawing/widgets.h"

#include <SFML/Window/Event.hpp>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace evod::viewer {

class ViewedWorld;

class Script {
  public:
    /// A place in a shown island that a script clicks.
    struct IslandPlace {
        std::optional<std::uint32_t> organism; // the centre of this organism; nullopt: `at`
        Point at;                              // from {0, 0}, the upper left corner, to {1, 1}
    };

    using Clock = std::chrono::steady_clock;

    /// The interface through which a script acts on the window.
    class Host {
      public:
        virtual ~Host() = default;
        /// Adds an event, as if the user had caused it.
        virtual void send(const sf::Event& event) = 0;
        /// Returns the widgets with this name: "name" or "Panel/name".
        virtual std::vector<const MarkedWidget*> find(const std::string& name) const = 0;
        /// Returns why evoview has no widget with this name: a panel of the page has it. Empty for any other name.
        virtual std::string absence(const std::string& name) const = 0;
        /// Scrolls the widget with this full name into view.
        virtual void reveal(const std::string& widget) = 0;
        /// Returns the widget of Dear ImGui under the mouse, as in MarkedWidget::id; 0: none.
        virtual unsigned hovered() const = 0;
        /// Returns whether a panel, dialog or list is under the mouse.
        virtual bool covered() const = 0;
        /// Returns the text in the field that has the keyboard focus; nullopt: no field has it.
        virtual std::optional<std::string> typed_text() const = 0;
        /// Returns why the last key that was sent had no effect; empty if it had one.
        virtual std::string key_problem() const = 0;
        /// Returns the place of an island in the window; nullopt if it is not visible.
        virtual std::optional<Point> locate(const IslandPlace& place) const = 0;
        /// Returns the selected organism.
        virtual std::optional<std::uint32_t> selected() const = 0;
        /// Returns the viewed world; null if there is none.
        virtual const ViewedWorld* world() const = 0;
        /// Saves the window as a PNG file. Returns an error message; empty on success.
        virtual std::string save(const std::string& path) = 0;
        virtual void close() = 0;
    };

    /// Parses a script. An error contains the line and the word: '3: word 2: got "generaton", allowed …'.
    static core::Result<Script> parse(std::string_view text);

    bool done() const { return steps_.empty(); }

    /// Executes the next step if possible, otherwise returns to wait for it. Returns an error with the script line if a
    /// step has failed or exceeded its time limit.
    core::Result<void> advance(Host& host, Clock::time_point now);

    /// Returns the verbs and conditions with their arguments and meanings, one per line, for the documentation.
    static std::string reference();

    /// What an act uses and counts.
    struct Run {
        Host& host;
        unsigned& actions; // clicks, keys, typed texts and turns of the wheel since the last line `actions`
        bool& scrolled;    // whether the current line has turned the wheel
    };
    /// Performs a part of a step. Returns an empty text when the part is done. Otherwise returns what it waits for, and
    /// must be called again.
    using Act = std::function<core::Result<std::string>(Run&)>;

  private:
    struct Step {
        unsigned line;
        std::string text; // the complete line
        std::chrono::duration<double> timeout;
        Act act;
    };

    std::deque<Step> steps_;
    std::optional<Clock::time_point> waiting_since_;
    unsigned actions_ = 0;
    bool scrolled_ = false;
};

} // namespace evod::viewer
