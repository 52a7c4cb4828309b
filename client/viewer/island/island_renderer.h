// IslandRenderer: draws an island: walls, food, poison, crates, obstacles, organisms with their health above them, and
// what the view options add: colours, radii, forces, trails, densities.
//
// Pure functions (marks.h) compute the shapes; IslandRenderer keeps them in graphics memory and draws all of a kind in one
// call. Items are uploaded once per snapshot. Organisms and crates, which are interpolated between two snapshots, are
// uploaded in each frame.
//
// Owner        WindowRenderer, one per tile.
// Threads      none; used by the thread that draws.
#pragma once

#include "client/core/world_view.h"
#include "client/viewer/drawing/camera.h"
#include "client/viewer/island/island_view.h"
#include "client/viewer/island/marks.h"
#include "client/viewer/island/shapes.h"

#include <cstddef>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

struct ImDrawList;
struct ImFont;

namespace evod::viewer {

/// Health as it is displayed: rounded up, so that a living organism never shows 0.
unsigned shown_health(float health);

/// Whether the health numbers are readable: organisms are large enough, and few enough for the numbers not to overlap.
bool labels_are_readable(const Camera& camera, std::size_t visible_count);

/// The organism at a point of the screen; of several the one with the nearest centre. Up to 3 pixels beside it is a hit.
///
/// returns  an index in snapshot.organisms
std::optional<std::size_t> organism_at(Point screen, const codec::DecodedSnapshot& snapshot,
                                       const core::WorldView::Positions& organisms, const Camera& camera);

class IslandRenderer {
  public:
    /// Highlighted organisms, by index in the snapshot.
    struct Highlighted {
        std::optional<std::size_t> pointed_at, selected;
    };

    /// Draws the latest snapshot of `view`, with its organisms and crates interpolated at `blend`; without a snapshot only
    /// the background.
    void draw(core::WorldView& view, double blend, const Camera& camera, unsigned width_pixels, unsigned height_pixels,
              const IslandView& island_view, const Highlighted& highlighted);

    /// The scale of the densities that the last draw() drew; nullopt if it drew none.
    const std::optional<ColourScale>& density_scale() const { return density_scale_; }
    double density_cell_px() const { return density_cell_px_; }

    /// Draws the health of the visible organisms. Call after draw(), with the same view, blend and camera.
    void draw_labels(core::WorldView& view, double blend, const Camera& camera, ImDrawList& list, ImFont& font);

  private:
    void upload_snapshot(const std::shared_ptr<const codec::DecodedSnapshot>& snapshot, const Camera& camera);
    void draw_items(const codec::DecodedSnapshot& snapshot);
    void draw_organisms(const codec::DecodedSnapshot& snapshot, const Positions& at, const Camera& camera,
                        const IslandView& island_view);
    void draw_density(const codec::DecodedSnapshot& snapshot, const Positions& at, const Camera& camera,
                      const IslandView& island_view);
    void draw_radii(const codec::DecodedSnapshot& snapshot, const Positions& at, const Camera& camera,
                    const IslandView& island_view);
    void draw_forces(const codec::DecodedSnapshot& snapshot, const Positions& at, const Camera& camera,
                     const IslandView& island_view);
    void draw_trails(const codec::DecodedSnapshot& snapshot, const Positions& at, const Camera& camera,
                     const IslandView& island_view);
    void set_circles(Layer& layer, const codec::DecodedItems& items, float radius);
    void set_boxes(Layer& layer, const codec::DecodedBoxes& boxes, const std::vector<float>& x,
                   const std::vector<float>& y);

    ShapePainter painter_;
    Layer walls_, food_, poison_, obstacles_, crates_, organisms_, pointed_at_, selected_;
    Layer dots_, density_, radii_, arrows_, targets_, trail_ends_;
    /// The lines between two neighbouring snapshots of the trails, uploaded once.
    struct TrailSegment {
        std::shared_ptr<const codec::DecodedSnapshot> from, to;
        std::unique_ptr<Layer> layer;
    };
    std::deque<TrailSegment> trail_segments_;
    std::shared_ptr<const codec::DecodedSnapshot> uploaded_;
    std::optional<ColourScale> density_scale_;
    double density_cell_px_ = 1;
    std::vector<Shape> shapes_; // buffers, reused for every layer
    std::vector<Line> lines_;
    std::vector<Colour> colours_;
    ColouredLines arrow_lines_, target_lines_;
    std::vector<std::size_t> labelled_; // visible organisms
};

} // namespace evod::viewer
