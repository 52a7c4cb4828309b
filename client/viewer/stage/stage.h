// Stage: everything that draws, put together: one call makes one picture of the panes with the worlds that are watched.
//
// Needs        OpenGL 3.3, current on the calling thread for as long as this lives.
// Threads      none; used by the thread that draws.
#pragma once

#include "client/viewer/drawing/gui.h"
#include "client/viewer/panels/panels.h"
#include "client/viewer/scene/scene.h"
#include "client/viewer/stage/overlay.h"
#include "client/viewer/stage/pane.h"

#include <SFML/Graphics/Image.hpp>

#include <functional>
#include <memory>
#include <optional>
#include <vector>

namespace evod::viewer {

class Stage {
  public:
    using Clock = core::WorldView::Clock;

    /// scale  of all text and widgets
    explicit Stage(double scale = 1) : gui_{scale} {}

    struct Frame {
        unsigned width_pixels = 1, height_pixels = 1;
        Clock::time_point now;
        bool glide = false;                // between the two newest pictures; otherwise the newest as they are
        bool interactive = false;          // with what hands act upon: panels, time lines, the mark of the focus
        std::optional<Point> pointed_at{}; // on the screen
    };

    /// Draws on the current framebuffer. A pane whose time line or minimap is pressed gets the focus.
    void draw(Panes& panes, const Frame& frame);

    /// Draws widgets alone, where nothing is watched.
    void draw(const std::function<void(const Gui&)>& build, const Frame& frame);

    /// What `draw` draws, off the screen, which a covered or small window cannot spoil.
    sf::Image capture(const Frame& frame, const std::function<void()>& draw);
    sf::Image capture(Panes& panes, const Frame& frame) {
        return capture(frame, [&] { draw(panes, frame); });
    }

    /// What of an event is for widgets and panels.
    Captured captured(const sf::Event& event) const;

    Gui& gui() { return gui_; }
    Overlay& overlay() { return overlay_; }
    Panels& panels() { return panels_; }

    /// Selects who was seen there, on the island that is chosen, in the picture that was drawn last, and shows the
    /// panel that tells of it; nobody, where nobody is.
    void select_at(Pane& pane, Point screen);

  private:
    void draw_tile(Pane& pane, const Tile& tile, Scene& scene, const Frame& frame, int pane_number);

    Gui gui_;
    std::vector<std::unique_ptr<Scene>> scenes_; // one for each tile
    Overlay overlay_;
    Panels panels_;
    Clock::time_point drawn_{};
};

} // namespace evod::viewer
