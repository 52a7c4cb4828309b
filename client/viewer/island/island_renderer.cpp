#include "client/viewer/island/island_renderer.h"

#include "client/viewer/drawing/ink.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <utility>

namespace evod::viewer {

namespace {

constexpr double label_padding = 2;          // pixels at the left and the right of the text of a label
constexpr std::size_t with_names_max = 2000; // the healthiest organisms of larger populations are not named
constexpr float label_pixels = 14;           // height of the health numbers, at scale 1
constexpr double density_cell_pixels = 5;

constexpr double outline_zoom_min = 0.3; // smaller coloured organisms have neither outline nor arc

const ShapeStyle density_style{.form = Form::Rectangle};

/// The style of a trail whose end has this age, as a share of the time that trails are kept.
ShapeStyle aged(ShapeStyle trail, double age_share) {
    trail.fill.alpha = static_cast<std::uint8_t>(trail.fill.alpha * (1 - 0.8 * std::clamp(age_share, 0.0, 1.0)));
    return trail;
}

Rectangle on_screen(const Camera& camera, const evod::v1::SnapshotFrame& island) {
    const Point corner = camera.to_screen({0, 0});
    return {corner.x, corner.y, island.width_px() * camera.zoom(), island.height_px() * camera.zoom()};
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

bool labels_are_readable(const Camera& camera, std::size_t visible_count, double zoom_min) {
    constexpr double covered_max = 0.4;
    const double label_height = label_pixels * camera.scale(), label_area = 2 * label_height * label_height;
    const double viewport_area = camera.viewport().width * camera.viewport().height;
    return camera.zoom() >= zoom_min * camera.scale() &&
           static_cast<double>(visible_count) * label_area <= covered_max * viewport_area;
}

std::optional<std::size_t> organism_at(Point screen, const Positions& organisms, const Camera& camera) {
    if (!camera.viewport().contains(screen)) {
        return std::nullopt;
    }
    const Point world = camera.to_world(screen);
    const double pixel = camera.scale() / camera.zoom(), target_min = 12 * pixel, slack = 3 * pixel;
    std::optional<std::size_t> found;
    bool found_inside = false;
    double nearest = 0; // distance to the found one: to its centre if it contains the point, otherwise to its edge
    for (std::size_t i = 0, size = organisms.size(); i < size; ++i) {
        const auto [x_px, y_px] = organisms[i];
        const double radius = static_cast<double>(organisms.entities->radius_px(i));
        const double x = x_px - world.x, y = y_px - world.y, reach = std::max(radius + slack, target_min);
        if (x * x + y * y > reach * reach) {
            continue;
        }
        const double distance = std::sqrt(x * x + y * y);
        const bool inside = distance <= radius;
        const double measure = inside ? distance : distance - radius;
        if (!found || (inside && !found_inside) || (inside == found_inside && measure < nearest)) {
            found = i;
            found_inside = inside;
            nearest = measure;
        }
    }
    return found;
}

namespace {

/// Adds the entities of the tiles that are streamed as dots.
void add_dots(const codec::ReceivedSnapshot& snapshot, codec::DecodedDots::Places codec::DecodedDots::*which,
              double radius_px, std::vector<Shape>& shapes) {
    const auto radius = static_cast<float>(radius_px);
    for (const codec::DecodedTile& tile : snapshot.tiles) {
        const auto& places = tile.dots.*which;
        for (std::size_t i = 0; i < places.x_px.size(); ++i) {
            shapes.push_back({places.x_px[i], places.y_px[i], radius, radius});
        }
    }
}

} // namespace

void IslandRenderer::set_dots(Layer& layer, const codec::ReceivedSnapshot& snapshot,
                              codec::DecodedDots::Places codec::DecodedDots::*which, double radius_px) {
    reused_.shapes.clear();
    add_dots(snapshot, which, radius_px, reused_.shapes);
    layer.set(reused_.shapes);
}

void IslandRenderer::set_items(const codec::ReceivedSnapshot& snapshot) {
    const double radius_px = snapshot.about.item_radius_px();
    const auto radius = static_cast<float>(radius_px);
    const auto read = [&](const codec::Entities& items, codec::DecodedDots::Places codec::DecodedDots::*dots,
                          std::vector<Shape>& shapes) {
        shapes.clear();
        for (std::size_t i = 0; i < items.x.size(); ++i) {
            shapes.push_back({items.x_px(i), items.y_px(i), radius, radius});
        }
        add_dots(snapshot, dots, radius_px, shapes);
    };
    read(snapshot.entities->food, &codec::DecodedDots::food, reused_.food_shapes);
    read(snapshot.entities->poison, &codec::DecodedDots::poison, reused_.shapes);
    layers_.food.set(reused_.food_shapes);
    layers_.poison.set(reused_.shapes);
    // The same share of both, so that the dots show which kind is more frequent.
    const std::size_t most = std::max({reused_.food_shapes.size(), reused_.shapes.size(), std::size_t{1}});
    const double share = static_cast<double>(item_dots_max) / static_cast<double>(most);
    keep_share(share, reused_.food_shapes);
    keep_share(share, reused_.shapes);
    layers_.few_food.set(reused_.food_shapes);
    layers_.few_poison.set(reused_.shapes);
}

void IslandRenderer::set_boxes(Layer& layer, const Positions& boxes) {
    reused_.shapes.resize(boxes.size());
    for (std::size_t i = 0; i < reused_.shapes.size(); ++i) {
        const auto [x, y] = boxes[i];
        reused_.shapes[i] = {x, y, boxes.entities->half_width_px(i), boxes.entities->half_height_px(i)};
    }
    layer.set(reused_.shapes);
}

void IslandRenderer::upload_snapshot(const std::shared_ptr<const codec::ReceivedSnapshot>& snapshot) {
    if (snapshot == uploaded_) {
        return;
    }
    uploaded_ = snapshot;
    items_uploaded_ = false;
    set_boxes(layers_.obstacles, {.entities = &snapshot->entities->obstacles});
    full_health_ = health_scale(snapshot->entities->organisms, {}).high;
}

/// Draws the ground and the walls. The walls lie outside the island and have the same thickness at any zoom.
void IslandRenderer::draw_walls(const codec::ReceivedSnapshot& snapshot, const Camera& camera, Look look) {
    const palette::IslandColours& colours = palette::of(look);
    const Rectangle inside = on_screen(camera, snapshot.about);
    const double thickness = Camera::wall_pixels * camera.scale();
    if (const ShapeStyle& style = styles_of(look).shadow; style.fill.alpha > 0) {
        const auto beyond = static_cast<float>(thickness / camera.zoom());
        const auto further = static_cast<float>(Camera::margin_pixels * camera.scale() / camera.zoom());
        const float left = -beyond, top = -beyond, right = static_cast<float>(snapshot.about.width_px()) + beyond,
                    bottom = static_cast<float>(snapshot.about.height_px()) + beyond;
        layers_.shadow.set(std::array{
            Line{left - further, top, right + further, top}, Line{left - further, bottom, right + further, bottom},
            Line{left, top - further, left, bottom + further}, Line{right, top - further, right, bottom + further}});
        painter_.draw(layers_.shadow, style);
    }
    painter_.fill(
        {inside.left - thickness, inside.top - thickness, inside.width + 2 * thickness, inside.height + 2 * thickness},
        colours.wall);
    painter_.fill(inside, colours.ground);
}

void IslandRenderer::draw(const core::SnapshotInterpolator& view, double blend, const Camera& camera,
                          unsigned width_pixels, unsigned height_pixels, const IslandView& island_view,
                          const Highlighted& highlighted) {
    const Look look = island_view.options.look;
    const Styles& styles = styles_of(look);
    painter_.begin(camera, width_pixels, height_pixels);
    painter_.fill(camera.viewport(), palette::of(look).outside);
    density_scale_.reset();
    if (const auto& snapshot = view.latest()) {
        upload_snapshot(snapshot);
        set_boxes(layers_.crates, view.crates_at(blend));
        const Positions organisms = view.organisms_at(blend);
        draw_walls(*snapshot, camera, look);
        painter_.draw(layers_.obstacles, styles.obstacle);
        painter_.draw(layers_.crates, styles.crate);
        // After a change of the level of detail, draw densities until the first snapshot with the new detail arrives.
        const bool has_densities = std::ranges::any_of(
            snapshot->tiles, [](const auto& tile) { return tile.detail == evod::v1::DETAIL_DENSITY; });
        if (island_view.shows_density(camera, *snapshot) || has_densities) {
            draw_density(*snapshot, organisms, camera, island_view);
        } else {
            draw_items(*snapshot, camera, styles);
            reused_.discs.clear();
            add_discs(organisms, reused_.discs);
            const auto chosen = [&](Which which) {
                Chosen indices;
                if (which == Which::Pointed) {
                    indices.emplace();
                    for (const auto& index : {highlighted.pointed_at, highlighted.selected}) {
                        if (index && *index < reused_.discs.size()) {
                            indices->push_back(*index);
                        }
                    }
                }
                return indices;
            };
            painter_.clip(on_screen(camera, snapshot->about));
            draw_radii(*organisms.entities, camera, island_view, chosen(island_view.options.radii));
            draw_trails(*snapshot, camera, island_view);
            const double behind_s =
                view.previous() ? snapshot->about.simulated_s() - view.previous()->about.simulated_s() : 0;
            draw_flashes(snapshot->about.simulated_s() - (1 - blend) * behind_s, island_view);
            painter_.clip_to_viewport();
            draw_organisms(*organisms.entities, camera, island_view);
            draw_headings(organisms, camera, styles);
            painter_.clip(on_screen(camera, snapshot->about));
            draw_forces(*organisms.entities, camera, island_view, chosen(island_view.options.forces));
            painter_.clip_to_viewport();
        }
        const auto highlight = [&](std::optional<std::size_t> index, Layer& layer, const ShapeStyle& style) {
            if (index && *index < organisms.size()) {
                const auto [x, y] = organisms[*index];
                const double beyond = static_cast<double>(styles.highlight_pixels) * camera.scale() / camera.zoom();
                const float radius = organisms.entities->radius_px(*index) + static_cast<float>(beyond);
                layer.set(std::array{Shape{x, y, radius, radius}});
                painter_.draw(layer, style);
            }
        };
        highlight(highlighted.selected, layers_.selected, styles.selected);
        highlight(highlighted.pointed_at, layers_.pointed_at, styles.pointed_at);
    }
    painter_.end();
}

void IslandRenderer::draw_items(const codec::ReceivedSnapshot& snapshot, const Camera& camera, const Styles& styles) {
    if (!std::exchange(items_uploaded_, true)) {
        set_items(snapshot);
        set_dots(layers_.organism_dots, snapshot, &codec::DecodedDots::organisms, typical_radius_px);
        set_dots(layers_.crate_dots, snapshot, &codec::DecodedDots::crates, typical_radius_px);
        set_dots(layers_.obstacle_dots, snapshot, &codec::DecodedDots::obstacles, typical_radius_px);
    }
    const bool small = too_small_to_see(camera);
    painter_.draw(layers_.obstacle_dots, styles.obstacle);
    painter_.draw(layers_.crate_dots, styles.crate);
    painter_.draw(small ? layers_.few_poison : layers_.poison, small ? styles.poison_dot : styles.poison);
    painter_.draw(small ? layers_.few_food : layers_.food, small ? styles.food_dot : styles.food);
    painter_.draw(layers_.organism_dots, styles.organism_dot);
}

void IslandRenderer::draw_organisms(const codec::Entities& organisms, const Camera& camera,
                                    const IslandView& island_view) {
    const Styles& styles = styles_of(island_view.options.look);
    if (styles.organism.form == Form::Body) {
        set_health(organisms, full_health_, reused_.discs);
    }
    reused_.colours.clear();
    if (island_view.options.colour_by == ColourBy::Nothing) {
        return draw_species(organisms, styles.organism, styles.predator);
    }
    const Population* population = island_view.population();
    if (island_view.options.colour_by == ColourBy::Health) {
        add_health_colours(organisms, ColourScale{island_view.options.ramp, 0, full_health_}, reused_.colours);
    } else if (population != nullptr && island_view.options.gene < population->gene_count()) {
        add_gene_colours(organisms, *population, island_view.options.gene,
                         gene_scale(*population, island_view.options.gene, island_view.options.ramp), reused_.colours);
    } else {
        reused_.colours.assign(reused_.discs.size(), palette::unknown);
    }
    ShapeStyle style = styles.coloured;
    if (camera.zoom() < outline_zoom_min) {
        style.edge_pixels = 0;
    }
    draw_species(organisms, style, styles.predator);
}

/// Draws the prey as discs and the predators as triangles, with the colours in `reused_` if there are any.
void IslandRenderer::draw_species(const codec::Entities& organisms, const ShapeStyle& prey,
                                  const ShapeStyle& predator) {
    if (!organisms.has_species()) {
        layers_.organisms.set(reused_.discs, reused_.colours);
        return painter_.draw(layers_.organisms, prey);
    }
    const auto draw = [&](bool predators, Layer& layer, const ShapeStyle& style) {
        reused_.shapes.clear();
        reused_.species_colours.clear();
        for (std::size_t i = 0; i < reused_.discs.size(); ++i) {
            if ((organisms.species_of(i) == evod::v1::SPECIES_PREDATOR) == predators) {
                reused_.shapes.push_back(reused_.discs[i]);
                if (!reused_.colours.empty()) {
                    reused_.species_colours.push_back(reused_.colours[i]);
                }
            }
        }
        layer.set(reused_.shapes, reused_.species_colours);
        painter_.draw(layer, style);
    };
    draw(false, layers_.organisms, prey);
    draw(true, layers_.predators, predator);
}

/// Draws the headings of organisms that are large enough for them to be seen.
void IslandRenderer::draw_headings(const Positions& organisms, const Camera& camera, const Styles& styles) {
    constexpr double radius_pixels_min = 2;
    const double radius_pixels = typical_radius_px * camera.zoom() / camera.scale();
    if (organisms.size() == 0 || !organisms.entities->has_headings() || radius_pixels < radius_pixels_min) {
        return;
    }
    reused_.lines.clear();
    // Lines of small organisms are shorter.
    const double beyond_pixels = std::min(static_cast<double>(styles.heading_pixels), radius_pixels + 4);
    const double beyond_px = beyond_pixels * camera.scale() / camera.zoom();
    add_headings(organisms, reused_.discs, camera.visible(), static_cast<float>(beyond_px), reused_.lines);
    layers_.headings.set(reused_.lines);
    painter_.draw(layers_.headings, styles.heading);
}

void IslandRenderer::draw_density(const codec::ReceivedSnapshot& snapshot, const Positions& at, const Camera& camera,
                                  const IslandView& island_view) {
    auto grids = densities_of(snapshot);
    if (grids.empty()) { // a whole snapshot, or tiles with complete organisms
        grids.push_back(density_of(at, camera.visible(), viewer::density_cell_px(camera, density_cell_pixels)));
    }
    density_cell_px_ = grids.front().cell_px;
    density_scale_ = viewer::density_scale(grids, island_view.options.ramp);
    reused_.shapes.clear();
    reused_.colours.clear();
    for (const DensityGrid& grid : grids) {
        add_density(grid, {snapshot.about.width_px(), snapshot.about.height_px()}, *density_scale_, reused_.shapes,
                    reused_.colours);
    }
    layers_.density.set(reused_.shapes, reused_.colours);
    painter_.draw(layers_.density, density_style);
}

void IslandRenderer::draw_radii(const codec::Entities& organisms, const Camera& camera, const IslandView& island_view,
                                const Chosen& chosen) {
    const Population* population = island_view.population();
    if (island_view.options.radii == Which::None || population == nullptr || !shows_details(camera)) {
        return;
    }
    const Styles& styles = styles_of(island_view.options.look);
    for (const auto& [name, style] : {std::pair<std::string_view, const ShapeStyle&>{"food_radius", styles.food_radius},
                                      {"poison_radius", styles.poison_radius}}) {
        if (const auto gene = gene_named(name, island_view)) {
            reused_.shapes.clear();
            add_radii(organisms, reused_.discs, *population, *gene, camera.visible(), chosen, reused_.shapes);
            layers_.radii.set(reused_.shapes);
            painter_.draw(layers_.radii, style);
        }
    }
}

void IslandRenderer::draw_forces(const codec::Entities& organisms, const Camera& camera, const IslandView& island_view,
                                 const Chosen& chosen) {
    const Population* population = island_view.population();
    if (island_view.options.forces == Which::None || population == nullptr || !shows_details(camera)) {
        return;
    }
    reused_.arrow_lines.clear();
    reused_.target_lines.clear();
    add_forces(organisms, reused_.discs, *population, camera.visible(), chosen, palette::of(island_view.options.look),
               reused_.arrow_lines, reused_.target_lines);
    const Styles& styles = styles_of(island_view.options.look);
    layers_.targets.set(reused_.target_lines.lines, reused_.target_lines.colours);
    painter_.draw(layers_.targets, styles.target);
    layers_.arrows.set(reused_.arrow_lines.lines, reused_.arrow_lines.colours);
    painter_.draw(layers_.arrows, styles.arrow);
}

void IslandRenderer::draw_trails(const codec::ReceivedSnapshot& snapshot, const Camera& camera,
                                 const IslandView& island_view) {
    const auto& snapshots = island_view.trails().snapshots();
    if (!island_view.options.trails || snapshots.empty() || !shows_traces(camera, snapshot)) {
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
            reused_.shapes.clear();
            reused_.lines.clear();
            add_discs({.entities = &to}, reused_.shapes);
            add_paths(snapshots[i - 1]->entities->organisms, to, reused_.shapes, reused_.lines);
            trail_segments_.back().layer->set(reused_.lines);
        }
    }
    const ShapeStyle& style = styles_of(island_view.options.look).trail;
    const double now_s = snapshot.about.simulated_s();
    for (const TrailSegment& segment : trail_segments_) {
        painter_.draw(*segment.layer, aged(style, (now_s - segment.to->about.simulated_s()) / Trails::kept_s));
    }
    reused_.lines.clear();
    add_paths(snapshots.back()->entities->organisms, snapshot.entities->organisms, reused_.discs, reused_.lines);
    layers_.trail_ends.set(reused_.lines);
    painter_.draw(layers_.trail_ends, style);
}

/// Draws each flash as a growing and fading disc in the colour of what was eaten or died.
void IslandRenderer::draw_flashes(double now_s, const IslandView& island_view) {
    if (!island_view.options.flashes) {
        return;
    }
    const palette::IslandColours& of = palette::of(island_view.options.look);
    reused_.shapes.clear();
    reused_.colours.clear();
    for (const Flash& flash : island_view.flashes().all()) {
        const double age = (now_s - flash.began_s) / Flashes::shown_s;
        if (age < 0 || age >= 1) { // it begins after the shown time, which is interpolated
            continue;
        }
        const bool death = flash.kind == Flash::Kind::Death;
        Colour colour = death ? of.death : flash.kind == Flash::Kind::Food ? of.food : of.poison;
        colour.alpha = static_cast<std::uint8_t>(255 * (1 - age));
        const auto radius = static_cast<float>(flash.radius_px * (1.5 + (death ? 2 : 3.5) * std::sqrt(age)));
        reused_.shapes.push_back({flash.x_px, flash.y_px, radius, radius});
        reused_.colours.push_back(colour);
    }
    if (!reused_.shapes.empty()) {
        layers_.flashes.set(reused_.shapes, reused_.colours);
        painter_.draw(layers_.flashes, styles_of(island_view.options.look).ripple);
    }
}

void IslandRenderer::draw_labels(const core::SnapshotInterpolator& view, double blend, const Camera& camera, Look look,
                                 const Highlighted& highlighted, std::span<const std::size_t> healthiest,
                                 ImDrawList& list, ImFont& font) {
    const auto& snapshot = view.latest();
    if (!snapshot) {
        return;
    }
    const Positions organisms = view.organisms_at(blend);
    const double zoom_min = static_cast<double>(styles_of(look).label_zoom_min);
    reused_.labelled.clear();
    if (labels_are_readable(camera, 0, zoom_min)) {
        const Rectangle visible = camera.visible();
        for (std::size_t i = 0, size = organisms.size(); i < size; ++i) {
            const auto [x, y] = organisms[i];
            if (visible.contains({x, y})) {
                reused_.labelled.push_back(i);
            }
        }
    }
    // Where labels compete for a place, the first one gets it.
    reused_.named.clear();
    const auto add_name = [&](std::size_t index) {
        if (index < organisms.size() && std::ranges::find(reused_.named, index) == reused_.named.end()) {
            reused_.named.push_back(index);
        }
    };
    for (const auto& index : {highlighted.selected, highlighted.pointed_at}) {
        if (index) {
            add_name(*index);
        }
    }
    if (organisms.size() <= with_names_max) {
        std::ranges::for_each(healthiest, add_name);
    }
    std::ranges::stable_partition(reused_.labelled, [&](std::size_t index) {
        return std::ranges::find(reused_.named, index) != reused_.named.end();
    });
    if (reused_.labelled.empty() || !labels_are_readable(camera, reused_.labelled.size(), zoom_min)) {
        reused_.labelled = reused_.named;
    }
    const auto text_of = [&](std::size_t i) {
        const std::string health = std::to_string(shown_health(organisms.entities->health(i)));
        return std::ranges::find(reused_.named, i) == reused_.named.end()
                   ? health
                   : "#" + std::to_string(organisms.entities->id[i]) + " " + health;
    };
    const ShapeStyle& style = styles_of(look).organism;
    const double arc = style.form == Form::Body ? 1.6 * camera.scale() * double{style.edge_pixels} : 0; // around a body
    const auto label_of = [&](std::size_t i, double width) {
        const auto [x, y] = organisms[i];
        return HealthLabel{camera.to_screen({x, y}), organisms.entities->radius_px(i) * camera.zoom() + arc, width};
    };
    reused_.labels.clear();
    for (const std::size_t i : reused_.labelled) {
        reused_.labels.push_back(label_of(i, double{size_of(text_of(i), font).x} + 2 * label_padding));
    }
    reused_.obstacles.clear();
    if (organisms.size() <= with_names_max) {
        for (std::size_t i = 0, size = organisms.size(); i < size; ++i) {
            reused_.obstacles.push_back(label_of(i, 0));
        }
    }
    const double height = double{font.FontSize};
    const auto corners = place_labels(reused_.labels, reused_.obstacles, height, on_screen(camera, snapshot->about));
    const palette::IslandColours& colours = palette::of(look);
    for (std::size_t i = 0; i < reused_.labelled.size(); ++i) {
        if (!corners[i]) {
            continue;
        }
        const auto left = static_cast<float>(corners[i]->x), top = static_cast<float>(corners[i]->y);
        const auto right = static_cast<float>(corners[i]->x + reused_.labels[i].width);
        list.AddRectFilled({left, top}, {right, top + font.FontSize}, ink(faint(colours.ground, 200)), 2);
        write(list, font, {left + static_cast<float>(label_padding), top}, colours.label, text_of(reused_.labelled[i]));
    }
}

} // namespace evod::viewer
