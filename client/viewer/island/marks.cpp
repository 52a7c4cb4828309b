#include "client/viewer/island/marks.h"

#include "client/viewer/text/numbers.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace evod::viewer {

namespace {

/// Stores a colour scale as a table of 256 colours. A look-up is faster than computing the colour, and the table is
/// fine enough for 8-bit colours.
class Table {
  public:
    explicit Table(const ColourScale& scale) : scale_{scale} {
        for (int i = 0; i <= last; ++i) {
            colours_[static_cast<std::size_t>(i)] = palette::at(scale.ramp, i / double{last});
        }
    }
    Colour operator()(float value) const {
        const double share = std::clamp(scale_.share(value), 0.0, 1.0);
        return colours_[static_cast<std::size_t>(share * last + 0.5)];
    }

  private:
    static constexpr int last = 255;
    ColourScale scale_;
    std::array<Colour, last + 1> colours_;
};

/// Returns whether a circle may overlap a rectangle. Also returns true for some circles that just miss a corner.
bool may_touch(const Rectangle& rectangle, float x, float y, float radius) {
    return x + radius >= rectangle.left && x - radius <= rectangle.left + rectangle.width &&
           y + radius >= rectangle.top && y - radius <= rectangle.top + rectangle.height;
}

Colour colour_of(evod::v1::Choice choice, const palette::IslandColours& colours) {
    return choice == evod::v1::CHOICE_SEEK   ? colours.seeks
           : choice == evod::v1::CHOICE_FLEE ? colours.flees
                                             : colours.wanders;
}

/// Calls `act` with the index of each chosen organism.
template <class Act>
void for_each(const Chosen& chosen, std::size_t organism_count, Act act) {
    if (chosen) {
        for (const std::size_t i : *chosen) {
            act(i);
        }
        return;
    }
    for (std::size_t i = 0; i < organism_count; ++i) {
        act(i);
    }
}

} // namespace

bool continues(const evod::v1::SnapshotFrame& next, const evod::v1::SnapshotFrame& last) {
    return next.world() == last.world() && next.run_id() == last.run_id() && next.island() == last.island() &&
           next.generation() == last.generation() && next.tick() >= last.tick();
}

ColourScale health_scale(const codec::Entities& organisms, palette::Ramp ramp) {
    float most = 100;
    for (const std::uint32_t steps : organisms.height) {
        most = std::max(most, codec::px_of(steps));
    }
    return {ramp, 0, 100 * std::ceil(most / 100.0)};
}

ColourScale gene_scale(const Population& population, std::size_t gene, palette::Ramp ramp) {
    const Population::Range range = population.range(gene);
    return {ramp, range.min, range.max};
}

void add_discs(const Positions& organisms, std::vector<Shape>& discs) {
    const std::size_t begin = discs.size(), count = organisms.size();
    discs.resize(begin + count);
    for (std::size_t i = 0; i < count; ++i) {
        const auto [x, y] = organisms[i];
        const float radius = organisms.entities->radius_px(i);
        discs[begin + i] = {x, y, radius, radius};
    }
}

void add_headings(const Positions& organisms, std::span<const Shape> discs, const Rectangle& visible, float beyond_px,
                  std::vector<Line>& lines) {
    constexpr float begin = 0.35f; // of the radius
    for (std::size_t i = 0; i < discs.size(); ++i) {
        const float x = discs[i].x, y = discs[i].y, radius = discs[i].half_width, end = radius + beyond_px;
        if (may_touch(visible, x, y, end)) {
            const float heading = organisms.heading_radians(i);
            const float ahead_x = std::cos(heading), ahead_y = std::sin(heading);
            lines.push_back(
                {x + begin * radius * ahead_x, y + begin * radius * ahead_y, x + end * ahead_x, y + end * ahead_y});
        }
    }
}

void set_health(const codec::Entities& organisms, double full_health, std::vector<Shape>& discs) {
    const auto share_per_step = static_cast<float>(1 / (codec::steps_per_px * full_health));
    for (std::size_t i = 0; i < discs.size(); ++i) {
        discs[i].half_height = std::min(static_cast<float>(organisms.height[i]) * share_per_step, 1.f);
    }
}

void add_health_colours(const codec::Entities& organisms, const ColourScale& scale, std::vector<Colour>& colours) {
    const Table table{scale};
    for (const std::uint32_t steps : organisms.height) {
        colours.push_back(table(codec::px_of(steps)));
    }
}

void add_gene_colours(const codec::Entities& organisms, const Population& population, std::size_t gene,
                      const ColourScale& scale, std::vector<Colour>& colours) {
    const Table table{scale};
    const auto values = population.gene(gene);
    for (const std::uint32_t id : organisms.id) {
        colours.push_back(id < values.size() ? table(values[id]) : palette::unknown);
    }
}

