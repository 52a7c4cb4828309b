// Marks: converts snapshots and populations into coloured shapes and lines.
//
// All work per frame that grows with the number of organisms is done here, except the drawing itself. Functions named
// add_… append to their last arguments. Positions, discs and colours have the same index as the organism in the
// snapshot.
//
// Threads      none; pure functions.
#pragma once

#include "client/core/snapshot_interpolator.h"
#include "client/viewer/drawing/camera.h"
#include "client/viewer/drawing/colour_scale.h"
#include "client/viewer/island/shapes.h"
#include "client/viewer/world/population.h"

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace evod::viewer {

using core::Positions;

/// The property that determines the colours of organisms.
enum class ColourBy { Nothing, Gene, Health };

/// Returns whether `next` continues what `last` showed: same world, run, island and generation, and no earlier tick.
bool continues(const evod::v1::SnapshotFrame& next, const evod::v1::SnapshotFrame& last);

/// Returns a colour scale from 0 to the greatest health in the snapshot. Rounds the upper end up to hundreds, at least
/// 100, so that the scale rarely changes.
ColourScale health_scale(const codec::Entities& organisms, palette::Ramp ramp);

/// Returns a colour scale from the lowest to the highest value of the gene in the population.
ColourScale gene_scale(const Population& population, std::size_t gene, palette::Ramp ramp);

/// Adds the disc of each organism. The functions below read positions from these discs, so that each position is
/// computed once per frame.
void add_discs(const Positions& organisms, std::vector<Shape>& discs);
/// Adds a short line across the edge of each organism, which shows its heading. Organisms outside of `visible` are left
/// out.
///
/// beyond_px  from the edge to the end of the line
void add_headings(const Positions& organisms, std::span<const Shape> discs, const Rectangle& visible, float beyond_px,
                  std::vector<Line>& lines);
/// Replaces the half height of each disc by the organism's health, as a share of `full_health`.
void set_health(const codec::Entities& organisms, double full_health, std::vector<Shape>& discs);

void add_health_colours(const codec::Entities& organisms, const ColourScale& scale, std::vector<Colour>& colours);
/// Adds the colour of each organism. An organism that is not in the population gets palette::unknown.
void add_gene_colours(const codec::Entities& organisms, const Population& population, std::size_t gene,
                      const ColourScale& scale, std::vector<Colour>& colours);

/// Indices of organisms in a snapshot. Radii and forces are drawn for these organisms; nullopt: for all.
using Chosen = std::optional<std::vector<std::size_t>>;

/// Adds a circle around each chosen organism, with the gene's value as its radius, if part of the circle is visible.
void add_radii(const codec::Entities& organisms, std::span<const Shape> discs, const Population& population,
               std::size_t gene, const Rectangle& visible, const Chosen& chosen, std::vector<Shape>& shapes);

/// Length of an arrow, in px of the world, for a force of 1 kg px/s².
constexpr float arrow_px_per_force = 0.3f;

struct ColouredLines {
    std::vector<Line> lines;
    std::vector<Colour> colours;
    void clear() { lines.clear(), colours.clear(); }
};

/// Adds, for each visible chosen organism, an arrow along its force and a line to its target, coloured by its choice.
void add_forces(const codec::Entities& organisms, std::span<const Shape> discs, const Population& population,
                const Rectangle& visible, const Chosen& chosen, const palette::IslandColours& colours,
                ColouredLines& arrows, ColouredLines& targets);

// ---- trails ----------------------------------------------------------------------------------------------------

/// The snapshots of the last `kept_s` simulated seconds. Trails connect the positions of an organism in these
/// snapshots.
class Trails {
  public:
    static constexpr double interval_s = 0.25, kept_s = 3; // in simulated seconds

    /// Adds a snapshot. Clears the older snapshots first if the new one is of another generation, run or island, or of
    /// an earlier tick.
    void add(const std::shared_ptr<const codec::ReceivedSnapshot>& snapshot);
    void clear() { snapshots_.clear(); }
    /// Returns the snapshots, oldest first.
    const std::vector<std::shared_ptr<const codec::ReceivedSnapshot>>& snapshots() const { return snapshots_; }

  private:
    std::vector<std::shared_ptr<const codec::ReceivedSnapshot>> snapshots_;
};

/// Adds a line for each organism that is in both snapshots, from its position in `from` to its disc.
///
/// discs  the discs of the organisms in `to`.
void add_paths(const codec::Entities& from, const codec::Entities& to, std::span<const Shape> discs,
               std::vector<Line>& lines);

// ---- density ---------------------------------------------------------------------------------------------------

/// Radius of a typical organism. If it is below one pixel on the screen, organisms are too small to see one by one.
constexpr double typical_radius_px = 10;
inline bool too_small_to_see(const Camera& camera) {
    return typical_radius_px * camera.zoom() < 1;
}
/// Smaller organisms have neither radii, forces, trails nor flashes, which would cover everything.
inline bool shows_details(const Camera& camera) {
    return typical_radius_px * camera.zoom() >= 0.5;
}
/// While organisms are too small to see, at most about this many dots of food are drawn, and of poison.
constexpr std::size_t item_dots_max = 10'000;
/// Keeps this share of the items, if it is below 1. Whether an item is kept depends only on its place, so that the
/// choice stays the same while others appear and disappear.
void keep_share(double share, std::vector<Shape>& items);

/// Trails and flashes are shown if a snapshot contains fewer organisms than this.
constexpr std::size_t traced_max = 5'000;
inline bool shows_traces(const Camera& camera, const codec::ReceivedSnapshot& snapshot) {
    return shows_details(camera) && snapshot.entities->organisms.x.size() < traced_max;
}

/// The greatest number of visible organisms that are streamed and drawn as moving dots. A dot takes two bytes, and
/// there are several items for each organism; 30 snapshots per second of such a world are about 9 MB/s.
constexpr double dots_max = 30'000;
/// Returns whether there are too many visible organisms for dots: more than dots_max, or more than one per pixel.
///
/// organism_count  on the whole island, assumed to be evenly spread
bool too_many_for_dots(const Camera& camera, const evod::v1::SnapshotFrame& island, double organism_count);

/// The number of organisms in each cell of a part of the island. Cells are square.
struct DensityGrid {
    double left_px = 0, top_px = 0, cell_px = 1;
    std::size_t columns = 0, rows = 0;
    std::vector<std::uint32_t> counts; // row by row
};

/// Returns the side of a cell in px of the world: the smallest power of two that is at least `cell_pixels` wide on the
/// screen.
double density_cell_px(const Camera& camera, double cell_pixels);

/// Counts the organisms in a part of the island. Cell borders are multiples of cell_px from the island's corner, so
/// they are at the same positions for every part.
///
/// cell_px  a power of two.
DensityGrid density_of(const Positions& organisms, const Rectangle& part, double cell_px);

/// Adds a square for each cell that is not empty, coloured by its count and clipped at the right and lower wall.
void add_density(const DensityGrid& grid, Point island, const ColourScale& scale, std::vector<Shape>& shapes,
                 std::vector<Colour>& colours);

/// Returns the densities that the snapshot contains, one grid per tile.
std::vector<DensityGrid> densities_of(const codec::ReceivedSnapshot& snapshot);

/// Counts the organisms in the snapshot, at any level of detail, in a grid that covers the whole island. The grid has
/// at most `cells_max` cells along the island's longer side.
DensityGrid overview_of(const codec::ReceivedSnapshot& snapshot, std::size_t cells_max);

/// Returns a colour scale from 0 to the greatest count in the grids, rounded up.
ColourScale density_scale(std::span<const DensityGrid> grids, palette::Ramp ramp);

} // namespace evod::viewer
