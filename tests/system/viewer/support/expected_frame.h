// ExpectedFrame: the colours that the pixels of a screenshot in the classic skin must have, computed from a snapshot
// independently of the viewer's renderer.
//
// Shapes are painted in the viewer's order, with hard edges. Pixels on an edge, where the viewer blends, and those
// where a number may be drawn are open; every other pixel of the viewport must have exactly the colour painted here.
#pragma once

#include "client/viewer/drawing/camera.h"
#include "client/viewer/drawing/palette.h"
#include "client/viewer/drawing/window_layout.h"
#include "proto/codec/snapshot_codec.h"

#include <SFML/Graphics/Image.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace evod::viewer {

/// The camera of a new window.
inline Camera camera_of(const evod::v1::SnapshotFrame& snapshot, unsigned width_pixels, unsigned height_pixels) {
    Camera camera;
    camera.set_viewport(viewport_of(width_pixels, height_pixels));
    camera.set_island(snapshot.width_px(), snapshot.height_px());
    return camera;
}

/// The camera of a screenshot, whose sidebar is shown if the image is wide enough.
inline Camera camera_of_screenshot(const evod::v1::SnapshotFrame& snapshot, unsigned width_pixels,
                                   unsigned height_pixels) {
    const double sidebar = width_pixels >= 2 * double{sidebar_width} ? sidebar_pixels(width_pixels) : 0;
    return camera_of(snapshot, width_pixels - static_cast<unsigned>(sidebar), height_pixels);
}

class ExpectedFrame {
  public:
    struct Mismatch {
        std::size_t count = 0;
        std::string first; // "at (12, 40): expected …, is …"
    };

    /// organisms  colours by index in the snapshot, drawn as discs with a thin outline; empty: rings
    ExpectedFrame(const codec::ReceivedSnapshot& snapshot, const Camera& camera,
                  const std::vector<Colour>& organisms = {})
        : camera_{camera}
        , left_{static_cast<unsigned>(camera.viewport().left)}
        , top_{static_cast<unsigned>(camera.viewport().top)}
        , width_{static_cast<unsigned>(camera.viewport().width)}
        , height_{static_cast<unsigned>(camera.viewport().height)}
        , pixels_(std::size_t{width_} * height_, palette::of({Skin::Classic}).outside) {
        const double width = snapshot.about.width_px(), height = snapshot.about.height_px();
        const double wall = Camera::wall_pixels / camera.zoom();
        box(width / 2, height / 2, width / 2 + wall, height / 2 + wall, Camera::wall_pixels, palette::wall,
            palette::background);
        const auto boxes = [&](const codec::Entities& all, double edge_pixels, Colour edge, Colour fill) {
            for (std::size_t i = 0; i < all.x.size(); ++i) {
                box(all.x_px(i), all.y_px(i), all.half_width_px(i), all.half_height_px(i), edge_pixels, edge, fill);
            }
        };
        boxes(snapshot.entities->obstacles, 0, {}, palette::obstacle);
        boxes(snapshot.entities->crates, 2, palette::crate_edge, palette::crate);
        const auto items = [&](const codec::Entities& all, Colour colour) {
            for (std::size_t i = 0; i < all.x.size(); ++i) {
                circle(all.x_px(i), all.y_px(i), snapshot.about.item_radius_px(), 0, {}, colour);
            }
        };
        items(snapshot.entities->poison, palette::poison);
        items(snapshot.entities->food, palette::food);
        const codec::Entities& all = snapshot.entities->organisms;
        for (std::size_t i = 0; i < all.x.size(); ++i) {
            if (organisms.empty()) {
                circle(all.x_px(i), all.y_px(i), all.radius_px(i), 2, palette::organism, {});
            } else {
                circle(all.x_px(i), all.y_px(i), all.radius_px(i), 1, palette::organism_outline, organisms[i]);
            }
        }
        for (std::size_t i = 0; i < all.x.size(); ++i) { // numbers are drawn over everything
            const Point centre = camera_.to_screen({all.x_px(i), all.y_px(i)});
            const double radius = all.radius_px(i) * camera_.zoom();
            const double wall = camera_.to_screen({snapshot.about.width_px(), 0}).x; // labels stay inside of it
            const double left = std::min(centre.x - 32, wall - 65);
            for (const double top : {centre.y + radius, centre.y - radius - 17}) {
                paint(left, top, centre.x + 32, top + 17, [](double, double) { return open; });
            }
        }
    }

