// Marks: pictures and populations → shapes, lines and their colours. Pure functions, all of what a drawn frame costs
// the processor that grows with the number of organisms.
//
// All that is called put_… adds to what it is handed. Positions and colours are by index in the picture's organisms.
//
// Threads      none.
#pragma once

#include "client/core/world_view.h"
#include "client/viewer/drawing/camera.h"
#include "client/viewer/drawing/colour_scale.h"
#include "client/viewer/scene/shapes.h"
#include "client/viewer/watch/population.h"

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace evod::viewer {

using Positions = core::WorldView::Positions;

/// What organisms are coloured by.
enum class ColourBy { Nothing, Gene, Health, Lineage };

/// 0 to the greatest health of the picture rounded up to hundreds, at least 100: so it stays from picture to picture.
ColourScale health_scale(const codec::DecodedOrganisms& organisms, palette::Ramp ramp);

/// From the least to the greatest value in the population.
ColourScale gene_scale(const Population& population, std::size_t gene, palette::Ramp ramp);

/// Families keep their colours from generation to generation, for as long as they are among the largest.
class FamilyColours {
  public:
    void see(const Population& population);
    /// Of an index in Population::families() of the population that was seen last, or no_family.
    Colour of(std::uint8_t family) const;

  private:
    std::array<std::optional<std::uint32_t>, palette::kinds.size()> places_{}; // founder that has each colour
    std::array<std::uint8_t, Population::shown_families_max> colours_{};       // by family
};

void put_discs(const Positions& at, std::span<const float> radius_px, std::vector<Shape>& shapes);

void put_health_colours(const codec::DecodedOrganisms& organisms, const ColourScale& scale,
                        std::vector<Colour>& colours);
/// Who is not in the population is `unknown`.
void put_gene_colours(const codec::DecodedOrganisms& organisms, const Population& population, std::size_t gene,
                      const ColourScale& scale, std::vector<Colour>& colours);
void put_family_colours(const codec::DecodedOrganisms& organisms, const Population& population,
                        const FamilyColours& families, std::vector<Colour>& colours);

/// Circles as large as a gene says, of whom something is seen.
void put_radii(const codec::DecodedOrganisms& organisms, const Positions& at, const Population& population,
               std::size_t gene, const Rectangle& seen, std::vector<Shape>& shapes);

/// px of the world that an arrow is long for each kg px/s2 of force.
constexpr float arrow_px_per_force = 0.3f;

struct ColouredLines {
    std::vector<Line> lines;
    std::vector<Colour> colours;
    void clear() { lines.clear(), colours.clear(); }
};

/// From each organism that is seen an arrow along its force, and a line to what it acts on; coloured by its choice.
void put_forces(const codec::DecodedOrganisms& organisms, const Positions& at, const Population& population,
                const Rectangle& seen, ColouredLines& arrows, ColouredLines& targets);

// ---- trails ----------------------------------------------------------------------------------------------------

/// Pictures of the last seconds, between which the ways are drawn.
class Trails {
  public:
    static constexpr double between_s = 0.25, kept_s = 3; // simulated

    /// Of another generation, run or island, or from before: begins anew.
    void see(const std::shared_ptr<const codec::DecodedSnapshot>& picture);
    void clear() { pictures_.clear(); }
    /// The oldest first.
    const std::vector<std::shared_ptr<const codec::DecodedSnapshot>>& pictures() const { return pictures_; }

  private:
    std::vector<std::shared_ptr<const codec::DecodedSnapshot>> pictures_;
};

/// A line for everyone who is in both, to where they are of those in `to`.
void put_ways(const codec::DecodedOrganisms& from, const codec::DecodedOrganisms& to, std::span<const float> to_x_px,
              std::span<const float> to_y_px, std::vector<Line>& lines);

// ---- density ---------------------------------------------------------------------------------------------------

/// An organism of an ordinary size; smaller than a pixel nobody can be made out.
constexpr double ordinary_radius_px = 10;
inline bool too_small_to_see(const Camera& camera) {
    return ordinary_radius_px * camera.zoom() < 1;
}

/// How many organisms are in each square cell of a part of the world.
struct DensityGrid {
    double left_px = 0, top_px = 0, cell_px = 1;
    std::size_t columns = 0, rows = 0;
    std::vector<std::uint32_t> counts; // row after row
};

/// Side of the cells, a power of two, that are at least `cell_pixels` on the screen and less than twice that.
double density_cell_px(const Camera& camera, double cell_pixels);

/// Of a part of the world, in cells that lie where they lie whatever the part is.
DensityGrid density_of(const Positions& at, const Rectangle& part, double cell_px);

/// Squares coloured by how many are in them, cut at the right and lower wall; empty ones are left out.
void put_density(const DensityGrid& grid, Point island, const ColourScale& scale, std::vector<Shape>& shapes,
                 std::vector<Colour>& colours);

/// The densities of tiles as grids, those that there are.
std::vector<DensityGrid> densities_of(const codec::DecodedSnapshot& picture);

/// All of an island that the picture tells of, whatever it tells, in at most `cells_max` cells along its longer side.
DensityGrid overview_of(const codec::DecodedSnapshot& picture, std::size_t cells_max);

/// 0 to the most in one cell, rounded up.
ColourScale density_scale(std::span<const DensityGrid> grids, palette::Ramp ramp);

} // namespace evod::viewer
