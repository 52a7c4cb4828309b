#include "proto/codec/snapshot_codec.h"

#include "proto/codec/body.h"
#include "proto/codec/delta_codec.h"
#include "proto/codec/little_endian.h"
#include "proto/codec/steps.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

namespace evod::codec {

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

void describe(const QuantisedSnapshot& snapshot, evod::v1::SnapshotFrame& frame) {
    for (const auto part : snapshot_parts) {
        const Entities& entities = snapshot.*part;
        for (const Column* column : {&entities.id, &entities.y, &entities.width, &entities.height}) {
            const bool may_be_left_out = column != &entities.y; // what a kind does not have
            if (column->size() != entities.x.size() && !(may_be_left_out && column->empty())) {
                throw std::invalid_argument{"a snapshot has columns of different lengths"};
            }
        }
    }
    set_counts(counts_of(snapshot), frame);
    frame.set_position_bytes(snapshot.position_bytes);
}

void encode(const QuantisedSnapshot& snapshot, evod::v1::SnapshotFrame& frame) {
    describe(snapshot, frame);
    frame.set_codec(evod::v1::CODEC_COLUMNS);
    BodyWriter writer{body_bytes(frame)};
    const auto positions = [&](const Column& column) {
        snapshot.position_bytes == 2 ? writer.plain<std::uint16_t>(column) : writer.plain<std::uint32_t>(column);
    };
    for (const auto part : snapshot_parts) {
        const Entities& entities = snapshot.*part; // columns that a kind does not have are empty
        writer.plain<std::uint32_t>(entities.id);
        positions(entities.x);
        positions(entities.y);
        writer.plain<std::uint16_t>(entities.width);
        writer.plain<std::uint16_t>(entities.height);
    }
    frame.set_body(writer.take());
    frame.set_checksum(checksum_of(frame, frame.body()));
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

Result<DecodedSnapshot> decode(evod::v1::SnapshotFrame frame) {
    if (frame.codec() != evod::v1::CODEC_COLUMNS) {
        return wrong("codec", std::to_string(frame.codec()), "one that is known here");
    }
    if (auto damage = damage_of_fields(frame)) {
        return *std::move(damage);
    }
    if (auto damage = damage_of_length(frame)) {
        return *std::move(damage);
    }
    DecodedSnapshot picture;
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

} // namespace evod::codec
