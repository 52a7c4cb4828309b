// Script: actions of a person at the window as a text, one per line, for tests and for reproducible screenshots.
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
// A line is a verb and its arguments; an argument with spaces is put in double quotes. A line waits until it can be
// carried out: a click waits for its widget to be on the screen. script.cpp has tables of the verbs and conditions.
//
// Owner        Screen, which carries out one step at a time, after the effect of the step before has been drawn.
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

    /// The window as a script acts on it.
    class Host {
      public:
        virtual ~Host() = default;
        /// Adds an event, as if a person had caused it.
        virtual void send(const sf::Event& event) = 0;
        /// The centre of a widget, by the name given to widgets::mark().
        virtual std::optional<Point> find(const std::string& widget) const = 0;
        /// The choices of a drop-down, by its name; each choice is marked "drop-down: choice". Empty while it is closed;
        /// null if the widget is not a drop-down.
        virtual const std::vector<std::string>* choices(const std::string& widget) const = 0;
        /// Null while the start screen is shown.
        virtual const ViewedWorld* world() const = 0;
        /// Saves the window as PNG. Returns why it could not, or an empty text.
        virtual std::string save(const std::string& path) = 0;
        virtual void close() = 0;
    };

    /// An error contains line and word: '3: word 2: got "generaton", allowed …'.
    static core::Result<Script> parse(std::string_view text);

    bool done() const { return steps_.empty(); }

    /// Carries out the next step, or waits until it can be. An error contains the line of a step that failed or took too
    /// long.
    core::Result<void> advance(Host& host, Clock::time_point now);

    /// The verbs and conditions with their arguments and meaning, one per line, for the documentation.
    static std::string reference();

    /// Returns true when done, false if it has to wait.
    using Act = std::function<core::Result<bool>(Host&)>;

  private:
    struct Step {
        unsigned line;
        std::string text;      // the whole line
        std::string drop_down; // the widget that is set; empty: none
        std::chrono::duration<double> timeout;
        Act act;
    };

    std::deque<Step> steps_;
    std::optional<Clock::time_point> waiting_since_;
};

} // namespace evod::viewer
