#include "proto/codec/snapshot_codec.h"

#include "proto/codec/steps.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>

namespace evod::codec {
namespace {

using Floats = google::protobuf::RepeatedField<float>;
using Ids = google::protobuf::RepeatedField<std::uint32_t>;

Damage wrong(const std::string& field, const std::string& got, const std::string& allowed) {
    return Damage{"a snapshot's " + field + " is " + got + ", not " + allowed};
}

void set_ids(const Column& column, Ids& to) {
    to.Add(column.begin(), column.end());
}

/// Converts steps to px, or to health.
void set_values(const Column& column, Floats& to) {
    to.Reserve(static_cast<int>(column.size()));
    for (const std::uint32_t steps : column) {
        to.AddAlreadyReserved(static_cast<float>(steps) * (1 / steps_per_px));
    }
}

void set_items(const Entities& items, evod::v1::PlainItems& to) {
    set_ids(items.id, *to.mutable_id());
    set_values(items.x, *to.mutable_x_px());
    set_values(items.y, *to.mutable_y_px());
}

void set_boxes(const Entities& boxes, evod::v1::PlainBoxes& to) {
    set_values(boxes.x, *to.mutable_x_px());
    set_values(boxes.y, *to.mutable_y_px());
    set_values(boxes.width, *to.mutable_half_width_px());
    set_values(boxes.height, *to.mutable_half_height_px());
}

/// Copies the columns of one kind and checks each. After the first error, all further columns are empty.
class PlainReader {
  public:
    PlainReader(const char* kind, std::uint32_t count) : kind_{kind}, count_{count} {}

    std::vector<std::uint32_t> ids(const Ids& column) {
        if (has_count("id", column.size()) &&
            std::adjacent_find(column.begin(), column.end(), std::greater_equal<>{}) != column.end()) {
            refuse("id", "out of order", "rising");
        }
        return damage_ ? std::vector<std::uint32_t>{} : std::vector<std::uint32_t>{column.begin(), column.end()};
    }
    std::vector<float> values(const char* field, const Floats& column) {
        if (has_count(field, column.size())) {
            const auto bad =
                std::find_if(column.begin(), column.end(), [](float value) { return !std::isfinite(value); });
            if (bad != column.end()) {
                refuse(field, std::to_string(*bad), "a finite number");
            }
        }
        return damage_ ? std::vector<float>{} : std::vector<float>{column.begin(), column.end()};
    }
    const std::optional<Damage>& damage() const { return damage_; }

  private:
    bool has_count(const char* field, int size) {
        if (static_cast<std::uint32_t>(size) != count_) {
            refuse(field, std::to_string(size) + " numbers long", std::to_string(count_) + " as the count says");
        }
        return !damage_;
    }
    void refuse(const char* field, const std::string& got, const std::string& allowed) {
        if (!damage_) {
            damage_ = wrong(std::string{"plain."} + kind_ + "." + field, got, allowed);
        }
    }