    /// Leaves the pixels of a rectangle open.
    void leave_open(const Rectangle& area) {
        paint(area.left, area.top, area.left + area.width, area.top + area.height, [](double, double) { return open; });
    }

    Mismatch compare(const sf::Image& image) const {
        Mismatch mismatch;
        for (unsigned y = 0; y < height_; ++y) {
            for (unsigned x = 0; x < width_; ++x) {
                const auto& expected = pixels_[std::size_t{y} * width_ + x];
                const sf::Color is = image.getPixel(left_ + x, top_ + y);
                if (expected && Colour{is.r, is.g, is.b, is.a} != *expected && mismatch.count++ == 0) {
                    mismatch.first = "at (" + std::to_string(left_ + x) + ", " + std::to_string(top_ + y) +
                                     "): expected " + name(*expected) + ", is " + name({is.r, is.g, is.b, is.a});
                }
            }
        }
        return mismatch;
    }

    /// The number of pixels that must have exactly this colour.
    std::size_t count(Colour colour) const {
        return static_cast<std::size_t>(std::ranges::count(pixels_, std::optional{colour}));
    }

  private:
    using Pixel = std::optional<Colour>; // nullopt: open
    enum class Place { Outside, Edge, Inside, Open };
    static constexpr Place open = Place::Open;

    static std::string name(Colour colour) {
        return "rgb(" + std::to_string(colour.red) + ", " + std::to_string(colour.green) + ", " +
               std::to_string(colour.blue) + ")";
    }

    static Place place(double beyond, double edge_pixels) {
        constexpr double blended = 0.51; // half a pixel on either side of an edge, and the rounding of floats
        if (beyond > blended) {
            return Place::Outside;
        }
        if (beyond > -blended || std::abs(beyond + edge_pixels) < blended) {
            return Place::Open;
        }
        return beyond > -edge_pixels ? Place::Edge : Place::Inside;
    }

    template <class PlaceOf>
    void paint(double left, double top, double right, double bottom, PlaceOf place_of, std::optional<Colour> edge = {},
               std::optional<Colour> fill = {}) {
        const auto from = [](double begin, unsigned origin) {
            return static_cast<unsigned>(std::max(std::floor(begin) - origin, 0.0));
        };
        const auto to = [](double end, unsigned origin, unsigned size) {
            return static_cast<unsigned>(std::clamp(std::ceil(end) - origin, 0.0, double(size)));
        };
        for (unsigned y = from(top, top_); y < to(bottom, top_, height_); ++y) {
            for (unsigned x = from(left, left_); x < to(right, left_, width_); ++x) {
                Pixel& pixel = pixels_[std::size_t{y} * width_ + x];
                switch (place_of(left_ + x + 0.5, top_ + y + 0.5)) {
                case Place::Outside:
                    break;
                case Place::Edge:
                    pixel = edge;
                    break;
                case Place::Inside:
                    pixel = fill ? fill : pixel;
                    break;
                case Place::Open:
                    pixel = std::nullopt;
                    break;
                }
            }
        }
    }

    void circle(double x, double y, double radius, double edge_pixels, Colour edge, std::optional<Colour> fill) {
        const Point centre = camera_.to_screen({x, y});
        const double pixels = radius * camera_.zoom();
        paint(
            centre.x - pixels - 1, centre.y - pixels - 1, centre.x + pixels + 1, centre.y + pixels + 1,
            [&](double px, double py) { return place(std::hypot(px - centre.x, py - centre.y) - pixels, edge_pixels); },
            edge, fill);
    }

    void box(double x, double y, double half_width, double half_height, double edge_pixels, Colour edge,
             std::optional<Colour> fill) {
        const Point centre = camera_.to_screen({x, y});
        const double wide = half_width * camera_.zoom(), high = half_height * camera_.zoom();
        paint(
            centre.x - wide - 1, centre.y - high - 1, centre.x + wide + 1, centre.y + high + 1,
            [&](double px, double py) {
                return place(std::max(std::abs(px - centre.x) - wide, std::abs(py - centre.y) - high), edge_pixels);
            },
            edge, fill);
    }

    Camera camera_;
    unsigned left_, top_, width_, height_;
    std::vector<Pixel> pixels_;
};

} // namespace evod::viewer
