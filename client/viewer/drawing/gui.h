// Gui: uses Dear ImGui in an SFML window. It loads the fonts and draws all text of evoview.
//
// Events are queued until the next frame. Dear ImGui reads the state of keys and buttons once per frame. If a key is
// pressed and released within one frame, Gui therefore passes the release on in the next frame. No input is lost at a
// low frame rate.
//
// Owner        the window. One instance per process, because Dear ImGui has one context.
// Needs        OpenGL 3.3, current on the calling thread for the lifetime of this object.
// Threads      none; used on the drawing thread.
#pragma once

#include "client/viewer/drawing/widgets.h"

#include <SFML/Window/Event.hpp>
#include <SFML/Window/Keyboard.hpp>

#include <bitset>
#include <deque>
#include <memory>
#include <optional>
#include <string>

struct ImFont;

namespace evod::viewer {

/// The kinds of events that the widgets currently use: keyboard events, mouse events or both.
struct Captured {
    bool keyboard = false, mouse = false;
};

class Gui {
  public:
    static constexpr double scale_min = 0.5, scale_max = 4;

    /// scale  size of fonts and widgets; 1 suits a display with 96 dots per inch.
    /// Throws std::runtime_error if a font is missing; the message names the package to install.
    explicit Gui(double scale = 1);
    ~Gui();
    Gui(const Gui&) = delete;
    Gui& operator=(const Gui&) = delete;

    void handle(const sf::Event& event);
    Captured captured() const;
    /// Returns the text in the field that has the keyboard focus; nullopt if no field has it.
    std::optional<std::string> typed_text() const;
    /// Closes the topmost menu, list or dialog. Call it between two frames. Returns false if none is open.
    bool close_popup();
    /// Returns whether Dear ImGui has received every queued event.
    bool settled() const { return waiting_.empty(); }

    void begin(unsigned width_pixels, unsigned height_pixels, double seconds);
    void draw(); // renders everything built since begin() to the current framebuffer

    float scale() const { return scale_; }
    WidgetPositions& widget_positions() const { return *widget_positions_; }
    ImFont& text() const { return *text_; }
    ImFont& title() const { return *title_; }
    ImFont& label() const { return *label_; }

  private:
    /// The kinds of events that Dear ImGui has already received in this frame.
    struct Received {
        bool key = false, text = false, button = false;
    };
    /// Passes an event to Dear ImGui. Returns false if the event must wait for the next frame.
    bool pass_on(const sf::Event& event, Received& received);
    bool pass_on_key(const sf::Event& event, Received& received);

    float scale_;
    ImFont* text_ = nullptr;
    ImFont* title_ = nullptr;
    ImFont* label_ = nullptr;
    std::deque<sf::Event> waiting_;
    std::bitset<sf::Keyboard::KeyCount> held_keys_; // of those that Dear ImGui receives
    std::unique_ptr<WidgetPositions> widget_positions_ = std::make_unique<WidgetPositions>();
    std::string clipboard_; // the last text that Dear ImGui read from the clipboard
};

} // namespace evod::viewer
