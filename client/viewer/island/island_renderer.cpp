#include "client/viewer/island/island_renderer.h"

#include "client/viewer/drawing/ink.h"

#include <imgui.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <span>
#include <string_view>
#include <utility>

namespace evod::viewer {

namespace {

constexpr float label_pixels = 14;      // height of the health numbers, at scale 1
constexpr double label_zoom_min = 0.45; // at a smaller zoom, organisms are smaller than their numbers

const ShapeStyle food_style{.fill = palette::food, .half_pixels_min = 1};
const ShapeStyle poison_style{.fill = palette::poison, .half_pixels_min = 1};
const ShapeStyle obstacle_style{.form = Form::Rectangle, .fill = palette::obstacle, .half_pixels_min = 1};
const ShapeStyle crate_style{.form = Form::Rectangle,
                             .fill = palette::crate,
                             .edge = palette::crate_edge,
                             .edge_pixels = 2,
                             .half_pixels_min = 1};
const ShapeStyle organism_style{
    .fill = {0, 0, 0, 0}, .edge = palette::organism, .edge_pixels = 2, .half_pixels_min = 1.5f};
const ShapeStyle pointed_at_style{
    .fill = {255, 255, 255, 90}, .edge = palette::organism_pointed_at, .edge_pixels = 3, .half_pixels_min = 4};
const ShapeStyle wall_style{
    .form = Form::Rectangle, .fill = {0, 0, 0, 0}, .edge = palette::wall, .edge_pixels = float(Camera::wall_pixels)};

// The style of coloured organisms: a disc, with a dark outline if it is large enough.
const ShapeStyle coloured_style{.edge = palette::organism_outline, .edge_pixels = 1, .half_pixels_min = 1.5f};
const ShapeStyle coloured_small_style{.half_pixels_min = 1.5f};
constexpr double outline_zoom_min = 0.3;
const ShapeStyle selected_style{
    .fill = {0, 0, 0, 0}, .edge = palette::selected, .edge_pixels = 3, .half_pixels_min = 6};
const ShapeStyle density_style{.form = Form::Rectangle};
const ShapeStyle food_radius_style{.fill = {0, 0, 0, 0}, .edge = palette::food_radius, .edge_pixels = 1};
const ShapeStyle poison_radius_style{.fill = {0, 0, 0, 0}, .edge = palette::poison_radius, .edge_pixels = 1};
const ShapeStyle arrow_style{.form = Form::Arrow, .line_pixels = 2};
const ShapeStyle target_style{.form = Form::Line, .line_pixels = 1};
constexpr double marks_zoom_min = 0.05; // at a smaller zoom, rings and arrows would cover everything

constexpr double density_cell_pixels = 5;

ShapeStyle trail_style(double age_share) {
    ShapeStyle style{.form = Form::Line, .fill = palette::trail, .line_pixels = 1.5f};
    style.fill.alpha = static_cast<std::uint8_t>(200 - 160 * std::clamp(age_share, 0.0, 1.0));
    return style;
}

/// Returns the index of the gene with this name; nullopt if the world has no such gene.
std::optional<std::size_t> gene_named(std::string_view name, const IslandView& island_view) {
    const auto& names = island_view.gene_names();
    const auto place = std::ranges::find(names, name);
    return place == names.end() ? std::nullopt : std::optional{static_cast<std::size_t>(place - names.begin())};
}

} // namespace

unsigned shown_health(float health) {
    return health > 0 ? static_cast<unsigned>(std::ceil(health)) : 0;
}

bool labels_are_readable(const Camera& camera, std::size_t visible_count) {
    constexpr double label_area = 2 * label_pixels * label_pixels, covered_max = 0.4;
    const double viewport_area = camera.viewport().width * camera.viewport().height;
    return camera.zoom() >= label_zoom_min &&
           static_cast<double>(visible_count) * label_area <= covered_max * viewport_area;
}

std::optional<std::size_t> organism_at(Point screen, const Positions& organisms, const Camera& camera) {
    if (!camera.viewport().contains(screen)) {
        return std::nullopt;
    }
    const Point world = camera.to_world(screen);
    const double slack = 3 / camera.zoom();
    std::optional<std::size_t> found;
    double nearest = 0; // squared distance of the nearest organism so far
    for (std::size_t i = 0, size = organisms.size(); i < size; ++i) {
        const auto [x_px, y_px] = organisms[i];
        const double x = x_px - world.x, y = y_px - world.y, distance = x * x + y * y;
        const double reach = organisms.entities->radius_px(i) + slack;
        if (distance <= reach * reach && (!found || distance < nearest)) {
            found = i;
            nearest = distance;
        }
    }
    return found;
}

void IslandRenderer::set_circles(Layer& layer, const codec::Entities& items, float radius) {
    shapes_.resize(items.x.size());
    for (std::size_t i = 0; i < shapes_.size(); ++i) {
        shapes_[i] = {items.x_px(i), items.y_px(i), radius, radius};
    }
    layer.set(shapes_);
}

void IslandRenderer::set_boxes(Layer& layer, const Positions& boxes) {
    shapes_.resize(boxes.size());
    for (std::size_t i = 0; i < shapes_.size(); ++i) {
        const auto [x, y] = boxes[i];
        shapes_[i] = {x, y, boxes.entities->half_width_px(i), boxes.entities->half_height_px(i)};
    }
    layer.set(shapes_);
}

void IslandRenderer::upload_snapshot(const std::shared_ptr<const codec::ReceivedSnapshot>& snapshot,
                                     const Camera& camera) {
    if (snapshot != uploaded_) {
        uploaded_ = snapshot;
        const auto item_radius = static_cast<float>(snapshot->about.item_radius_px());
        set_circles(food_, snapshot->entities->food, item_radius);
        set_circles(poison_, snapshot->entities->poison, item_radius);
        set_boxes(obstacles_, {.entities = &snapshot->entities->obstacles});
    }
    // The walls lie outside the island and have the same thickness on the screen at any zoom.
    const auto half_width = static_cast<float>(snapshot->about.width_px() / 2);
    const auto half_height = static_cast<float>(snapshot->about.height_px() / 2);
    const auto thickness = static_cast<float>(Camera::wall_pixels / camera.zoom());
    walls_.set(std::array{Shape{half_width, half_height, half_width + thickness, half_height + thickness}});
}

void IslandRenderer::draw(const core::SnapshotInterpolator& view, double blend, const Camera& camera,
                          unsigned width_pixels, unsigned height_pixels, const IslandView& island_view,
                          const Highlighted& highlighted) {
    painter_.begin(camera, width_pixels, height_pixels, palette::background);
    density_scale_.reset();
    if (const auto& snapshot = view.latest()) {
        upload_snapshot(snapshot, camera);
        set_boxes(crates_, view.crates_at(blend));
        const Positions organisms = view.organisms_at(blend);
        painter_.draw(walls_, wall_style);
        painter_.draw(obstacles_, obstacle_style);
        painter_.draw(crates_, crate_style);
        // After a change of the level of detail, draw densities until the first snapshot with the new detail arrives.
        const bool has_densities = std::ranges::any_of(
            snapshot->tiles, [](const auto& tile) { return tile.detail == evod::v1::DETAIL_DENSITY; });
        if (island_view.shows_density(camera) || has_densities) {
            draw_density(*snapshot, organisms, camera, island_view);
        } else {
            draw_items(*snapshot);
            discs_.clear();
            add_discs(organisms, discs_);
            draw_radii(*organisms.entities, camera, island_view);
            draw_trails(*snapshot, camera, island_view);
            draw_organisms(*organisms.entities, camera, island_view);
            draw_forces(*organisms.entities, camera, island_view);
        }
        const auto highlight = [&](std::optional<std::size_t> index, Layer& layer, const ShapeStyle& style) {
            if (index && *index < organisms.size()) {
                const auto [x, y] = organisms[*index];
                const float radius = organisms.entities->radius_px(*index);
                layer.set(std::array{Shape{x, y, radius, radius}});
                painter_.draw(layer, style);
            }
        };
        highlight(highlighted.selected, selected_, selected_style);
        highlight(highlighted.pointed_at, pointed_at_, pointed_at_style);
    }
    painter_.end();
}

void IslandRenderer::draw_items(const codec::ReceivedSnapshot& snapshot) {
    painter_.draw(poison_, poison_style);
    painter_.draw(food_, food_style);
    // Tiles streamed as dots contain only positions.
    const auto draw_dots = [&](codec::DecodedDots::Places codec::DecodedDots::*which, double radius_px,
                               const ShapeStyle& style) {
        shapes_.clear();
        const auto radius = static_cast<float>(radius_px);
        for (const codec::DecodedTile& tile : snapshot.tiles) {
            const auto& places = tile.dots.*which;
            for (std::size_t i = 0; i < places.x_px.size(); ++i) {
                shapes_.push_back({places.x_px[i], places.y_px[i], radius, radius});
            }
        }
        if (!shapes_.empty()) {
            dots_.set(shapes_);
            painter_.draw(dots_, style);
        }
    };
    draw_dots(&codec::DecodedDots::obstacles, typical_radius_px, obstacle_style);
    draw_dots(&codec::DecodedDots::crates, typical_radius_px, crate_style);
    draw_dots(&codec::DecodedDots::poison, snapshot.about.item_radius_px(), poison_style);
    draw_dots(&codec::DecodedDots::food, snapshot.about.item_radius_px(), food_style);
    draw_dots(&codec::DecodedDots::organisms, typical_radius_px, organism_style);
}

void IslandRenderer::draw_organisms(const codec::Entities& organisms, const Camera& camera,
                                    const IslandView& island_view) {
    colours_.clear();
    if (island_view.options.colour_by == ColourBy::Nothing) {
        organisms_.set(discs_);
        return painter_.draw(organisms_, organism_style);
    }
    const Population* population = island_view.population();
    if (island_view.options.colour_by == ColourBy::Health) {
        add_health_colours(organisms, health_scale(organisms, island_view.options.ramp), colours_);
    } else if (population != nullptr && island_view.options.colour_by == ColourBy::Lineage) {
        add_family_colours(organisms, island_view.families(), island_view.family_colours(), colours_);
    } else if (population != nullptr && island_view.options.gene < population->gene_count()) {
        add_gene_colours(organisms, *population, island_view.options.gene,
                         gene_scale(*population, island_view.options.gene, island_view.options.ramp), colours_);
    } else {
        colours_.assign(discs_.size(), palette::unknown);
    }
    organisms_.set(discs_, colours_);
    painter_.draw(organisms_, camera.zoom() >= outline_zoom_min ? coloured_style : coloured_small_style);
}

void IslandRenderer::draw_density(const codec::ReceivedSnapshot& snapshot, const Positions& at, const Camera& camera,
                                  const IslandView& island_view) {
    auto grids = densities_of(snapshot);
    if (grids.empty()) { // a whole snapshot, or tiles with complete organisms
        grids.push_back(density_of(at, camera.visible(), viewer::density_cell_px(camera, density_cell_pixels)));
    }
    density_cell_px_ = grids.front().cell_px;
    density_scale_ = viewer::density_scale(grids, island_view.options.ramp);
    shapes_.clear();
    colours_.clear();
    for (const DensityGrid& grid : grids) {
        add_density(grid, {snapshot.about.width_px(), snapshot.about.height_px()}, *density_scale_, shapes_, colours_);
    }
    density_.set(shapes_, colours_);
    painter_.draw(density_, density_style);
}

void IslandRenderer::draw_radii(const codec::Entities& organisms, const Camera& camera, const IslandView& island_view) {
    const Population* population = island_view.population();
    if (!island_view.options.radii || population == nullptr || camera.zoom() < marks_zoom_min) {
        return;
    }
    for (const auto& [name, style] : {std::pair<std::string_view, const ShapeStyle&>{"food_radius", food_radius_style},
                                      {"poison_radius", poison_radius_style}}) {
        if (const auto gene = gene_named(name, island_view)) {
            shapes_.clear();
            add_radii(organisms, discs_, *population, *gene, camera.visible(), shapes_);
            radii_.set(shapes_);
            painter_.draw(radii_, style);
        }
    }
}

void IslandRenderer::draw_forces(const codec::Entities& organisms, const Camera& camera,
                                 const IslandView& island_view) {
    const Population* population = island_view.population();
    if (!island_view.options.forces || population == nullptr || camera.zoom() < marks_zoom_min) {
        return;
    }
    arrow_lines_.clear();
    target_lines_.clear();
    add_forces(organisms, discs_, *population, camera.visible(), arrow_lines_, target_lines_);
    targets_.set(target_lines_.lines, target_lines_.colours);
    painter_.draw(targets_, target_style);
    arrows_.set(arrow_lines_.lines, arrow_lines_.colours);
    painter_.draw(arrows_, arrow_style);
}

void IslandRenderer::draw_trails(const codec::ReceivedSnapshot& snapshot, const Camera& camera,
                                 const IslandView& island_view) {
    const auto& snapshots = island_view.trails().snapshots();
    if (!island_view.options.trails || snapshots.empty() || camera.zoom() < marks_zoom_min) {
        trail_segments_.clear();
        return;
    }
    std::erase_if(trail_segments_, [&](const TrailSegment& segment) {
        return std::ranges::find(snapshots, segment.from) == snapshots.end();
    });
    for (std::size_t i = 1; i < snapshots.size(); ++i) {
        if (std::ranges::find(trail_segments_, snapshots[i], &TrailSegment::to) == trail_segments_.end()) {
            trail_segments_.push_back({snapshots[i - 1], snapshots[i], std::make_unique<Layer>()});
            const codec::Entities& to = snapshots[i]->entities->organisms;
            shapes_.clear();
            lines_.clear();
            add_discs({.entities = &to}, shapes_);
            add_paths(snapshots[i - 1]->entities->organisms, to, shapes_, lines_);
            trail_segments_.back().layer->set(lines_);
        }
    }
    const double now_s = snapshot.about.simulated_s();
    for (const TrailSegment& segment : trail_segments_) {
        painter_.draw(*segment.layer, trail_style((now_s - segment.to->about.simulated_s()) / Trails::kept_s));
    }
    lines_.clear();
    add_paths(snapshots.back()->entities->organisms, snapshot.entities->organisms, discs_, lines_);
    trail_ends_.set(lines_);
    painter_.draw(trail_ends_, trail_style(0));
}

void IslandRenderer::draw_labels(const core::SnapshotInterpolator& view, double blend, const Camera& camera,
                                 ImDrawList& list, ImFont& font) {
    const auto& snapshot = view.latest();
    if (!snapshot || camera.zoom() < label_zoom_min) {
        return;
    }
    const Positions organisms = view.organisms_at(blend);
    const Rectangle visible = camera.visible();
    labelled_.clear();
    for (std::size_t i = 0, size = organisms.size(); i < size; ++i) {
        const auto [x, y] = organisms[i];
        if (visible.contains({x, y})) {
            labelled_.push_back(i);
        }
    }
    if (!labels_are_readable(camera, labelled_.size())) {
        return;
    }
    const Point corner = camera.to_screen({0, 0});
    const Point other = camera.to_screen({snapshot->about.width_px(), snapshot->about.height_px()});
    for (const std::size_t i : labelled_) {
        std::array<char, 16> room;
        const char* end = std::to_chars(room.begin(), room.end(), shown_health(organisms.entities->health(i))).ptr;
        const std::string_view digits{room.data(), static_cast<std::size_t>(end - room.data())};
        const auto [x, y] = organisms[i];
        const Point centre = camera.to_screen({x, y});
        const double radius = organisms.entities->radius_px(i) * camera.zoom();
        const double width = size_of(digits, font).x;
        // A black number is invisible on the black wall. Near a side wall the number moves inwards; near the top wall
        // it moves below the organism.
        const double above = centre.y - radius - font.FontSize - 1;
        const double top = above < corner.y ? centre.y + radius + 1 : above;
        const double left = std::max(std::min(centre.x - width / 2, other.x - width - 1), corner.x + 1);
        write(list, font, {static_cast<float>(left), static_cast<float>(top)}, palette::health, digits);
    }
}

} // namespace evod::viewer
