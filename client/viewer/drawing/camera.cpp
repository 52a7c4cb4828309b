#include "client/viewer/drawing/camera.h"

#include <algorithm>

namespace evod::viewer {

void Camera::set_viewport(Rectangle screen, double scale) {
    scale_ = scale;
    viewport_ = {screen.left, screen.top, std::max(screen.width, 1.0), std::max(screen.height, 1.0)};
    if (fitted_) {
        fit();
    } else {
        stay_on_island();
    }
}

void Camera::set_island(double width, double height) {
    if (width == island_width_ && height == island_height_) {
        return;
    }
    island_width_ = std::max(width, 1.0);
    island_height_ = std::max(height, 1.0);
    fit();
}

double Camera::zoom_to_fit() const {
    const double around = 2 * scale_ * (wall_pixels + margin_pixels);
    const double zoom =
        std::min((viewport_.width - around) / island_width_, (viewport_.height - around) / island_height_);
    return std::clamp(zoom, 1e-6, zoom_max);
}

double Camera::zoom_min() const {
    return zoom_to_fit() / 2;
}

void Camera::fit() {
    centre_ = {island_width_ / 2, island_height_ / 2};
    zoom_ = zoom_to_fit();
    fitted_ = true;
}

/// Clamps the centre so that the viewport shows nothing beyond the margin around the walls. An island that is smaller
/// than the viewport is centred.
void Camera::stay_on_island() {
    const double around = scale_ * (wall_pixels + margin_pixels) / zoom_;
    const auto clamped = [&](double centre, double island, double viewport) {
        const double half = viewport / zoom_ / 2 - around; // from the centre to an end of the island, at least
        return 2 * half >= island ? island / 2 : std::clamp(centre, half, island - half);
    };
    centre_ = {clamped(centre_.x, island_width_, viewport_.width),
               clamped(centre_.y, island_height_, viewport_.height)};
}

void Camera::pan(Point pixels) {
    if (pixels == Point{}) {
        return;
    }
    centre_ = {centre_.x - pixels.x / zoom_, centre_.y - pixels.y / zoom_};
    stay_on_island();
    fitted_ = false;
}

void Camera::look_at(Point world) {
    centre_ = world;
    stay_on_island();
    fitted_ = false;
}

void Camera::zoom_at(Point screen, double factor) {
    const Point held = to_world(screen);
    zoom_ = std::clamp(zoom_ * factor, zoom_min(), zoom_max);
    const Point moved = to_world(screen);
    centre_ = {centre_.x + held.x - moved.x, centre_.y + held.y - moved.y};
    stay_on_island();
    fitted_ = false;
}

Point Camera::to_screen(Point world) const {
    const Point middle = viewport_.centre();
    return {middle.x + (world.x - centre_.x) * zoom_, middle.y + (world.y - centre_.y) * zoom_};
}

Point Camera::to_world(Point screen) const {
    const Point middle = viewport_.centre();
    return {centre_.x + (screen.x - middle.x) / zoom_, centre_.y + (screen.y - middle.y) / zoom_};
}

Rectangle Camera::visible() const {
    const Point corner = to_world({viewport_.left, viewport_.top});
    return {corner.x, corner.y, viewport_.width / zoom_, viewport_.height / zoom_};
}

} // namespace evod::viewer
