#include "client/viewer/scene.h"

#include <imgui.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <span>

namespace evod::viewer {

namespace {

constexpr float label_pixels = 14;      // height of the numbers
constexpr double label_zoom_min = 0.45; // below it an organism is smaller than its number

const Look food_look{.fill = palette::food, .half_pixels_min = 1};
const Look poison_look{.fill = palette::poison, .half_pixels_min = 1};
const Look obstacle_look{.round = false, .fill = palette::obstacle, .half_pixels_min = 1};
const Look crate_look{
    .round = false, .fill = palette::crate, .edge = palette::crate_edge, .edge_pixels = 2, .half_pixels_min = 1};
const Look organism_look{.fill = {0, 0, 0, 0}, .edge = palette::organism, .edge_pixels = 2, .half_pixels_min = 1.5f};
const Look pointed_at_look{
    .fill = {255, 255, 255, 90}, .edge = palette::organism_pointed_at, .edge_pixels = 3, .half_pixels_min = 4};
const Look wall_look{
    .round = false, .fill = {0, 0, 0, 0}, .edge = palette::wall, .edge_pixels = float(Camera::wall_pixels)};

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

std::optional<std::size_t> organism_at(Point screen, const wire::Picture& picture,
                                       const link::WorldView::Positions& organisms, const Camera& camera) {
    if (!camera.viewport().contains(screen)) {
        return std::nullopt;
    }
    const Point world = camera.to_world(screen);
    const double slack = 3 / camera.zoom();
    std::optional<std::size_t> found;
    double nearest = 0;
    for (std::size_t i = 0; i < organisms.x_px.size(); ++i) {
        const double distance = std::hypot(organisms.x_px[i] - world.x, organisms.y_px[i] - world.y);
        if (distance <= picture.organisms.radius_px[i] + slack && (!found || distance < nearest)) {
            found = i;
            nearest = distance;
        }
    }
    return found;
}

void Scene::set_circles(Layer& layer, const wire::ItemPicture& items, float radius) {
    shapes_.resize(items.x_px.size());
    for (std::size_t i = 0; i < shapes_.size(); ++i) {
        shapes_[i] = {items.x_px[i], items.y_px[i], radius, radius};
    }
    layer.set(shapes_);
}

void Scene::set_boxes(Layer& layer, const wire::BoxPicture& boxes, const std::vector<float>& x,
                      const std::vector<float>& y) {
    shapes_.resize(x.size());
    for (std::size_t i = 0; i < shapes_.size(); ++i) {
        shapes_[i] = {x[i], y[i], boxes.half_width_px[i], boxes.half_height_px[i]};
    }
    layer.set(shapes_);
}

void Scene::upload_picture(const std::shared_ptr<const wire::Picture>& picture, const Camera& camera) {
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

void Scene::draw(link::WorldView& view, double blend, const Camera& camera, unsigned width_pixels,
                 unsigned height_pixels, std::optional<std::size_t> pointed_at) {
    painter_.begin(camera, width_pixels, height_pixels, palette::background);
    if (const auto& picture = view.latest()) {
        upload_picture(picture, camera);
        const auto& crates = view.crates_at(blend);
        set_boxes(crates_, picture->crates, crates.x_px, crates.y_px);
        const auto& organisms = view.organisms_at(blend);
        shapes_.resize(organisms.x_px.size());
        for (std::size_t i = 0; i < shapes_.size(); ++i) {
            const float radius = picture->organisms.radius_px[i];
            shapes_[i] = {organisms.x_px[i], organisms.y_px[i], radius, radius};
        }
        organisms_.set(shapes_);
        painter_.draw(walls_, wall_look);
        painter_.draw(obstacles_, obstacle_look);
        painter_.draw(crates_, crate_look);
        painter_.draw(poison_, poison_look);
        painter_.draw(food_, food_look);
        painter_.draw(organisms_, organism_look);
        if (pointed_at && *pointed_at < shapes_.size()) {
            pointed_at_.set(std::array{shapes_[*pointed_at]});
            painter_.draw(pointed_at_, pointed_at_look);
        }
    }
    painter_.end();
}

void Scene::draw_labels(link::WorldView& view, double blend, const Camera& camera, ImDrawList& list, ImFont& font) {
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
    const Colour ink = palette::health;
    const Point corner = camera.to_screen({0, 0});
    const Point other = camera.to_screen({picture->about.width_px(), picture->about.height_px()});
    for (const std::size_t i : labelled_) {
        std::array<char, 16> digits;
        const char* end = std::to_chars(digits.begin(), digits.end(), shown_health(picture->organisms.health[i])).ptr;
        const Point centre = camera.to_screen({organisms.x_px[i], organisms.y_px[i]});
        const double radius = picture->organisms.radius_px[i] * camera.zoom();
        const double width = font.CalcTextSizeA(label_pixels, 1e9f, 0, digits.data(), end).x;
        // Black on the black wall could not be read: at a side the number moves inwards, at the top below the organism.
        const double above = centre.y - radius - label_pixels - 1;
        const double top = above < corner.y ? centre.y + radius + 1 : above;
        const double left = std::max(std::min(centre.x - width / 2, other.x - width - 1), corner.x + 1);
        // Whole pixels keep the glyphs sharp.
        const ImVec2 place{static_cast<float>(std::floor(left)), static_cast<float>(std::floor(top))};
        list.AddText(&font, label_pixels, place, IM_COL32(ink.red, ink.green, ink.blue, ink.alpha), digits.data(), end);
    }
}

} // namespace evod::viewer
