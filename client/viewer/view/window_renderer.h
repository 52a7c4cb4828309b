// WindowRenderer: draws one frame of the window: the world with its islands, the panels and the overlay.
//
// Owner        Screen, or the code that saves screenshots and recordings without a window.
// Needs        a current OpenGL 3.3 context on the calling thread, from construction to destruction.
// Threads      none; used by the thread that draws.
#pragma once

#include "client/viewer/drawing/gui.h"
#include "client/viewer/island/island_renderer.h"
#include "client/viewer/island/mark_painter.h"
#include "client/viewer/panels/panels.h"
#include "client/viewer/view/overlay.h"
#include "client/viewer/view/world_view.h"

#include <SFML/Graphics/Image.hpp>

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace evod::viewer {

class WindowRenderer {
  public:
    using Clock = core::SnapshotInterpolator::Clock;

    /// scale  factor for the size of all text and widgets
    explicit WindowRenderer(double scale = 1) : gui_{scale} {}

    struct Frame {
        unsigned width_pixels = 1, height_pixels = 1;
        Clock::time_point now;
        bool interpolate = false;          // interpolate between the two newest snapshots; otherwise draw the newest
        bool interactive = false;          // draw the panels and the time line
        std::optional<Point> pointed_at{}; // position of the mouse, in pixels
    };

    /// Draws to the current framebuffer.
    void draw(WorldView& view, const Frame& frame);

    /// Returns an image of what draw() draws. It is drawn off-screen, so the window may be covered or smaller than the
    /// image.
    sf::Image capture(WorldView& view, const Frame& frame);

    Gui& gui() { return gui_; }
    Overlay& overlay() { return overlay_; }
    Panels& panels() { return panels_; }

    /// The weight of the newest snapshot in the positions of the last frame.
    double drawn_blend(const core::SnapshotInterpolator& view) const;
    /// Returns the id of the organism at a point of the chosen island, at the positions drawn in the last frame.
    std::optional<std::uint32_t> organism_drawn_at(WorldView& view, Point screen) const;
    /// Selects an organism and shows the organism panel; nullopt: clears the selection.
    void select(WorldView& view, std::optional<std::uint32_t> organism);

  private:
    void draw_tile(WorldView& view, const Tile& tile, IslandRenderer& renderer, const Frame& frame);

    Gui gui_;
    std::vector<std::unique_ptr<IslandRenderer>> island_renderers_; // one per tile
    MarkPainter marks_;                                             // of the legends
    Overlay overlay_;
    Panels panels_;
    Clock::time_point drawn_{};
    bool interpolated_ = false; // whether the last frame was interpolated
};

} // namespace evod::viewer
