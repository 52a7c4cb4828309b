#include "client/viewer/scene/scene.h"

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

constexpr float label_pixels = 14;      // height of the numbers, at scale 1
constexpr double label_zoom_min = 0.45; // below it an organism is smaller than its number

const Look food_look{.fill = palette::food, .half_pixels_min = 1};
const Look poison_look{.fill = palette::poison, .half_pixels_min = 1};
const Look obstacle_look{.form = Form::Rectangle, .fill = palette::obstacle, .half_pixels_min = 1};
const Look crate_look{.form = Form::Rectangle,
                      .fill = palette::crate,
                      .edge = palette::crate_edge,
                      .edge_pixels = 2,
                      .half_pixels_min = 1};
const Look organism_look{.fill = {0, 0, 0, 0}, .edge = palette::organism, .edge_pixels = 2, .half_pixels_min = 1.5f};
const Look pointed_at_look{
    .fill = {255, 255, 255, 90}, .edge = palette::organism_pointed_at, .edge_pixels = 3, .half_pixels_min = 4};
const Look wall_look{
    .form = Form::Rectangle, .fill = {0, 0, 0, 0}, .edge = palette::wall, .edge_pixels = float(Camera::wall_pixels)};

// A disc in its colour; the line around it sets it off from the ground where it is large enough.
const Look coloured_look{.edge = palette::organism_outline, .edge_pixels = 1, .half_pixels_min = 1.5f};
const Look coloured_small_look{.half_pixels_min = 1.5f};
constexpr double outline_zoom_min = 0.3;
const Look selected_look{.fill = {0, 0, 0, 0}, .edge = palette::selected, .edge_pixels = 3, .half_pixels_min = 6};
const Look density_look{.form = Form::Rectangle};
const Look food_radius_look{.fill = {0, 0, 0, 0}, .edge = palette::food_radius, .edge_pixels = 1};
const Look poison_radius_look{.fill = {0, 0, 0, 0}, .edge = palette::poison_radius, .edge_pixels = 1};
const Look arrow_look{.form = Form::Arrow, .line_pixels = 2};
const Look target_look{.form = Form::Line, .line_pixels = 1};
constexpr double marks_zoom_min = 0.05; // below it rings and arrows are a carpet

constexpr double density_cell_pixels = 5;

Look trail_look(double age_share) {
    Look look{.form = Form::Line, .fill = palette::trail, .line_pixels = 1.5f};
    look.fill.alpha = static_cast<std::uint8_t>(200 - 160 * std::clamp(age_share, 0.0, 1.0));
    return look;
}

/// The index of a gene in the order of the world's; nullopt if it has none of that name.
std::optional<std::size_t> gene_named(std::string_view name, const Sight& sight) {
    const auto& names = sight.gene_names();
    const auto place = std::ranges::find(names, name);
    return place == names.end() ? std::nullopt : std::optional{static_cast<std::size_t>(place - names.begin())};
}

} // namespace

unsigned shown_health(float health) {
    return health > 0 ? static_cast<unsigned>(std::ceil(health)) : 0;
}

bool labels_are_readable(const Camera& camera, std::size_t visible_count) {
    constexpr double label_area = 2 * label_pixels * label_pixels, covered_max = 0.4;
    const double seen_area = camera.viewport().width * camera.viewport().height;
    return camera.zoom() >= label_zoom_min &&
           static_cast<double>(visible_count) * label_area <= covered_max * seen_area;
}

std::optional<std::size_t> organism_at(Point screen, const codec::DecodedSnapshot& picture,
                                       const core::WorldView::Positions& organisms, const Camera& camera) {
    if (!camera.viewport().contains(screen)) {
        return std::nullopt;
    }
    const Point world = camera.to_world(screen);
    const double slack = 3 / camera.zoom();
    std::optional<std::size_t> found;
    double nearest = 0; // squared
    for (std::size_t i = 0; i < organisms.x_px.size(); ++i) {
        const double x = organisms.x_px[i] - world.x, y = organisms.y_px[i] - world.y, distance = x * x + y * y;
        const double reach = picture.organisms.radius_px[i] + slack;
        if (distance <= reach * reach && (!found || distance < nearest)) {
            found = i;
            nearest = distance;
        }
    }
    return found;
}

