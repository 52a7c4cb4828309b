// Stage: everything that draws, put together: one call makes one picture of what is watched.
//
// Needs        OpenGL 3.3, current on the calling thread for as long as this lives.
// Threads      none; used by the thread that draws.
#pragma once

#include "client/viewer/camera.h"
#include "client/viewer/gui.h"
#include "client/viewer/minimap.h"
#include "client/viewer/overlay.h"
#include "client/viewer/panels/panels.h"
#include "client/viewer/scene.h"
#include "client/viewer/sight.h"
#include "client/viewer/watch.h"

#include <SFML/Graphics/Image.hpp>

#include <optional>

namespace evod::viewer {

class Stage {
  public:
    using Clock = link::WorldView::Clock;

    struct Frame {
        unsigned width_pixels = 1, height_pixels = 1;
        Clock::time_point now;
        double blend = 1;                  // between the two newest pictures
        std::optional<Point> pointed_at{}; // on the screen
    };

    /// Draws on the current framebuffer.
    void draw(Watch& watch, Camera& camera, const Frame& frame);

    /// Draws the same off the screen, which a covered or small window cannot spoil.
    sf::Image capture(Watch& watch, Camera& camera, const Frame& frame);

    Gui& gui() { return gui_; }
    Overlay& overlay() { return overlay_; }
    Panels& panels() { return panels_; }
    Sight& sight() { return sight_; }

    /// Selects who was seen there in the picture that was drawn last, and shows the panel that tells of it; nobody,
    /// where nobody is.
    void select_at(Watch& watch, const Camera& camera, Point screen);

  private:
    Gui gui_;
    Scene scene_;
    Overlay overlay_;
    Panels panels_;
    Sight sight_;
    Minimap minimap_;
    double blend_ = 1; // of the picture that was drawn last
    Clock::time_point drawn_{};
};

} // namespace evod::viewer