void add_radii(const codec::Entities& organisms, std::span<const Shape> discs, const Population& population,
               std::size_t gene, const Rectangle& visible, const Chosen& chosen, std::vector<Shape>& shapes) {
    const auto radii = population.gene(gene);
    for_each(chosen, organisms.id.size(), [&](std::size_t i) {
        const std::uint32_t id = organisms.id[i];
        if (id < radii.size() && may_touch(visible, discs[i].x, discs[i].y, radii[id])) {
            shapes.push_back({discs[i].x, discs[i].y, radii[id], radii[id]});
        }
    });
}

void add_forces(const codec::Entities& organisms, std::span<const Shape> discs, const Population& population,
                const Rectangle& visible, const Chosen& chosen, const palette::IslandColours& colours,
                ColouredLines& arrows, ColouredLines& targets) {
    constexpr float reach_px = 200; // no organism perceives farther than this
    for_each(chosen, organisms.id.size(), [&](std::size_t i) {
        const std::uint32_t id = organisms.id[i];
        const float x = discs[i].x, y = discs[i].y;
        if (id >= population.size() || !may_touch(visible, x, y, reach_px)) {
            return;
        }
        const evod::v1::Choice choice = population.choice(id);
        if (choice == evod::v1::CHOICE_UNSPECIFIED) {
            return;
        }
        const Colour colour = colour_of(choice, colours);
        arrows.lines.push_back({x, y, x + arrow_px_per_force * population.force_x()[id],
                                y + arrow_px_per_force * population.force_y()[id]});
        arrows.colours.push_back(colour);
        if (choice == evod::v1::CHOICE_SEEK || choice == evod::v1::CHOICE_FLEE) {
            targets.lines.push_back({x, y, population.target_x_px()[id], population.target_y_px()[id]});
            targets.colours.push_back(colour);
        }
    });
}

// ---- items -----------------------------------------------------------------------------------------------------

void keep_share(double share, std::vector<Shape>& items) {
    if (share >= 1) {
        return;
    }
    const auto limit = static_cast<std::uint32_t>(std::max(share, 0.0) * 0x1p32);
    std::erase_if(items, [limit](const Shape& item) {
        // Multiplying by these odd numbers spreads the places over all 32-bit numbers.
        std::uint32_t mixed =
            std::bit_cast<std::uint32_t>(item.x) * 0x9E3779B1u ^ std::bit_cast<std::uint32_t>(item.y) * 0x85EBCA77u;
        mixed = (mixed ^ mixed >> 15) * 0x2C1B3C6Du;
        return (mixed ^ mixed >> 12) >= limit;
    });
}

// ---- trails ----------------------------------------------------------------------------------------------------

void Trails::add(const std::shared_ptr<const codec::ReceivedSnapshot>& snapshot) {
    if (!snapshots_.empty()) {
        const auto& last = snapshots_.back()->about;
        const auto& next = snapshot->about;
        if (!continues(next, last)) {
            snapshots_.clear();
        } else if (next.simulated_s() - last.simulated_s() < interval_s - 1e-6) {
            return;
        }
    }
    snapshots_.push_back(snapshot);
    std::erase_if(snapshots_, [&](const auto& kept) {
        return kept->about.simulated_s() < snapshot->about.simulated_s() - kept_s - 1e-6;
    });
}

void add_paths(const codec::Entities& from, const codec::Entities& to, std::span<const Shape> discs,
               std::vector<Line>& lines) {
    for (std::size_t i = 0, j = 0; i < from.id.size() && j < to.id.size();) {
        if (from.id[i] < to.id[j]) {
            ++i;
        } else if (to.id[j] < from.id[i]) {
            ++j;
        } else {
            lines.push_back({from.x_px(i), from.y_px(i), discs[j].x, discs[j].y});
            ++i, ++j;
        }
    }
}

// ---- density ---------------------------------------------------------------------------------------------------

namespace {

DensityGrid empty_grid(const Rectangle& part, double cell_px) {
    DensityGrid grid;
    grid.cell_px = cell_px;
    grid.left_px = std::floor(part.left / cell_px) * cell_px;
    grid.top_px = std::floor(part.top / cell_px) * cell_px;
    grid.columns = static_cast<std::size_t>(std::ceil((part.left + part.width - grid.left_px) / cell_px));
    grid.rows = static_cast<std::size_t>(std::ceil((part.top + part.height - grid.top_px) / cell_px));
    grid.counts.resize(grid.columns * grid.rows);
    return grid;
}

void count_cell(DensityGrid& grid, double column, double row, std::uint32_t amount) {
    if (column >= 0 && row >= 0 && column < static_cast<double>(grid.columns) && row < static_cast<double>(grid.rows)) {
        grid.counts[static_cast<std::size_t>(row) * grid.columns + static_cast<std::size_t>(column)] += amount;
    }
}

void count(DensityGrid& grid, double x, double y, std::uint32_t amount) {
    count_cell(grid, (x - grid.left_px) / grid.cell_px, (y - grid.top_px) / grid.cell_px, amount);
}

} // namespace

