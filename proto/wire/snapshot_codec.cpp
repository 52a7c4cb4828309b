#include "proto/wire/snapshot_codec.h"

#include "proto/wire/little_endian.h"
#include "proto/wire/steps.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

namespace evod::wire {

namespace {

/// Bytes of one entity's row over all of its columns.
constexpr std::uint64_t organism_bytes(std::uint64_t position) {
    return 4 + 2 * position + 2 + 2;
}
constexpr std::uint64_t item_bytes(std::uint64_t position) {
    return 4 + 2 * position;
}
constexpr std::uint64_t box_bytes(std::uint64_t position) {
    return 2 * position + 2 + 2;
}

/// Length of the body that these counts make.
std::uint64_t body_bytes(const evod::v1::SnapshotFrame& frame) {
    const std::uint64_t position = frame.position_bytes();
    return frame.organism_count() * organism_bytes(position) +
           (std::uint64_t{frame.food_count()} + frame.poison_count()) * item_bytes(position) +
           (std::uint64_t{frame.crate_count()} + frame.obstacle_count()) * box_bytes(position);
}

// ---- encoding --------------------------------------------------------------------------------------------------

/// Where the next column goes.
class Writer {
  public:
    explicit Writer(char* to) : to_{to} {}

    void ids(std::span<const std::uint32_t> column) {
        each(column, [](std::uint32_t id) { return id; });
    }
    template <std::unsigned_integral Step>
    void positions(std::span<const std::int32_t> column, unsigned fraction_bits) {
        const PositionInSteps in_steps{fraction_bits, sizeof(Step)};
        each(column, [=](std::int32_t position) { return static_cast<Step>(in_steps(position)); });
    }
    void sizes(std::span<const float> column) { each(column, size_in_steps); }

  private:
    template <class Value, class Convert>
    void each(std::span<const Value> column, const Convert& convert) {
        using Number = decltype(convert(column[0]));
        char* const to = to_;
        for (std::size_t i = 0; i < column.size(); ++i) {
            store(convert(column[i]), to + i * sizeof(Number));
        }
        to_ += column.size() * sizeof(Number);
    }

    char* to_;
};

template <class First, class... Rest>
void require_same_length(const char* what, const First& first, const Rest&... rest) {
    if (((rest.size() != first.size()) || ...)) {
        throw std::invalid_argument{std::string{"columns of different lengths: "} + what};
    }
}

template <std::unsigned_integral Step>
void write_columns(const IslandColumns& island, char* to) {
    Writer writer{to};
    const unsigned bits = island.position_fraction_bits;
    writer.ids(island.organisms.id);
    writer.positions<Step>(island.organisms.x, bits);
    writer.positions<Step>(island.organisms.y, bits);
    writer.sizes(island.organisms.radius_px);
    writer.sizes(island.organisms.health);
    for (const ItemColumns* items : {&island.food, &island.poison}) {
        writer.ids(items->id);
        writer.positions<Step>(items->x, bits);
        writer.positions<Step>(items->y, bits);
    }
    for (const BoxColumns* boxes : {&island.crates, &island.obstacles}) {
        writer.positions<Step>(boxes->x, bits);
        writer.positions<Step>(boxes->y, bits);
        writer.sizes(boxes->half_width_px);
        writer.sizes(boxes->half_height_px);
    }
}

// ---- decoding --------------------------------------------------------------------------------------------------

/// Reads whole columns; the caller has checked that they are there.
class Reader {
  public:
    Reader(const char* from, std::uint32_t position_bytes) : from_{from}, position_bytes_{position_bytes} {}

    std::vector<std::uint32_t> ids(std::size_t count) {
        return column<std::uint32_t, std::uint32_t>(count, [](std::uint32_t id) { return id; });
    }
    std::vector<float> positions(std::size_t count) {
        return position_bytes_ == 2 ? steps<std::uint16_t>(count) : steps<std::uint32_t>(count);
    }
    std::vector<float> sizes(std::size_t count) { return steps<std::uint16_t>(count); }

  private:
    template <std::unsigned_integral Step>
    std::vector<float> steps(std::size_t count) {
        return column<float, Step>(count, [](Step step) { return static_cast<float>(step) * (1 / steps_per_px); });
    }
    template <class Value, std::unsigned_integral Number, class Convert>
    std::vector<Value> column(std::size_t count, const Convert& convert) {
        std::vector<Value> values(count);
        for (std::size_t i = 0; i < count; ++i) {
            values[i] = convert(load<Number>(from_ + i * sizeof(Number)));
        }
        from_ += count * sizeof(Number);
        return values;
    }

