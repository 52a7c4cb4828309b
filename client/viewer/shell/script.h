// Script: what a person would do at the window, as a text of actions, one a line. For tests, and for pictures that can
// be made again.
//
//     # sets a chance, looks at what comes of it
//     wait connected
//     key F4
//     set Search mutation_chance
//     set mutation_chance 0.2
//     click Apply
//     wait generation 2
//     screenshot out.png
//     quit
//
// A line is a verb and its words; a word with spaces stands in double quotes. A line waits until it can be done: a
// click for its widget to be on the screen. Verbs and conditions are tables in script.cpp.
//
// Owner        the screen, which carries out one step at a time, when what the one before did has been drawn.
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

class Watch;

class Script {
  public:
    using Clock = std::chrono::steady_clock;

    /// What a script sees, and has hands on.
    class Host {
      public:
        virtual ~Host() = default;
        /// As if a person had done it.
        virtual void send(const sf::Event& event) = 0;
        /// The middle of a widget, by the name that it was marked with.
        virtual std::optional<Point> find(const std::string& widget) const = 0;
        /// What a drop-down offers, by the name that it was marked with, each marked "drop-down: choice"; nothing while
        /// it is closed, and null if it is no drop-down.
        virtual const std::vector<std::string>* choices(const std::string& widget) const = 0;
        /// Null while nothing is watched.
        virtual const Watch* watched() const = 0;
        /// Saves what is shown; says why it cannot, or nothing.
        virtual std::string save(const std::string& path) = 0;
        virtual void close() = 0;
    };

    /// Refused, with line and word, if there is anything in it that cannot be understood: '3: word 2: "generaton": …'.
    static core::Result<Script> parse(std::string_view text);

    bool done() const { return steps_.empty(); }

    /// Carries out the next step, or finds that it has to wait. Refused, with its line, when that takes too long or
    /// cannot be done.
    core::Result<void> advance(Host& host, Clock::time_point now);

    /// Each verb with its words and what it does, a line each, for the documentation.
    static std::string reference();

    /// True when it is done, false if it has to wait.
    using Act = std::function<core::Result<bool>(Host&)>;

  private:
    struct Step {
        unsigned line;
        std::string text;      // of the line
        std::string drop_down; // that something is chosen from, if it is one; empty: none
        std::chrono::duration<double> patience;
        Act act;
    };

    std::deque<Step> steps_;
    std::optional<Clock::time_point> waiting_since_;
};

} // namespace evod::viewer