    const char* kind_;
    std::uint32_t count_;
    std::optional<Damage> damage_;
};

} // namespace

void describe(const QuantisedSnapshot& snapshot, evod::v1::SnapshotFrame& frame) {
    for (const auto part : snapshot_parts) {
        const Entities& entities = snapshot.*part;
        for (const Column* column : {&entities.id, &entities.y, &entities.width, &entities.height}) {
            const bool optional = column != &entities.y; // not all kinds have this column
            if (column->size() != entities.x.size() && !(optional && column->empty())) {
                throw std::invalid_argument{"a snapshot has columns of different lengths"};
            }
        }
    }
    set_counts(counts_of(snapshot), frame);
    frame.set_position_bytes(snapshot.position_bytes);
}

void encode_plain(const QuantisedSnapshot& snapshot, evod::v1::SnapshotFrame& frame) {
    describe(snapshot, frame);
    frame.clear_position_bytes();
    frame.set_codec(evod::v1::CODEC_PLAIN);
    evod::v1::PlainSnapshot& plain = *frame.mutable_plain();
    evod::v1::PlainOrganisms& organisms = *plain.mutable_organisms();
    set_ids(snapshot.organisms.id, *organisms.mutable_id());
    set_values(snapshot.organisms.x, *organisms.mutable_x_px());
    set_values(snapshot.organisms.y, *organisms.mutable_y_px());
    set_values(snapshot.organisms.width, *organisms.mutable_radius_px());
    set_values(snapshot.organisms.height, *organisms.mutable_health());
    set_items(snapshot.food, *plain.mutable_food());
    set_items(snapshot.poison, *plain.mutable_poison());
    set_boxes(snapshot.crates, *plain.mutable_crates());
    set_boxes(snapshot.obstacles, *plain.mutable_obstacles());
}

std::optional<Damage> damage_of_fields(const evod::v1::SnapshotFrame& frame) {
    if (frame.codec() == evod::v1::CODEC_DELTA && frame.position_bytes() != 2 && frame.position_bytes() != 4) {
        return wrong("position_bytes", std::to_string(frame.position_bytes()), "2 or 4");
    }
    if (frame.island() >= frame.island_count()) {
        return wrong("island", std::to_string(frame.island()), "one of " + std::to_string(frame.island_count()));
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

Result<DecodedSnapshot> decode_plain(evod::v1::SnapshotFrame frame) {
    if (frame.codec() != evod::v1::CODEC_PLAIN) {
        return wrong("codec", std::to_string(frame.codec()), "a known one");
    }
    if (auto damage = damage_of_fields(frame)) {
        return *std::move(damage);
    }
    const evod::v1::PlainSnapshot& plain = frame.plain();
    DecodedSnapshot snapshot;
    std::optional<Damage> damage;
    const auto read = [&](const char* kind, std::uint32_t count, const auto& columns) {
        PlainReader reader{kind, count};
        columns(reader);
        if (!damage) {
            damage = reader.damage();
        }
    };
    read("organisms", frame.organism_count(), [&](PlainReader& reader) {
        const evod::v1::PlainOrganisms& from = plain.organisms();
        snapshot.organisms = {reader.ids(from.id()), reader.values("x_px", from.x_px()),
                              reader.values("y_px", from.y_px()), reader.values("radius_px", from.radius_px()),
                              reader.values("health", from.health())};
    });
    const auto read_items = [&](const char* kind, std::uint32_t count, const evod::v1::PlainItems& from,
                                DecodedItems& to) {
        read(kind, count, [&](PlainReader& reader) {
            to = {reader.ids(from.id()), reader.values("x_px", from.x_px()), reader.values("y_px", from.y_px())};
        });
    };
    read_items("food", frame.food_count(), plain.food(), snapshot.food);
    read_items("poison", frame.poison_count(), plain.poison(), snapshot.poison);
    const auto read_boxes = [&](const char* kind, std::uint32_t count, const evod::v1::PlainBoxes& from,
                                DecodedBoxes& to) {
        read(kind, count, [&](PlainReader& reader) {
            to = {.x_px = reader.values("x_px", from.x_px()),
                  .y_px = reader.values("y_px", from.y_px()),
                  .half_width_px = reader.values("half_width_px", from.half_width_px()),
                  .half_height_px = reader.values("half_height_px", from.half_height_px())};
            to.id.resize(to.x_px.size());
            std::iota(to.id.begin(), to.id.end(), 0U);
        });
    };
    read_boxes("crates", frame.crate_count(), plain.crates(), snapshot.crates);
    read_boxes("obstacles", frame.obstacle_count(), plain.obstacles(), snapshot.obstacles);
    if (damage) {
        return *std::move(damage);
    }
    frame.clear_plain();
    frame.clear_body(); // the body has no meaning with this codec, nor have the tiles
    frame.clear_tiles();
    snapshot.about = std::move(frame);
    return snapshot;
}

} // namespace evod::codec
