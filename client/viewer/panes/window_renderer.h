// WindowRenderer: draws one frame of the window: all panes with their islands, panels and overlay.
//
// Owner        Screen, or the code that saves screenshots and recordings without a window.
// Needs        a current OpenGL 3.3 context on the calling thread, from construction to destruction.
// Threads      none; used by the thread that draws.
#pragma once

#include "client/viewer/drawing/gui.h"
#include "client/viewer/island/island_renderer.h"
#include "client/viewer/island/mark_painter.h"
#include "client/viewer/panels/panels.h"
#include "client/viewer/panes/overlay.h"
#include "client/viewer/panes/pane.h"

#include <SFML/Graphics/Image.hpp>

#include <cstdint>
#include <functional>
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
        bool interactive = false;          // draw panels, time lines and the mark of the focus
        std::optional<Point> pointed_at{}; // position of the mouse, in pixels
    };

    /// Draws to the current framebuffer. If the user presses a pane's time line or minimap, moves the focus to this
    /// pane.
    void draw(Panes& panes, const Frame& frame);

    /// Draws only the widgets that `build` creates, without panes.
    void draw(const std::function<void(const Gui&)>& build, const Frame& frame);

    /// Returns an image of what `draw` draws. It is drawn off-screen, so the window may be covered or smaller than the
    /// image.
    sf::Image capture(const Frame& frame, const std::function<void()>& draw);
    sf::Image capture(Panes& panes, const Frame& frame) {
        return capture(frame, [&] { draw(panes, frame); });
    }

    /// Whether a widget or panel uses the event.
    Captured captured(const sf::Event& event) const;

    Gui& gui() { return gui_; }
    Overlay& overlay() { return overlay_; }
    Panels& panels() { return panels_; }

    /// The weight of the newest snapshot in the positions of the last frame.
    double drawn_blend(const core::SnapshotInterpolator& view) const;
    /// Returns the id of the organism at a point of the chosen island, at the positions drawn in the last frame.
    std::optional<std::uint32_t> organism_drawn_at(Pane& pane, Point screen) const;
    /// Uses the mouse tool at a point of the chosen island. Without another tool, selects `organism`.
    ///
    /// organism  the organism that was at this point when the button was pressed
    void click_at(Pane& pane, Point screen, std::optional<std::uint32_t> organism);
    /// Selects an organism and shows the organism panel; nullopt: clears the selection.
    void select(Pane& pane, std::optional<std::uint32_t> organism);

  private:
    void drop_at_mouse(Panes& panes);
    void draw_tile(Pane& pane, const Tile& tile, IslandRenderer& renderer, const Frame& frame, int pane_number);

    Gui gui_;
    std::vector<std::unique_ptr<IslandRenderer>> island_renderers_; // one per tile
    MarkPainter marks_;                                             // of the legends
    Overlay overlay_;
    Panels panels_;
    Clock::time_point drawn_{};
    bool interpolated_ = false; // whether the last frame was interpolated
};

} // namespace evod::viewer
