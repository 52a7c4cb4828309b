// Gui: Dear ImGui in an SFML window. All text of evoview is drawn by it, in the fonts loaded here.
//
// Events wait here for the next frame. Dear ImGui looks at keys and buttons once a frame, so one that is pressed and
// released within a frame is given to it in two: however slowly is drawn, nothing typed is lost.
//
// Needs        OpenGL 3.3, current on the calling thread for as long as this lives.
// Threads      none. There is one of it, for Dear ImGui has one context.
#pragma once

#include "client/viewer/drawing/widgets.h"

#include <SFML/Window/Event.hpp>

#include <deque>
#include <memory>
#include <string>

struct ImFont;

namespace evod::viewer {

/// Events that widgets take for themselves.
struct Captured {
    bool keyboard = false, mouse = false;
};

class Gui {
  public:
    static constexpr double scale_min = 0.5, scale_max = 4;

    /// scale  of fonts and widgets; 1 is for 96 dots per inch.
    /// Throws std::runtime_error if a font is missing; it names the package.
    explicit Gui(double scale = 1);
    ~Gui();
    Gui(const Gui&) = delete;
    Gui& operator=(const Gui&) = delete;

    void handle(const sf::Event& event);
    Captured captured() const;
    /// Closes the menu, list or question that is in front, between two frames; false if none is open.
    bool close_popup();
    /// Whether every event has been given to Dear ImGui.
    bool settled() const { return waiting_.empty(); }

    void begin(unsigned width_pixels, unsigned height_pixels, double seconds);
    void draw(); // what was built since begin(), on the current framebuffer

    float scale() const { return scale_; }
    Spots& spots() const { return *spots_; }
    ImFont& text() const { return *text_; }
    ImFont& title() const { return *title_; }
    ImFont& label() const { return *label_; }

  private:
    /// What a frame was given already.
    struct Given {
        bool key = false, text = false, button = false;
    };
    /// False: it has to wait for the next frame.
    bool give(const sf::Event& event, Given& given);
    bool give_key(const sf::Event& event, Given& given);

    float scale_;
    ImFont* text_ = nullptr;
    ImFont* title_ = nullptr;
    ImFont* label_ = nullptr;
    std::deque<sf::Event> waiting_;
    std::unique_ptr<Spots> spots_ = std::make_unique<Spots>();
    std::string clipboard_; // what Dear ImGui was given last
};

} // namespace evod::viewer