void Scene::set_circles(Layer& layer, const codec::DecodedItems& items, float radius) {
    shapes_.resize(items.x_px.size());
    for (std::size_t i = 0; i < shapes_.size(); ++i) {
        shapes_[i] = {items.x_px[i], items.y_px[i], radius, radius};
    }
    layer.set(shapes_);
}

void Scene::set_boxes(Layer& layer, const codec::DecodedBoxes& boxes, const std::vector<float>& x,
                      const std::vector<float>& y) {
    shapes_.resize(x.size());
    for (std::size_t i = 0; i < shapes_.size(); ++i) {
        shapes_[i] = {x[i], y[i], boxes.half_width_px[i], boxes.half_height_px[i]};
    }
    layer.set(shapes_);
}

void Scene::upload_picture(const std::shared_ptr<const codec::DecodedSnapshot>& picture, const Camera& camera) {
    if (picture != uploaded_) {
        uploaded_ = picture;
        const auto item_radius = static_cast<float>(picture->about.item_radius_px());
        set_circles(food_, picture->food, item_radius);
        set_circles(poison_, picture->poison, item_radius);
        set_boxes(obstacles_, picture->obstacles, picture->obstacles.x_px, picture->obstacles.y_px);
    }
    // The walls stand around the island, as thick at any zoom.
    const auto half_width = static_cast<float>(picture->about.width_px() / 2);
    const auto half_height = static_cast<float>(picture->about.height_px() / 2);
    const auto thickness = static_cast<float>(Camera::wall_pixels / camera.zoom());
    walls_.set(std::array{Shape{half_width, half_height, half_width + thickness, half_height + thickness}});
}

void Scene::draw(core::WorldView& view, double blend, const Camera& camera, unsigned width_pixels,
                 unsigned height_pixels, const Sight& sight, const Marked& marked) {
    painter_.begin(camera, width_pixels, height_pixels, palette::background);
    density_scale_.reset();
    if (const auto& picture = view.latest()) {
        upload_picture(picture, camera);
        const auto& crates = view.crates_at(blend);
        set_boxes(crates_, picture->crates, crates.x_px, crates.y_px);
        const Positions& organisms = view.organisms_at(blend);
        painter_.draw(walls_, wall_look);
        painter_.draw(obstacles_, obstacle_look);
        painter_.draw(crates_, crate_look);
        // Those that have come are also shown until what was asked for in their place is there.
        const bool densities_came = std::ranges::any_of(
            picture->tiles, [](const auto& tile) { return tile.detail == evod::v1::DETAIL_DENSITY; });
        if (sight.shows_density(camera) || densities_came) {
            draw_density(*picture, organisms, camera, sight);
        } else {
            draw_items(*picture);
            draw_radii(*picture, organisms, camera, sight);
            draw_trails(*picture, organisms, camera, sight);
            draw_organisms(*picture, organisms, camera, sight);
            draw_forces(*picture, organisms, camera, sight);
        }
        const auto mark = [&](std::optional<std::size_t> index, Layer& layer, const Look& look) {
            if (index && *index < organisms.x_px.size()) {
                const float radius = picture->organisms.radius_px[*index];
                layer.set(std::array{Shape{organisms.x_px[*index], organisms.y_px[*index], radius, radius}});
                painter_.draw(layer, look);
            }
        };
        mark(marked.selected, selected_, selected_look);
        mark(marked.pointed_at, pointed_at_, pointed_at_look);
    }
    painter_.end();
}

