#include "proto/codec/snapshot_codec.h"

#include "proto/codec/steps.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <initializer_list>
#include <stdexcept>
#include <string>
#include <utility>

namespace evod::codec {
namespace {

using Floats = google::protobuf::RepeatedField<float>;
using Integers = google::protobuf::RepeatedField<std::uint32_t>;

constexpr float heading_max = 3.1416f;     // radians: pi, and a little for rounding
constexpr std::uint32_t species_max = 255; // more species than there are, but all that fit in CODEC_DELTA

Damage wrong(const std::string& field, const std::string& got, const std::string& allowed) {
    return Damage{"a snapshot's " + field + " is " + got + ", not " + allowed};
}

void set_integers(const Column& column, Integers& to) {
    to.Add(column.begin(), column.end());
}

/// Sets `to` to the numbers of a column, converted from steps to px or health.
void set_values(const Column& column, Floats& to) {
    to.Reserve(static_cast<int>(column.size()));
    for (const std::uint32_t steps : column) {
        to.AddAlreadyReserved(px_of(steps));
    }
}

void set_items(const Entities& items, evod::v1::PlainItems& to) {
    set_integers(items.id, *to.mutable_id());
    set_values(items.x, *to.mutable_x_px());
    set_values(items.y, *to.mutable_y_px());
}

void set_boxes(const Entities& boxes, evod::v1::PlainBoxes& to) {
    set_values(boxes.x, *to.mutable_x_px());
    set_values(boxes.y, *to.mutable_y_px());
    set_values(boxes.width, *to.mutable_half_width_px());
    set_values(boxes.height, *to.mutable_half_height_px());
}

Damage count_mismatch(const std::string& field, int size, std::uint32_t count) {
    return wrong(field, std::to_string(size) + " numbers long", std::to_string(count) + " as the count says");
}

std::optional<Damage> read_headings(const Floats& from, std::uint32_t count, Column& to) {
    if (static_cast<std::uint32_t>(from.size()) != count) {
        return count_mismatch("plain.organisms.heading", from.size(), count);
    }
    const auto bad = std::ranges::find_if(from, [](float value) { return !(std::abs(value) <= heading_max); });
    if (bad != from.end()) {
        return wrong("plain.organisms.heading", std::to_string(*bad), "-pi to pi");
    }
    to.resize(count);
    std::ranges::transform(from, to.begin(), heading_in_steps);
    return std::nullopt;
}

std::optional<Damage> read_species(const Integers& from, std::uint32_t count, Column& to) {
    if (static_cast<std::uint32_t>(from.size()) != count) {
        return count_mismatch("plain.organisms.species", from.size(), count);
    }
    const auto bad = std::ranges::find_if(from, [](std::uint32_t species) { return species > species_max; });
    if (bad != from.end()) {
        return wrong("plain.organisms.species", std::to_string(*bad), "0 to " + std::to_string(species_max));
    }
    to.assign(from.begin(), from.end());
    return std::nullopt;
}

struct PlainColumn {
    const char* field;
    const Floats& from;
    Column Entities::*to;
};

/// Quantises the columns of one kind and checks each. Returns the first invalid field, if any.
///
/// ids  the ids of the entities; nullptr: this kind has no ids.
std::optional<Damage> read_plain(const std::string& kind, std::uint32_t count, const Integers* ids,
                                 std::initializer_list<PlainColumn> columns, Entities& to) {
    const std::string path = "plain." + kind + ".";
    const auto refused = [&](const std::string& field, const std::string& got, const std::string& allowed) {
        return wrong(path + field, got, allowed);
    };
    if (ids != nullptr) {
        if (static_cast<std::uint32_t>(ids->size()) != count) {
            return count_mismatch(path + "id", ids->size(), count);
        }
        if (std::adjacent_find(ids->begin(), ids->end(), std::greater_equal<>{}) != ids->end()) {
            return refused("id", "out of order", "rising");
        }
        to.id.assign(ids->begin(), ids->end());
    }
    for (const PlainColumn& column : columns) {
        const Floats& from = column.from;
        if (static_cast<std::uint32_t>(from.size()) != count) {
            return count_mismatch(path + column.field, from.size(), count);
        }
        const auto bad = std::find_if(from.begin(), from.end(), [](float value) { return !std::isfinite(value); });
        if (bad != from.end()) {
            return refused(column.field, std::to_string(*bad), "a finite number");
        }
        (to.*column.to).resize(count);
        std::transform(from.begin(), from.end(), (to.*column.to).begin(), steps_of);
    }
    return std::nullopt;
}

} // namespace

void describe(const QuantisedSnapshot& snapshot, evod::v1::SnapshotFrame& frame) {
    for (const auto part : snapshot_parts) {
        const Entities& entities = snapshot.*part;
        for (const Column* column :
             {&entities.id, &entities.y, &entities.width, &entities.height, &entities.heading, &entities.species}) {
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
    set_integers(snapshot.organisms.id, *organisms.mutable_id());
    set_values(snapshot.organisms.x, *organisms.mutable_x_px());
    set_values(snapshot.organisms.y, *organisms.mutable_y_px());
    set_values(snapshot.organisms.width, *organisms.mutable_radius_px());
    set_values(snapshot.organisms.height, *organisms.mutable_health());
    for (const std::uint32_t steps : snapshot.organisms.heading) {
        organisms.add_heading(radians_of(steps));
    }
    set_integers(snapshot.organisms.species, *organisms.mutable_species());
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

Result<ReceivedSnapshot> decode_plain(evod::v1::SnapshotFrame frame) {
    if (frame.codec() != evod::v1::CODEC_PLAIN) {
        return wrong("codec", std::to_string(frame.codec()), "a known one");
    }
    if (auto damage = damage_of_fields(frame)) {
        return *std::move(damage);
    }
    const evod::v1::PlainSnapshot& plain = frame.plain();
    auto entities = std::make_shared<QuantisedSnapshot>();
    entities->position_bytes = position_bytes_of(frame.width_px(), frame.height_px());
    const evod::v1::PlainOrganisms& organisms = plain.organisms();
    std::optional<Damage> damage = read_plain("organisms", frame.organism_count(), &organisms.id(),
                                              {{"x_px", organisms.x_px(), &Entities::x},
                                               {"y_px", organisms.y_px(), &Entities::y},
                                               {"radius_px", organisms.radius_px(), &Entities::width},
                                               {"health", organisms.health(), &Entities::height}},
                                              entities->organisms);
    if (!damage && !organisms.heading().empty()) {
        damage = read_headings(organisms.heading(), frame.organism_count(), entities->organisms.heading);
    }
    if (!damage && !organisms.species().empty()) {
        damage = read_species(organisms.species(), frame.organism_count(), entities->organisms.species);
    }
    const auto read_items = [&](const char* kind, std::uint32_t count, const evod::v1::PlainItems& from, Entities& to) {
        if (!damage) {
            damage = read_plain(kind, count, &from.id(),
                                {{"x_px", from.x_px(), &Entities::x}, {"y_px", from.y_px(), &Entities::y}}, to);
        }
    };
    read_items("food", frame.food_count(), plain.food(), entities->food);
    read_items("poison", frame.poison_count(), plain.poison(), entities->poison);
    const auto read_boxes = [&](const char* kind, std::uint32_t count, const evod::v1::PlainBoxes& from, Entities& to) {
        if (!damage) {
            damage = read_plain(kind, count, nullptr,
                                {{"x_px", from.x_px(), &Entities::x},
                                 {"y_px", from.y_px(), &Entities::y},
                                 {"half_width_px", from.half_width_px(), &Entities::width},
                                 {"half_height_px", from.half_height_px(), &Entities::height}},
                                to);
        }
    };
    read_boxes("crates", frame.crate_count(), plain.crates(), entities->crates);
    read_boxes("obstacles", frame.obstacle_count(), plain.obstacles(), entities->obstacles);
    if (damage) {
        return *std::move(damage);
    }
    frame.clear_plain();
    frame.clear_body(); // the body has no meaning with this codec, nor have the tiles
    frame.clear_tiles();
    return ReceivedSnapshot{.about = std::move(frame), .entities = std::move(entities), .tiles = {}};
}

} // namespace evod::codec
