// Marks: turns snapshots and populations into shapes, lines and their colours.
//
// These functions do all work of a frame that grows with the number of organisms, apart from drawing. Functions named
// add_… append to their last arguments. Positions and colours are indexed like the snapshot's organisms.
//
// Threads      none; pure functions.
#pragma once

#include "client/core/world_view.h"
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

using Positions = core::WorldView::Positions;

/// The property that colours organisms.
enum class ColourBy { Nothing, Gene, Health, Lineage };

/// From 0 to the greatest health of the snapshot, rounded up to hundreds so that the scale rarely changes; at least 100.
ColourScale health_scale(const codec::DecodedOrganisms& organisms, palette::Ramp ramp);

/// From the lowest to the highest value in the population.
ColourScale gene_scale(const Population& population, std::size_t gene, palette::Ramp ramp);

/// The colours of families. A family keeps its colour over generations while it is among the largest.
class FamilyColours {
  public:
    /// Gives free colours to new families.
    void update(const Population& population);
    /// family  an index in families() of the last population, or no_family
    Colour of(std::uint8_t family) const;

  private:
    std::array<std::optional<std::uint32_t>, palette::kinds.size()> places_{}; // by colour: its family's founder
    std::array<std::uint8_t, Population::shown_families_max> colours_{};       // by family
};

void add_discs(const Positions& at, std::span<const float> radius_px, std::vector<Shape>& shapes);

void add_health_colours(const codec::DecodedOrganisms& organisms, const ColourScale& scale,
                        std::vector<Colour>& colours);
/// Organisms that are not in the population get palette::unknown.
void add_gene_colours(const codec::DecodedOrganisms& organisms, const Population& population, std::size_t gene,
                      const ColourScale& scale, std::vector<Colour>& colours);
void add_family_colours(const codec::DecodedOrganisms& organisms, const Population& population,
                        const FamilyColours& families, std::vector<Colour>& colours);

/// Adds a circle whose radius is the gene's value around each organism, if part of it is visible.
void add_radii(const codec::DecodedOrganisms& organisms, const Positions& at, const Population& population,
               std::size_t gene, const Rectangle& visible, std::vector<Shape>& shapes);

/// Length of an arrow in px of the world, per kg px/s² of force.
constexpr float arrow_px_per_force = 0.3f;

struct ColouredLines {
    std::vector<Line> lines;
    std::vector<Colour> colours;
    void clear() { lines.clear(), colours.clear(); }
};

/// Adds, for each visible organism, an arrow along its force and a line to its target, coloured by its choice.
void add_forces(const codec::DecodedOrganisms& organisms, const Positions& at, const Population& population,
                const Rectangle& visible, ColouredLines& arrows, ColouredLines& targets);

// ---- trails ----------------------------------------------------------------------------------------------------

/// The snapshots of the last seconds; trails connect the positions in them.
class Trails {
  public:
    static constexpr double interval_s = 0.25, kept_s = 3; // simulated

    /// Starts again with a snapshot of another generation, run or island, or of an earlier tick.
    void add(const std::shared_ptr<const codec::DecodedSnapshot>& snapshot);
    void clear() { snapshots_.clear(); }
    /// The oldest first.
    const std::vector<std::shared_ptr<const codec::DecodedSnapshot>>& snapshots() const { return snapshots_; }

  private:
    std::vector<std::shared_ptr<const codec::DecodedSnapshot>> snapshots_;
};

/// Adds, for each organism in both snapshots, a line from its position in `from` to that of `to`.
void add_paths(const codec::DecodedOrganisms& from, const codec::DecodedOrganisms& to, std::span<const float> to_x_px,
               std::span<const float> to_y_px, std::vector<Line>& lines);

// ---- density ---------------------------------------------------------------------------------------------------

/// Radius of a typical organism. If it is below a pixel, organisms are too small to see.
constexpr double typical_radius_px = 10;
inline bool too_small_to_see(const Camera& camera) {
    return typical_radius_px * camera.zoom() < 1;
}

/// The number of organisms in each square cell of a part of the island.
struct DensityGrid {
    double left_px = 0, top_px = 0, cell_px = 1;
    std::size_t columns = 0, rows = 0;
    std::vector<std::uint32_t> counts; // row after row
};

/// Side of a cell in px: the power of two for which it is at least `cell_pixels` wide on the screen and less than twice.
double density_cell_px(const Camera& camera, double cell_pixels);

/// Counts the organisms in a part of the island. The grid is aligned to the island's corner, whatever the part.
DensityGrid density_of(const Positions& at, const Rectangle& part, double cell_px);

/// Adds a square per cell, coloured by its count and clipped at the right and lower wall. Empty cells are skipped.
void add_density(const DensityGrid& grid, Point island, const ColourScale& scale, std::vector<Shape>& shapes,
                 std::vector<Colour>& colours);

/// The densities that the snapshot contains, one grid per tile.
std::vector<DensityGrid> densities_of(const codec::DecodedSnapshot& snapshot);

/// Counts everything that the snapshot contains, in any detail, in at most `cells_max` cells along the longer side.
DensityGrid overview_of(const codec::DecodedSnapshot& snapshot, std::size_t cells_max);

/// From 0 to the greatest count, rounded up.
ColourScale density_scale(std::span<const DensityGrid> grids, palette::Ramp ramp);

} // namespace evod::viewer