    const char* from_;
    std::uint32_t position_bytes_;
};

Damage wrong(const char* field, const std::string& got, const char* allowed) {
    return Damage{std::string{"a snapshot's "} + field + " is " + got + ", not " + allowed};
}

/// What is wrong with the length of the body, if anything.
std::optional<Damage> damage_of_length(const evod::v1::SnapshotFrame& frame) {
    const std::uint64_t expected = body_bytes(frame);
    if (frame.body().size() != expected) {
        return wrong("body", std::to_string(frame.body().size()) + " bytes long",
                     (std::to_string(expected) + " as its counts say").c_str());
    }
    return std::nullopt;
}

bool rise(const std::vector<std::uint32_t>& ids) {
    return std::adjacent_find(ids.begin(), ids.end(), std::greater_equal<>{}) == ids.end();
}

} // namespace

void describe(const IslandColumns& island, evod::v1::SnapshotFrame& frame) {
    require_same_length("organisms", island.organisms.id, island.organisms.x, island.organisms.y,
                        island.organisms.radius_px, island.organisms.health);
    require_same_length("food", island.food.id, island.food.x, island.food.y);
    require_same_length("poison", island.poison.id, island.poison.x, island.poison.y);
    require_same_length("crates", island.crates.x, island.crates.y, island.crates.half_width_px,
                        island.crates.half_height_px);
    require_same_length("obstacles", island.obstacles.x, island.obstacles.y, island.obstacles.half_width_px,
                        island.obstacles.half_height_px);
    frame.set_width_px(island.width_px);
    frame.set_height_px(island.height_px);
    frame.set_organism_count(static_cast<std::uint32_t>(island.organisms.id.size()));
    frame.set_food_count(static_cast<std::uint32_t>(island.food.id.size()));
    frame.set_poison_count(static_cast<std::uint32_t>(island.poison.id.size()));
    frame.set_crate_count(static_cast<std::uint32_t>(island.crates.x.size()));
    frame.set_obstacle_count(static_cast<std::uint32_t>(island.obstacles.x.size()));
    frame.set_position_bytes(position_bytes_of(island.width_px, island.height_px));
}

void encode(const IslandColumns& island, evod::v1::SnapshotFrame& frame) {
    describe(island, frame);
    frame.set_codec(evod::v1::CODEC_COLUMNS);
    frame.mutable_body()->resize(body_bytes(frame));
    if (frame.position_bytes() == 2) {
        write_columns<std::uint16_t>(island, frame.mutable_body()->data());
    } else {
        write_columns<std::uint32_t>(island, frame.mutable_body()->data());
    }
}

std::optional<Damage> damage_of_fields(const evod::v1::SnapshotFrame& frame) {
    if (frame.position_bytes() != 2 && frame.position_bytes() != 4) {
        return wrong("position_bytes", std::to_string(frame.position_bytes()), "2 or 4");
    }
    if (frame.island() >= frame.island_count()) {
        return wrong("island", std::to_string(frame.island()),
                     ("one of " + std::to_string(frame.island_count())).c_str());
    }
    struct Size {
        const char* field;
        double value;
        bool zero_allowed;
    };
    for (const Size& size :
         {Size{"width_px", frame.width_px(), false}, Size{"height_px", frame.height_px(), false},
          Size{"item_radius_px", frame.item_radius_px(), true}, Size{"simulated_s", frame.simulated_s(), true},
          Size{"ticks_per_s", frame.ticks_per_s(), true}}) {
        if (!std::isfinite(size.value) || size.value < 0 || (size.value == 0 && !size.zero_allowed)) {
            return wrong(size.field, std::to_string(size.value), "a finite positive number");
        }
    }
    if (!std::isfinite(frame.live().health_mean())) {
        return wrong("live.health_mean", std::to_string(frame.live().health_mean()), "a finite number");
    }
    return std::nullopt;
}

Result<Picture> decode(evod::v1::SnapshotFrame frame) {
    if (frame.codec() != evod::v1::CODEC_COLUMNS) {
        return wrong("codec", std::to_string(frame.codec()), "one that is known here");
    }
    if (auto damage = damage_of_fields(frame)) {
        return *std::move(damage);
    }
    if (auto damage = damage_of_length(frame)) {
        return *std::move(damage);
    }
    Picture picture;
    Reader reader{frame.body().data(), frame.position_bytes()};
    const std::size_t organism_count = frame.organism_count();
    picture.organisms.id = reader.ids(organism_count);
    picture.organisms.x_px = reader.positions(organism_count);
    picture.organisms.y_px = reader.positions(organism_count);
    picture.organisms.radius_px = reader.sizes(organism_count);
    picture.organisms.health = reader.sizes(organism_count);
    for (const auto& [items, count] :
         {std::pair{&picture.food, frame.food_count()}, std::pair{&picture.poison, frame.poison_count()}}) {
        items->id = reader.ids(count);
        items->x_px = reader.positions(count);
        items->y_px = reader.positions(count);
    }
    for (const auto& [boxes, count] :
         {std::pair{&picture.crates, frame.crate_count()}, std::pair{&picture.obstacles, frame.obstacle_count()}}) {
        boxes->x_px = reader.positions(count);
        boxes->y_px = reader.positions(count);
        boxes->half_width_px = reader.sizes(count);
        boxes->half_height_px = reader.sizes(count);
        boxes->id.resize(count);
        std::iota(boxes->id.begin(), boxes->id.end(), 0U);
    }
    for (const auto& [what, ids] : {std::pair{"organisms", &picture.organisms.id}, std::pair{"food", &picture.food.id},
                                    std::pair{"poison", &picture.poison.id}}) {
        if (!rise(*ids)) {
            return wrong("ids", "out of order", (std::string{"rising in its "} + what).c_str());
        }
    }
    frame.clear_body();
    picture.about = std::move(frame);
    return picture;
}

} // namespace evod::wire
