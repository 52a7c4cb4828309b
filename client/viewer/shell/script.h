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
// until it can be executed; a click, for example, waits until its widget is on the screen. script.cpp contains the
// tables of verbs and conditions.
//
// Owner        Screen, which executes one step at a time, after the effect of the previous step has been drawn.
// Threads      none.
#pragma once

#include "client/core/connection.h"
#include "client/viewer/drawing/camera.h"

#include <SFML/Window/Event.hpp>

#include <chrono>
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
    using Clock = std::chrono::steady_clock;

    /// The interface through which a script acts on the window.
    class Host {
      public:
        virtual ~Host() = default;
        /// Adds an event, as if the user had caused it.
        virtual void send(const sf::Event& event) = 0;
        /// Returns the centre of the widget that was registered under this name by widgets::mark(); nullopt if it is
        /// not on the screen.
        virtual std::optional<Point> find(const std::string& widget) const = 0;
        /// Returns the choices of the drop-down with this name. Each choice is registered as "drop-down: choice". Empty
        /// while the drop-down is closed; null if the widget is not a drop-down.
        virtual const std::vector<std::string>* choices(const std::string& widget) const = 0;
        /// Returns the viewed world; null while the start screen is shown.
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

    /// Performs a part of a step. Returns true when the part is done, false if it must be called again.
    using Act = std::function<core::Result<bool>(Host&)>;

  private:
    struct Step {
        unsigned line;
        std::string text;      // the complete line
        std::string drop_down; // the drop-down that the line sets; empty: none
        std::chrono::duration<double> timeout;
        Act act;
    };

    std::deque<Step> steps_;
    std::optional<Clock::time_point> waiting_since_;
};

} // namespace evod::viewer