void Scene::draw_items(const codec::DecodedSnapshot& picture) {
    painter_.draw(poison_, poison_look);
    painter_.draw(food_, food_look);
    // Of tiles that are told in dots: where everything is, and nothing more.
    const auto draw_dots = [&](codec::DecodedDots::Places codec::DecodedDots::*which, double radius_px,
                               const Look& look) {
        shapes_.clear();
        const auto radius = static_cast<float>(radius_px);
        for (const codec::DecodedTile& tile : picture.tiles) {
            const auto& places = tile.dots.*which;
            for (std::size_t i = 0; i < places.x_px.size(); ++i) {
                shapes_.push_back({places.x_px[i], places.y_px[i], radius, radius});
            }
        }
        if (!shapes_.empty()) {
            dots_.set(shapes_);
            painter_.draw(dots_, look);
        }
    };
    draw_dots(&codec::DecodedDots::obstacles, ordinary_radius_px, obstacle_look);
    draw_dots(&codec::DecodedDots::crates, ordinary_radius_px, crate_look);
    draw_dots(&codec::DecodedDots::poison, picture.about.item_radius_px(), poison_look);
    draw_dots(&codec::DecodedDots::food, picture.about.item_radius_px(), food_look);
    draw_dots(&codec::DecodedDots::organisms, ordinary_radius_px, organism_look);
}

void Scene::draw_organisms(const codec::DecodedSnapshot& picture, const Positions& at, const Camera& camera,
                           const Sight& sight) {
    shapes_.clear();
    colours_.clear();
    put_discs(at, picture.organisms.radius_px, shapes_);
    if (sight.shown.colour_by == ColourBy::Nothing) {
        organisms_.set(shapes_);
        return painter_.draw(organisms_, organism_look);
    }
    const Population* population = sight.population();
    if (sight.shown.colour_by == ColourBy::Health) {
        put_health_colours(picture.organisms, health_scale(picture.organisms, sight.shown.ramp), colours_);
    } else if (population != nullptr && sight.shown.colour_by == ColourBy::Lineage) {
        put_family_colours(picture.organisms, *population, sight.family_colours(), colours_);
    } else if (population != nullptr && sight.shown.gene < population->gene_count()) {
        put_gene_colours(picture.organisms, *population, sight.shown.gene,
                         gene_scale(*population, sight.shown.gene, sight.shown.ramp), colours_);
    } else {
        colours_.assign(shapes_.size(), palette::unknown);
    }
    organisms_.set(shapes_, colours_);
    painter_.draw(organisms_, camera.zoom() >= outline_zoom_min ? coloured_look : coloured_small_look);
}

void Scene::draw_density(const codec::DecodedSnapshot& picture, const Positions& at, const Camera& camera,
                         const Sight& sight) {
    auto grids = densities_of(picture);
    if (grids.empty()) { // a whole picture, or tiles that are still told in full
        grids.push_back(density_of(at, camera.visible(), viewer::density_cell_px(camera, density_cell_pixels)));
    }
    density_cell_px_ = grids.front().cell_px;
    density_scale_ = viewer::density_scale(grids, sight.shown.ramp);
    shapes_.clear();
    colours_.clear();
    for (const DensityGrid& grid : grids) {
        put_density(grid, {picture.about.width_px(), picture.about.height_px()}, *density_scale_, shapes_, colours_);
    }
    density_.set(shapes_, colours_);
    painter_.draw(density_, density_look);
}

void Scene::draw_radii(const codec::DecodedSnapshot& picture, const Positions& at, const Camera& camera,
                       const Sight& sight) {
    const Population* population = sight.population();
    if (!sight.shown.radii || population == nullptr || camera.zoom() < marks_zoom_min) {
        return;
    }
    for (const auto& [name, look] : {std::pair<std::string_view, const Look&>{"food_radius", food_radius_look},
                                     {"poison_radius", poison_radius_look}}) {
        if (const auto gene = gene_named(name, sight)) {
            shapes_.clear();
            put_radii(picture.organisms, at, *population, *gene, camera.visible(), shapes_);
            radii_.set(shapes_);
            painter_.draw(radii_, look);
        }
    }
}

