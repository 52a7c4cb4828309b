// Gui: Dear ImGui in an SFML window. All text of evoview is drawn by it, in the fonts loaded here.
//
// Needs        OpenGL 3.3, current on the calling thread for as long as this lives.
// Threads      none. There is one of it, for Dear ImGui has one context.
#pragma once

#include "client/viewer/input.h"

#include <SFML/Window/Event.hpp>

struct ImFont;

namespace evod::viewer {

class Gui {
  public:
    /// Throws std::runtime_error if a font is missing; it names the package.
    Gui();
    ~Gui();
    Gui(const Gui&) = delete;
    Gui& operator=(const Gui&) = delete;

    void handle(const sf::Event& event);
    Captured captured() const;

    void begin(unsigned width_pixels, unsigned height_pixels, double seconds);
    void draw(); // what was built since begin(), on the current framebuffer

    ImFont& text() const { return *text_; }
    ImFont& title() const { return *title_; }
    ImFont& label() const { return *label_; }

  private:
    ImFont* text_ = nullptr;
    ImFont* title_ = nullptr;
    ImFont* label_ = nullptr;
};

} // namespace evod::viewer
