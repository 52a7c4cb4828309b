#include "client/viewer/island/labels.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <unordered_map>

namespace evod::viewer {

namespace {

bool overlap(const Rectangle& a, const Rectangle& b) {
    return a.left < b.left + b.width && b.left < a.left + a.width && a.top < b.top + b.height &&
           b.top < a.top + a.height;
}

/// The labels placed so far, in square cells. A label is stored in the cell of its upper left corner. No label is wider
/// than a cell, so all labels that overlap another are in the nine cells around it.
class Placed {
  public:
    explicit Placed(double cell) : cell_{cell} {}
    bool collides(const Rectangle& label) const {
        for (std::int64_t row = index(label.top) - 1; row <= index(label.top) + 1; ++row) {
            for (std::int64_t column = index(label.left) - 1; column <= index(label.left) + 1; ++column) {
                const auto found = cells_.find(key(row, column));
                if (found != cells_.end() &&
                    std::ranges::any_of(found->second, [&](const Rectangle& other) { return overlap(label, other); })) {
                    return true;
                }
            }
        }
        return false;
    }
    void add(const Rectangle& label) { cells_[key(index(label.top), index(label.left))].push_back(label); }

  private:
    std::int64_t index(double place) const { return static_cast<std::int64_t>(std::floor(place / cell_)); }
    static std::int64_t key(std::int64_t row, std::int64_t column) { return row * 100'000 + column; }
    double cell_;
    std::unordered_map<std::int64_t, std::vector<Rectangle>> cells_;
};

/// Whether a label would cover a part of an organism.
bool covers(const Rectangle& label, const HealthLabel& organism) {
    const double x = std::clamp(organism.centre.x, label.left, label.left + label.width);
    const double y = std::clamp(organism.centre.y, label.top, label.top + label.height);
    return std::hypot(x - organism.centre.x, y - organism.centre.y) < organism.radius;
}

} // namespace

std::vector<std::optional<Point>> place_labels(std::span<const HealthLabel> labels,
                                               std::span<const HealthLabel> organisms, double height,
                                               const Rectangle& walls) {
    double cell = height;
    for (const HealthLabel& label : labels) {
        cell = std::max(cell, label.width);
    }
    Placed placed{cell};
    std::vector<std::optional<Point>> corners;
    corners.reserve(labels.size());
    for (const HealthLabel& label : labels) {
        const double right = walls.left + walls.width - label.width - 1;
        const double left = std::max(std::min(label.centre.x - label.width / 2, right), walls.left + 1);
        const Rectangle above{left, label.centre.y - label.radius - height - 1, label.width, height};
        const Rectangle below{left, label.centre.y + label.radius + 1, label.width, height};
        const auto is_free = [&](const Rectangle& place) {
            return place.top >= walls.top && place.top + height <= walls.top + walls.height && !placed.collides(place);
        };
        const auto covers_none = [&](const Rectangle& place) {
            return std::ranges::none_of(organisms, [&](const HealthLabel& other) { return covers(place, other); });
        };
        const bool above_is_free = is_free(above), below_is_free = is_free(below);
        if (!above_is_free && !below_is_free) {
            corners.emplace_back();
            continue;
        }
        const bool is_above = above_is_free && (!below_is_free || covers_none(above) || !covers_none(below));
        const Rectangle& chosen = is_above ? above : below;
        placed.add(chosen);
        corners.emplace_back(Point{chosen.left, chosen.top});
    }
    return corners;
}

} // namespace evod::viewer
