// IslandRenderer: draws an island in its skin: walls, food, poison, crates, obstacles, organisms with their health, and
// everything that the view options enable: colours, radii, forces, trails, flashes and densities.
//
// Pure functions (marks.h) compute the shapes. IslandRenderer keeps the shapes in graphics memory and draws all shapes
// of one kind in one call. Items are uploaded once per snapshot. Organisms and crates are uploaded in each frame,
// because they are interpolated between two snapshots.
//
// Owner        WindowRenderer, one per tile.
// Threads      none; used by the thread that draws.
#pragma once

#include "client/core/snapshot_interpolator.h"
#include "client/viewer/drawing/camera.h"
#include "client/viewer/island/island_view.h"
#include "client/viewer/island/labels.h"
#include "client/viewer/island/marks.h"
#include "client/viewer/island/shapes.h"
#include "client/viewer/island/styles.h"

#include <cstddef>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <vector>

struct ImDrawList;
struct ImFont;

namespace evod::viewer {

/// Rounds the health up for display, so that a living organism never shows 0.
unsigned shown_health(float health);

/// Returns whether the health numbers of all visible organisms are readable: organisms must be large enough, and few
/// enough that the numbers do not cover the island.
///
/// zoom_min  at scale 1
bool labels_are_readable(const Camera& camera, std::size_t visible_count, double zoom_min);

/// Returns the organism at a point of the screen. The target of a small organism has a radius of 12 pixels, that of a
/// large one extends 3 pixels beyond its edge; both grow with the scale. Of several organisms that contain the point,
/// the one whose centre is nearest is hit. If none contains it, the one whose edge is nearest is hit.
///
/// returns  an index in `organisms`; nullopt: no organism is there
std::optional<std::size_t> organism_at(Point screen, const Positions& organisms, const Camera& camera);

class IslandRenderer {
  public:
    /// The highlighted organisms, by their index in the snapshot.
    struct Highlighted {
        std::optional<std::size_t> pointed_at, selected;
    };

    /// Draws the latest snapshot of `view`, with organisms and crates interpolated at `blend`. Draws only the
    /// background if `view` has no snapshot.
    void draw(const core::SnapshotInterpolator& view, double blend, const Camera& camera, unsigned width_pixels,
              unsigned height_pixels, const IslandView& island_view, const Highlighted& highlighted);

    /// Returns the colour scale of the densities in the last draw(); nullopt if draw() drew no densities.
    const std::optional<ColourScale>& density_scale() const { return density_scale_; }
    double density_cell_px() const { return density_cell_px_; }

    /// Draws the health of the visible organisms as numbers, or of the highlighted ones only if the organisms are small
    /// in this skin. Call after draw(), with the same arguments.
    ///
    /// healthiest  indices of organisms that are named, as the highlighted ones, if the population is small
    void draw_labels(const core::SnapshotInterpolator& view, double blend, const Camera& camera, Look look,
                     const Highlighted& highlighted, std::span<const std::size_t> healthiest, ImDrawList& list,
                     ImFont& font);

  private:
    void upload_snapshot(const std::shared_ptr<const codec::ReceivedSnapshot>& snapshot);
    void draw_walls(const codec::ReceivedSnapshot& snapshot, const Camera& camera, Look look);
    void draw_items(const codec::ReceivedSnapshot& snapshot, const Camera& camera, const Styles& styles);
    void draw_organisms(const codec::Entities& organisms, const Camera& camera, const IslandView& island_view);
    void draw_species(const codec::Entities& organisms, const ShapeStyle& prey, const ShapeStyle& predator);
    void draw_headings(const Positions& organisms, const Camera& camera, const Styles& styles);
    void draw_density(const codec::ReceivedSnapshot& snapshot, const Positions& at, const Camera& camera,
                      const IslandView& island_view);
    void draw_radii(const codec::Entities& organisms, const Camera& camera, const IslandView& island_view,
                    const Chosen& chosen);
    void draw_forces(const codec::Entities& organisms, const Camera& camera, const IslandView& island_view,
                     const Chosen& chosen);
    void draw_trails(const codec::ReceivedSnapshot& snapshot, const Camera& camera, const IslandView& island_view);
    void draw_flashes(double now_s, const IslandView& island_view);
    void set_dots(Layer& layer, const codec::ReceivedSnapshot& snapshot,
                  codec::DecodedDots::Places codec::DecodedDots::*which, double radius_px);
    void set_items(const codec::ReceivedSnapshot& snapshot);
    void set_boxes(Layer& layer, const Positions& boxes);

    struct Layers {
        Layer shadow, food, poison, obstacles, crates, organisms, predators, headings, pointed_at, selected;
        Layer few_food, few_poison; // shares of the items, for dots
        // Tiles streamed as dots contain only positions.
        Layer organism_dots, crate_dots, obstacle_dots;
        Layer density, radii, arrows, targets, trail_ends, flashes;
    };
    /// Memory that is reused in every frame.
    struct Reused {
        std::vector<Shape> discs; // the organisms in this frame
        std::vector<Shape> shapes, food_shapes;
        std::vector<Line> lines;
        std::vector<Colour> colours, species_colours; // of all organisms, and of one species
        ColouredLines arrow_lines, target_lines;
        std::vector<std::size_t> labelled; // indices of the organisms with a number
        std::vector<std::size_t> named;    // indices of those whose label contains the id, too
        std::vector<HealthLabel> labels;
        std::vector<HealthLabel> obstacles; // organisms that labels should not cover
    };

    ShapePainter painter_;
    Layers layers_;
    Reused reused_;
    /// The trail lines between two consecutive snapshots; uploaded once.
    struct TrailSegment {
        std::shared_ptr<const codec::ReceivedSnapshot> from, to;
        std::unique_ptr<Layer> layer;
    };
    std::deque<TrailSegment> trail_segments_;
    std::shared_ptr<const codec::ReceivedSnapshot> uploaded_;
    bool items_uploaded_ = false; // of this snapshot; densities are drawn without items
    double full_health_ = 100;    // in the uploaded snapshot; see health_scale()
    std::optional<ColourScale> density_scale_;
    double density_cell_px_ = 1;
};

} // namespace evod::viewer
