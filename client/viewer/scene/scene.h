// Scene: an island as it is seen: walls, food, poison, crates, obstacles, organisms with their health above them, and
// what the Sight adds to it: colours, radii, forces, trails, densities.
//
// Two halves. What goes where is computed by pure functions (marks.h); Scene keeps the shapes on the graphics card and
// draws them, all of a kind in one call. Items are uploaded with each picture, organisms and crates, which glide from
// one picture to the next, each time.
//
// Threads      none; used by the thread that draws.
#pragma once

#include "client/core/world_view.h"
#include "client/viewer/drawing/camera.h"
#include "client/viewer/scene/marks.h"
#include "client/viewer/scene/shapes.h"
#include "client/viewer/scene/sight.h"

#include <cstddef>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

struct ImDrawList;
struct ImFont;

namespace evod::viewer {

/// Health as it is written: a whole number, rounded up, for who is alive is never at 0.
unsigned shown_health(float health);

/// Whether numbers above the organisms can be read: they are large enough, and so few that the numbers do not overlap.
bool labels_are_readable(const Camera& camera, std::size_t visible_count);

/// The organism that is seen at `screen`; of several the one whose centre is nearest. Up to 3 pixels beside is a hit.
///
/// returns  index in picture.organisms
std::optional<std::size_t> organism_at(Point screen, const codec::DecodedSnapshot& picture,
                                       const core::WorldView::Positions& organisms, const Camera& camera);

class Scene {
  public:
    /// Organisms that stand out, by index in the picture.
    struct Marked {
        std::optional<std::size_t> pointed_at, selected;
    };

    /// Draws the latest picture of `view`, its organisms and crates at `blend`; nothing but the background without one.
    void draw(core::WorldView& view, double blend, const Camera& camera, unsigned width_pixels, unsigned height_pixels,
              const Sight& sight, const Marked& marked);

    /// What the densities that were drawn last mean; nullopt if none were.
    const std::optional<ColourScale>& density_scale() const { return density_scale_; }
    double density_cell_px() const { return density_cell_px_; }

    /// Adds the health of the organisms that are seen. To be called after draw(), with the same view, blend and camera.
    void draw_labels(core::WorldView& view, double blend, const Camera& camera, ImDrawList& list, ImFont& font);

  private:
    void upload_picture(const std::shared_ptr<const codec::DecodedSnapshot>& picture, const Camera& camera);
    void draw_items(const codec::DecodedSnapshot& picture);
    void draw_organisms(const codec::DecodedSnapshot& picture, const Positions& at, const Camera& camera,
                        const Sight& sight);
    void draw_density(const codec::DecodedSnapshot& picture, const Positions& at, const Camera& camera,
                      const Sight& sight);
    void draw_radii(const codec::DecodedSnapshot& picture, const Positions& at, const Camera& camera,
                    const Sight& sight);
    void draw_forces(const codec::DecodedSnapshot& picture, const Positions& at, const Camera& camera,
                     const Sight& sight);
    void draw_trails(const codec::DecodedSnapshot& picture, const Positions& at, const Camera& camera,
                     const Sight& sight);
    void set_circles(Layer& layer, const codec::DecodedItems& items, float radius);
    void set_boxes(Layer& layer, const codec::DecodedBoxes& boxes, const std::vector<float>& x,
                   const std::vector<float>& y);

    ShapePainter painter_;
    Layer walls_, food_, poison_, obstacles_, crates_, organisms_, pointed_at_, selected_;
    Layer dots_, density_, radii_, arrows_, targets_, trail_ends_;
    /// The ways from one picture of the trails to the next, uploaded once.
    struct Ways {
        std::shared_ptr<const codec::DecodedSnapshot> from, to;
        std::unique_ptr<Layer> layer;
    };
    std::deque<Ways> ways_;
    std::shared_ptr<const codec::DecodedSnapshot> uploaded_;
    std::optional<ColourScale> density_scale_;
    double density_cell_px_ = 1;
    std::vector<Shape> shapes_; // being put together
    std::vector<Line> lines_;
    std::vector<Colour> colours_;
    ColouredLines arrow_lines_, target_lines_;
    std::vector<std::size_t> labelled_; // organisms that are seen
};

} // namespace evod::viewer
