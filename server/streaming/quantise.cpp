#include "server/streaming/quantise.h"

#include "proto/codec/steps.h"

#include <algorithm>
#include <bit>
#include <span>

namespace evod::streaming {
namespace {

using codec::Column;

/// Converts a column of fixed-point positions to steps in place. The compiler can vectorise the loop.
void to_steps(Column& positions, std::uint32_t position_bytes) {
    const codec::PositionInSteps in_steps{std::countr_zero(static_cast<unsigned>(physics::units_per_px)),
                                          position_bytes};
    for (std::uint32_t& position : positions) {
        position = in_steps(static_cast<std::int32_t>(position));
    }
}

/// Resizes the columns to `count` + 1 rows. The loops below also write each skipped entity to the next free row, which
/// the next entity overwrites. The additional row receives entities that are skipped at the end.
template <class... Columns>
void resize_columns(std::size_t count, Columns&... columns) {
    (columns.resize(count + 1), ...);
}

template <class... Columns>
void truncate_columns(std::size_t count, Columns&... columns) {
    (columns.resize(count), ...);
}

codec::Entities items_of(const runtime::ItemsSnapshot& items, std::uint32_t position_bytes) {
    codec::Entities to;
    resize_columns(items.present_count, to.id, to.x, to.y);
    std::size_t kept = 0;
    // The loop has no branch, because the processor could not predict which items are absent.
    for (std::size_t i = 0; i < items.all.size(); ++i) {
        const simulation::Items::Item& item = items.all[i];
        to.id[kept] = static_cast<std::uint32_t>(i);
        to.x[kept] = static_cast<std::uint32_t>(item.x);
        to.y[kept] = static_cast<std::uint32_t>(item.y);
        kept += item.due_tick == 0;
    }
    truncate_columns(kept, to.id, to.x, to.y);
    to_steps(to.x, position_bytes);
    to_steps(to.y, position_bytes);
    return to;
}

codec::Entities boxes_of(const runtime::BoxesSnapshot& boxes, std::size_t begin, std::size_t end,
                         std::uint32_t position_bytes) {
    const auto part = [=](const auto& column) { return std::span{column}.subspan(begin, end - begin); };
    const auto positions = [&](const auto& column) {
        Column steps(part(column).begin(), part(column).end());
        to_steps(steps, position_bytes);
        return steps;
    };
    const auto sizes = [&](const auto& column) {
        Column steps(end - begin);
        std::ranges::transform(part(column), steps.begin(), codec::size_in_steps);
        return steps;
    };
    return {.id = {},
            .x = positions(boxes.x),
            .y = positions(boxes.y),
            .width = sizes(boxes.half_width_px),
            .height = sizes(boxes.half_height_px)};
}

codec::Entities organisms_of(const runtime::OrganismsSnapshot& organisms, std::uint32_t position_bytes,
                             OptionalColumns with) {
    codec::Entities to;
    Column indices;
    resize_columns(organisms.alive_count, to.id, indices);
    std::size_t kept = 0;
    for (std::size_t id = 0; id < organisms.place_of.size(); ++id) { // no branch, as in the loop over items
        to.id[kept] = static_cast<std::uint32_t>(id);
        indices[kept] = organisms.place_of[id];
        kept += organisms.place_of[id] != simulation::Island::no_body;
    }
    truncate_columns(kept, to.id, indices, to.x, to.y, to.width, to.height);
    const auto fetch = [&](const auto& from, const auto& converted, Column& column) {
        std::ranges::transform(indices, column.begin(), [&](std::uint32_t index) { return converted(from[index]); });
    };
    const auto unchanged = [](physics::Coordinate position) { return static_cast<std::uint32_t>(position); };
    fetch(organisms.x, unchanged, to.x);
    fetch(organisms.y, unchanged, to.y);
    fetch(organisms.radius_px, codec::size_in_steps, to.width);
    fetch(organisms.health, codec::size_in_steps, to.height);
    if (with.headings && !organisms.heading.empty()) {
        to.heading.resize(kept);
        fetch(organisms.heading, codec::heading_in_steps, to.heading);
    }
    if (with.species && !organisms.species.empty()) {
        to.species.resize(kept);
        std::ranges::transform(to.id, to.species.begin(),
                               [&](std::uint32_t id) { return static_cast<std::uint32_t>(organisms.species[id]); });
    }
    to_steps(to.x, position_bytes);
    to_steps(to.y, position_bytes);
    return to;
}

} // namespace

codec::QuantisedSnapshot quantise(const runtime::IslandSnapshot& island, OptionalColumns with) {
    const std::uint32_t position_bytes = codec::position_bytes_of(island.width_px, island.height_px);
    const std::size_t crates = island.crate_count, boxes = island.boxes.x.size();
    return {.position_bytes = position_bytes,
            .organisms = organisms_of(island.organisms, position_bytes, with),
            .food = items_of(island.food, position_bytes),
            .poison = items_of(island.poison, position_bytes),
            .crates = boxes_of(island.boxes, 0, crates, position_bytes),
            .obstacles = boxes_of(island.boxes, crates, boxes, position_bytes)};
}

} // namespace evod::streaming