void Scene::draw_forces(const codec::DecodedSnapshot& picture, const Positions& at, const Camera& camera,
                        const Sight& sight) {
    const Population* population = sight.population();
    if (!sight.shown.forces || population == nullptr || camera.zoom() < marks_zoom_min) {
        return;
    }
    arrow_lines_.clear();
    target_lines_.clear();
    put_forces(picture.organisms, at, *population, camera.visible(), arrow_lines_, target_lines_);
    targets_.set(target_lines_.lines, target_lines_.colours);
    painter_.draw(targets_, target_look);
    arrows_.set(arrow_lines_.lines, arrow_lines_.colours);
    painter_.draw(arrows_, arrow_look);
}

void Scene::draw_trails(const codec::DecodedSnapshot& picture, const Positions& at, const Camera& camera,
                        const Sight& sight) {
    const auto& pictures = sight.trails().pictures();
    if (!sight.shown.trails || pictures.empty() || camera.zoom() < marks_zoom_min) {
        ways_.clear();
        return;
    }
    std::erase_if(ways_, [&](const Ways& ways) { return std::ranges::find(pictures, ways.from) == pictures.end(); });
    for (std::size_t i = 1; i < pictures.size(); ++i) {
        if (std::ranges::find(ways_, pictures[i], &Ways::to) == ways_.end()) {
            ways_.push_back({pictures[i - 1], pictures[i], std::make_unique<Layer>()});
            const auto& to = pictures[i]->organisms;
            lines_.clear();
            put_ways(pictures[i - 1]->organisms, to, to.x_px, to.y_px, lines_);
            ways_.back().layer->set(lines_);
        }
    }
    const double now_s = picture.about.simulated_s();
    for (const Ways& ways : ways_) {
        painter_.draw(*ways.layer, trail_look((now_s - ways.to->about.simulated_s()) / Trails::kept_s));
    }
    lines_.clear();
    put_ways(pictures.back()->organisms, picture.organisms, at.x_px, at.y_px, lines_);
    trail_ends_.set(lines_);
    painter_.draw(trail_ends_, trail_look(0));
}

void Scene::draw_labels(core::WorldView& view, double blend, const Camera& camera, ImDrawList& list, ImFont& font) {
    const auto& picture = view.latest();
    if (!picture || camera.zoom() < label_zoom_min) {
        return;
    }
    const auto& organisms = view.organisms_at(blend);
    const Rectangle seen = camera.visible();
    labelled_.clear();
    for (std::size_t i = 0; i < organisms.x_px.size(); ++i) {
        if (seen.contains({organisms.x_px[i], organisms.y_px[i]})) {
            labelled_.push_back(i);
        }
    }
    if (!labels_are_readable(camera, labelled_.size())) {
        return;
    }
    const Point corner = camera.to_screen({0, 0});
    const Point other = camera.to_screen({picture->about.width_px(), picture->about.height_px()});
    for (const std::size_t i : labelled_) {
        std::array<char, 16> room;
        const char* end = std::to_chars(room.begin(), room.end(), shown_health(picture->organisms.health[i])).ptr;
        const std::string_view digits{room.data(), static_cast<std::size_t>(end - room.data())};
        const Point centre = camera.to_screen({organisms.x_px[i], organisms.y_px[i]});
        const double radius = picture->organisms.radius_px[i] * camera.zoom();
        const double width = size_of(digits, font).x;
        // Black on the black wall could not be read: at a side the number moves inwards, at the top below the organism.
        const double above = centre.y - radius - font.FontSize - 1;
        const double top = above < corner.y ? centre.y + radius + 1 : above;
        const double left = std::max(std::min(centre.x - width / 2, other.x - width - 1), corner.x + 1);
        write(list, font, {static_cast<float>(left), static_cast<float>(top)}, palette::health, digits);
    }
}

} // namespace evod::viewer