bool too_many_for_dots(const Camera& camera, const evod::v1::SnapshotFrame& island, double organism_count) {
    const Rectangle visible = camera.visible();
    const auto overlap = [](double begin, double size, double whole) {
        return std::max(std::min(begin + size, whole) - std::max(begin, 0.0), 0.0);
    };
    const double area_px2 = overlap(visible.left, visible.width, island.width_px()) *
                            overlap(visible.top, visible.height, island.height_px());
    const double count = organism_count * area_px2 / std::max(island.width_px() * island.height_px(), 1.0);
    return count > dots_max || count > area_px2 * camera.zoom() * camera.zoom();
}

double density_cell_px(const Camera& camera, double cell_pixels) {
    return std::exp2(std::ceil(std::log2(cell_pixels / camera.zoom())));
}

DensityGrid density_of(const Positions& organisms, const Rectangle& part, double cell_px) {
    DensityGrid grid = empty_grid(part, cell_px);
    const double cells_per_px = 1 / cell_px; // exact, because cell_px is a power of two; multiplying is faster
    for (std::size_t i = 0, size = organisms.size(); i < size; ++i) {
        const auto [x, y] = organisms[i];
        count_cell(grid, (x - grid.left_px) * cells_per_px, (y - grid.top_px) * cells_per_px, 1);
    }
    return grid;
}

DensityGrid overview_of(const codec::ReceivedSnapshot& snapshot, std::size_t cells_max) {
    const double width = snapshot.about.width_px(), height = snapshot.about.height_px();
    DensityGrid grid = empty_grid({0, 0, width, height}, std::max(width, height) / static_cast<double>(cells_max));
    const codec::Entities& organisms = snapshot.entities->organisms;
    for (std::size_t i = 0; i < organisms.x.size(); ++i) {
        count(grid, organisms.x_px(i), organisms.y_px(i), 1);
    }
    for (const codec::DecodedTile& tile : snapshot.tiles) {
        const auto& [x, y] = tile.dots.organisms;
        for (std::size_t i = 0; i < x.size(); ++i) {
            count(grid, x[i], y[i], 1);
        }
    }
    for (const DensityGrid& tile : densities_of(snapshot)) {
        for (std::size_t i = 0; i < tile.counts.size(); ++i) {
            count(grid, tile.left_px + (static_cast<double>(i % tile.columns) + 0.5) * tile.cell_px,
                  tile.top_px + (static_cast<double>(i / tile.columns) + 0.5) * tile.cell_px, tile.counts[i]);
        }
    }
    return grid;
}

void add_density(const DensityGrid& grid, Point island, const ColourScale& scale, std::vector<Shape>& shapes,
                 std::vector<Colour>& colours) {
    for (std::size_t i = 0; i < grid.counts.size(); ++i) {
        if (grid.counts[i] > 0) {
            const double left = grid.left_px + static_cast<double>(i % grid.columns) * grid.cell_px;
            const double top = grid.top_px + static_cast<double>(i / grid.columns) * grid.cell_px;
            const double half_width = std::min(grid.cell_px, island.x - left) / 2;
            const double half_height = std::min(grid.cell_px, island.y - top) / 2;
            shapes.push_back({static_cast<float>(left + half_width), static_cast<float>(top + half_height),
                              static_cast<float>(half_width), static_cast<float>(half_height)});
            colours.push_back(scale(grid.counts[i]));
        }
    }
}

std::vector<DensityGrid> densities_of(const codec::ReceivedSnapshot& snapshot) {
    std::vector<DensityGrid> grids;
    for (const codec::DecodedTile& tile : snapshot.tiles) {
        if (tile.detail == evod::v1::DETAIL_DENSITY) {
            const std::size_t cells = tile.density.cells_per_side;
            grids.push_back({tile.left_px, tile.top_px,
                             static_cast<double>(snapshot.about.tile_px()) / static_cast<double>(cells), cells, cells,
                             tile.density.organisms});
        }
    }
    return grids;
}

ColourScale density_scale(std::span<const DensityGrid> grids, palette::Ramp ramp) {
    std::uint32_t most = 0;
    for (const DensityGrid& grid : grids) {
        for (const std::uint32_t count : grid.counts) {
            most = std::max(most, count);
        }
    }
    return {ramp, 0, nice_step(most)};
}

} // namespace evod::viewer
