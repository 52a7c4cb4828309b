#include "client/viewer/island/flashes.h"

#include "client/viewer/island/marks.h"

#include <algorithm>
#include <utility>

namespace evod::viewer {

namespace {

using codec::Entities;
using codec::ReceivedSnapshot;

/// An organism moves less than this between two compared snapshots, in px.
constexpr float moved_px_max = 100;

/// Calls `act` with the index of each entity of `before` that is not in `after`, or is there at another place if
/// `moves` is false.
template <class Act>
void for_each_gone(const Entities& before, const Entities& after, bool moves, Act act) {
    for (std::size_t i = 0, j = 0; i < before.id.size(); ++i) {
        while (j < after.id.size() && after.id[j] < before.id[i]) {
            ++j;
        }
        const bool kept = j < after.id.size() && after.id[j] == before.id[i] &&
                          (moves || (after.x[j] == before.x[i] && after.y[j] == before.y[i]));
        if (!kept) {
            act(i);
        }
    }
}

/// Returns whether the snapshot contains every entity within moved_px_max of a point.
bool contains_surroundings(const ReceivedSnapshot& snapshot, float x, float y) {
    if (snapshot.tiles.empty()) {
        return true;
    }
    const auto is_streamed = [&](double corner_x, double corner_y) {
        const double side = snapshot.about.tile_px();
        const double inside_x = std::clamp(corner_x, 0.0, snapshot.about.width_px() - 1);
        const double inside_y = std::clamp(corner_y, 0.0, snapshot.about.height_px() - 1);
        return std::ranges::any_of(snapshot.tiles, [&](const codec::DecodedTile& tile) {
            return tile.detail == evod::v1::DETAIL_FULL && inside_x >= tile.left_px && inside_x < tile.left_px + side &&
                   inside_y >= tile.top_px && inside_y < tile.top_px + side;
        });
    };
    return is_streamed(x - moved_px_max, y - moved_px_max) && is_streamed(x + moved_px_max, y - moved_px_max) &&
           is_streamed(x - moved_px_max, y + moved_px_max) && is_streamed(x + moved_px_max, y + moved_px_max);
}

} // namespace

void Flashes::add(const std::shared_ptr<const ReceivedSnapshot>& snapshot) {
    const std::shared_ptr<const ReceivedSnapshot> before = std::exchange(last_, snapshot);
    const double now_s = snapshot->about.simulated_s();
    if (!before || !continues(snapshot->about, before->about)) {
        flashes_.clear();
        return;
    }
    std::erase_if(flashes_, [&](const Flash& flash) { return flash.began_s < now_s - shown_s; });
    if (now_s - before->about.simulated_s() > compared_s_max) {
        return;
    }
    const codec::QuantisedSnapshot &was = *before->entities, &is = *snapshot->entities;
    const auto flash = [&](Flash::Kind kind, float x, float y, float radius) {
        if (contains_surroundings(*snapshot, x, y)) {
            flashes_.push_back({kind, x, y, radius, now_s});
        }
    };
    for_each_gone(was.organisms, is.organisms, true, [&](std::size_t i) {
        flash(Flash::Kind::Death, was.organisms.x_px(i), was.organisms.y_px(i), was.organisms.radius_px(i));
    });
    const auto item_radius = static_cast<float>(snapshot->about.item_radius_px());
    const auto meals = [&](const Entities& before_items, const Entities& items, Flash::Kind kind) {
        for_each_gone(before_items, items, false,
                      [&](std::size_t i) { flash(kind, before_items.x_px(i), before_items.y_px(i), item_radius); });
    };
    meals(was.food, is.food, Flash::Kind::Food);
    meals(was.poison, is.poison, Flash::Kind::Poison);
}

} // namespace evod::viewer
