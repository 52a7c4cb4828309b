// PanelHost: draws widgets off the screen, and sends them mouse and key events.
//
// Needs        an X server.
#pragma once

#include "client/viewer/drawing/gui.h"
#include "client/viewer/drawing/offscreen.h"
#include "client/viewer/shell/screen.h"

#include <GL/gl.h>
#include <SFML/Graphics/Image.hpp>
#include <SFML/Window/Context.hpp>

#include <functional>
#include <utility>

namespace evod::viewer {

class PanelHost {
  public:
    /// build  builds the widgets of a frame
    PanelHost(unsigned width_pixels, unsigned height_pixels, std::function<void(Gui&)> build)
        : width_{width_pixels}, height_{height_pixels}, build_{std::move(build)} {}

    /// Draws a frame after the events before it.
    sf::Image draw() {
        return draw_off_screen(width_, height_, [this] {
            glClearColor(1, 1, 1, 1);
            glClear(GL_COLOR_BUFFER_BIT);
            gui_.begin(width_, height_, 0.02);
            build_(gui_);
            gui_.draw();
        });
    }

    void press(sf::Keyboard::Key key) {
        sf::Event event{};
        event.key.code = key;
        for (const auto type : {sf::Event::KeyPressed, sf::Event::KeyReleased}) {
            event.type = type;
            give(event);
        }
    }
    void move(int x, int y) {
        sf::Event event{};
        event.type = sf::Event::MouseMoved;
        event.mouseMove = {x, y};
        give(event);
    }
    /// Presses or releases the left button at the position of the mouse.
    void button(sf::Event::EventType type) {
        sf::Event event{};
        event.type = type;
        event.mouseButton.button = sf::Mouse::Left;
        give(event);
    }
    void click(int x, int y) {
        move(x, y);
        button(sf::Event::MouseButtonPressed);
        button(sf::Event::MouseButtonReleased);
    }
    void turn_wheel(float notches) {
        sf::Event event{};
        event.type = sf::Event::MouseWheelScrolled;
        event.mouseWheelScroll = {sf::Mouse::VerticalWheel, notches, 0, 0};
        give(event);
    }

  private:
    void give(const sf::Event& event) {
        gui_.handle(event);
        draw();
    }

    unsigned width_, height_;
    std::function<void(Gui&)> build_;
    sf::Context context_{context_settings(), 1, 1};
    Gui gui_;
};

} // namespace evod::viewer
