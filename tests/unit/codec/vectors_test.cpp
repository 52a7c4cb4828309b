// The test vectors of docs/PROTOCOL.md: every frame of proto/vectors decodes exactly to the content of its line.

#include "proto/codec/compression.h"
#include "proto/codec/framing.h"
#include "proto/codec/snapshot_decoder.h"

#include <boost/json/array.hpp>
#include <boost/json/object.hpp>
#include <boost/json/parse.hpp>
#include <boost/json/serialize.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <initializer_list>
#include <iterator>
#include <map>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace evod::codec {
namespace {

namespace json = boost::json;

constexpr std::array<std::string_view, 5> kinds{"organisms", "food", "poison", "crates", "obstacles"};

struct Vector {
    std::string name; // for messages
    std::string case_name;
    std::string frame; // header and body
    evod::v1::SnapshotFrame snapshot;
    std::uint64_t frame_bytes, frame_crc32;
    std::string codec;
    json::object decoded;
};

std::string content_of(const char* file) {
    std::ifstream in{EVOD_SOURCE_FOLDER + std::string{"/proto/vectors/"} + file, std::ios::binary};
    EXPECT_TRUE(in) << file;
    return {std::istreambuf_iterator<char>{in}, {}};
}

/// All vectors, in the order of the files.
std::vector<Vector> read_vectors() {
    std::vector<Vector> vectors;
    const std::string frames = content_of("snapshots.frames");
    FrameReader reader{client_limits};
    reader.feed(std::as_bytes(std::span{frames}));
    std::size_t begin = 0;
    const std::string lines = content_of("snapshots.jsonl");
    std::vector<json::object> decoded; // by line
    for (std::size_t at = 0; at < lines.size();) {
        const std::size_t end = lines.find('\n', at);
        json::object line = json::parse(std::string_view{lines}.substr(at, end - at)).as_object();
        at = end + 1;
        const auto take = [&line](std::string_view field) {
            json::value value = line.at(field);
            line.erase(field);
            return value;
        };
        Vector& vector = vectors.emplace_back();
        vector.case_name = take("case").as_string();
        vector.name = vector.case_name + ", line " + std::to_string(vectors.size());
        vector.codec = take("codec").as_string();
        vector.frame_bytes = take("frame_bytes").to_number<std::uint64_t>();
        vector.frame_crc32 = take("frame_crc32").to_number<std::uint64_t>();
        if (line.contains("same_as_line")) {
            const auto same = take("same_as_line").to_number<std::size_t>();
            EXPECT_TRUE(line.empty()) << vector.name;
            line = decoded.at(same - 1);
        }
        decoded.push_back(line);
        vector.decoded = std::move(line);
        const auto frame = reader.next();
        if (!frame || !*frame || (*frame)->channel != Channel::Stream) {
            ADD_FAILURE() << vector.name << ": no such frame";
            break;
        }
        auto snapshot = parse_body<evod::v1::SnapshotFrame>((*frame)->body);
        EXPECT_TRUE(snapshot) << vector.name;
        vector.snapshot = *std::move(snapshot);
        const std::size_t bytes = header_bytes + (*frame)->body.size();
        vector.frame = frames.substr(begin, bytes);
        begin += bytes;
    }
    EXPECT_EQ(begin, frames.size()) << "there are more frames than lines";
    return vectors;
}

const std::vector<Vector>& vectors() {
    static const std::vector<Vector> all = read_vectors();
    return all;
}

// ---- decoded snapshots as JSON ----------------------------------------------------------------------------------

json::array numbers(const Column& column) {
    return json::array(column.begin(), column.end());
}

/// Distances from `from` in whole units.
json::array whole(const std::vector<float>& column, float unit, float from = 0) {
    json::array whole;
    for (const float value : column) {
        const float count = (value - from) / unit;
        EXPECT_EQ(count, std::floor(count));
        whole.push_back(static_cast<std::uint64_t>(count));
    }
    return whole;
}

/// Omits a kind without entities.
void add(json::object& to, std::string_view kind,
         std::initializer_list<std::pair<std::string_view, json::array>> columns) {
    if (columns.begin()->second.empty()) {
        return;
    }
    json::object& of_kind = to[kind].emplace_object();
    for (const auto& [name, column] : columns) {
        of_kind[name] = column;
    }
}

void add_boxes(json::object& to, std::string_view kind, const Entities& boxes, bool with_ids) {
    add(to, kind,
        {{"x", numbers(boxes.x)},
         {"y", numbers(boxes.y)},
         {"half_width", numbers(boxes.width)},
         {"half_height", numbers(boxes.height)}});
    if (with_ids && to.contains(kind)) {
        to[kind].as_object()["id"] = numbers(boxes.id);
    }
}

json::object entities_of(const QuantisedSnapshot& snapshot, bool with_ids) {
    json::object entities;
    add(entities, "organisms",
        {{"id", numbers(snapshot.organisms.id)},
         {"x", numbers(snapshot.organisms.x)},
         {"y", numbers(snapshot.organisms.y)},
         {"radius", numbers(snapshot.organisms.width)},
         {"health", numbers(snapshot.organisms.height)}});
    add(entities, "food",
        {{"id", numbers(snapshot.food.id)}, {"x", numbers(snapshot.food.x)}, {"y", numbers(snapshot.food.y)}});
    add(entities, "poison",
        {{"id", numbers(snapshot.poison.id)}, {"x", numbers(snapshot.poison.x)}, {"y", numbers(snapshot.poison.y)}});
    add_boxes(entities, "crates", snapshot.crates, with_ids);
    add_boxes(entities, "obstacles", snapshot.obstacles, with_ids);
    return entities;
}

json::object fields_of(const evod::v1::SnapshotFrame& about) {
    std::string run_id;
    for (const char byte : about.run_id()) {
        constexpr std::string_view digits = "0123456789abcdef";
        run_id += digits[static_cast<unsigned char>(byte) >> 4];
        run_id += digits[static_cast<unsigned char>(byte) & 15];
    }
    return {{"world", about.world()},
            {"run_id", run_id},
            {"island", about.island()},
            {"island_count", about.island_count()},
            {"tick", about.tick()},
            {"generation", about.generation()},
            {"generation_tick", about.generation_tick()},
            {"width_px", about.width_px()},
            {"height_px", about.height_px()},
            {"item_radius_px", about.item_radius_px()}};
}

/// A tile at DETAIL_FULL without its entities: the decoder returns those of all tiles together.
json::object json_of_tile(const DecodedTile& tile, std::uint32_t tile_px) {
    json::object result{{"tile", tile.tile}, {"detail", evod::v1::Detail_Name(tile.detail)}};
    const float unit = static_cast<float>(tile_px) / 256;
    const auto places = [&](const DecodedDots::Places& of) { // the decoder returns the middle of each
        return std::pair{whole(of.x_px, unit, static_cast<float>(tile.left_px) + unit / 2),
                         whole(of.y_px, unit, static_cast<float>(tile.top_px) + unit / 2)};
    };
    if (tile.detail == evod::v1::DETAIL_DOTS) {
        const std::array of_kinds{&tile.dots.organisms, &tile.dots.food, &tile.dots.poison, &tile.dots.crates,
                                  &tile.dots.obstacles};
        for (std::size_t k = 0; k < kinds.size(); ++k) {
            const auto place = places(*of_kinds[k]);
            add(result, kinds[k], {{"x", place.first}, {"y", place.second}});
        }
    } else if (tile.detail == evod::v1::DETAIL_DENSITY) {
        result["cells"] = tile.density.cells_per_side;
        const std::array of_kinds{&tile.density.organisms, &tile.density.food, &tile.density.poison};
        for (std::size_t k = 0; k < of_kinds.size(); ++k) {
            json::array& rows = result[kinds[k]].emplace_array();
            const auto side = static_cast<std::ptrdiff_t>(tile.density.cells_per_side);
            for (auto row = of_kinds[k]->begin(); row != of_kinds[k]->end(); row += side) {
                rows.emplace_back(json::array(row, row + side));
            }
        }
    }
    return result;
}

// ---- lines as decoded snapshots ---------------------------------------------------------------------------------

/// Removes the entities from tiles of DETAIL_FULL and returns all of them, ids rising.
json::object merged_entities(json::array& tiles) {
    std::map<std::string, std::map<std::uint64_t, std::map<std::string, json::value>>> rows; // by kind and id
    for (json::value& value : tiles) {
        json::object& tile = value.as_object();
        if (tile.at("detail") != "DETAIL_FULL") {
            continue;
        }
        for (const std::string_view kind : kinds) {
            if (!tile.contains(kind)) {
                continue;
            }
            const json::object& columns = tile.at(kind).as_object();
            const json::array& ids = columns.at("id").as_array();
            for (const auto& column : columns) {
                EXPECT_EQ(column.value().as_array().size(), ids.size());
                for (std::size_t i = 0; i < ids.size(); ++i) {
                    rows[std::string{kind}][ids[i].to_number<std::uint64_t>()][column.key()] = column.value().at(i);
                }
            }
            tile.erase(kind);
        }
    }
    json::object together;
    for (const auto& of_kind : rows) {
        json::object& columns = together[of_kind.first].emplace_object();
        for (const auto& row : of_kind.second) {
            for (const auto& field : row.second) {
                json::value& column = columns[field.first];
                if (column.is_null()) {
                    column.emplace_array();
                }
                column.as_array().push_back(field.second);
            }
        }
    }
    return together;
}

// ---- tests ------------------------------------------------------------------------------------------------------

TEST(Vectors, FramesMatchTheirLinesByteForByte) {
    ASSERT_FALSE(vectors().empty());
    for (const Vector& vector : vectors()) {
        EXPECT_EQ(vector.frame.size(), vector.frame_bytes) << vector.name;
        EXPECT_EQ(crc32(vector.frame), vector.frame_crc32) << vector.name;
        EXPECT_EQ(evod::v1::Codec_Name(vector.snapshot.codec()), vector.codec) << vector.name;
    }
}

TEST(Vectors, DecodeToTheirLines) {
    std::map<std::pair<std::string, std::uint32_t>, SnapshotDecoder> decoders; // by case and island
    for (const Vector& vector : vectors()) {
        SCOPED_TRACE(vector.name);
        const auto snapshot = decoders[{vector.case_name, vector.snapshot.island()}].decode(vector.snapshot);
        json::object expected = vector.decoded;
        if (expected.contains("refused")) {
            EXPECT_EQ(expected, (json::object{{"refused", true}}));
            EXPECT_FALSE(snapshot);
            continue;
        }
        ASSERT_TRUE(snapshot) << snapshot.error().what;
        json::object shown = fields_of(snapshot->about);
        const bool in_tiles = expected.contains("tiles");
        for (auto& part : entities_of(*snapshot->entities, in_tiles)) {
            shown[part.key()] = part.value();
        }
        if (in_tiles) {
            shown["tile_px"] = snapshot->about.tile_px();
            json::array& tiles = shown["tiles"].emplace_array();
            for (const DecodedTile& tile : snapshot->tiles) {
                tiles.emplace_back(json_of_tile(tile, snapshot->about.tile_px()));
            }
            for (auto& part : merged_entities(expected.at("tiles").as_array())) {
                expected[part.key()] = part.value();
            }
        }
        EXPECT_EQ(shown, expected) << json::serialize(shown) << "\n" << json::serialize(expected);
    }
}

/// Expects every value of an enumeration except UNSPECIFIED.
void expect_all(const google::protobuf::EnumDescriptor& of, const std::set<int>& seen) {
    for (int i = 0; i < of.value_count(); ++i) {
        EXPECT_TRUE(of.value(i)->number() == 0 || seen.contains(of.value(i)->number()))
            << "no vector has " << of.value(i)->name() << ": tests/system/record_vectors.py makes them";
    }
}

TEST(Vectors, CoverEveryCodecAndDetail) {
    std::set<int> codecs, details;
    for (const Vector& vector : vectors()) {
        if (vector.decoded.contains("refused")) {
            continue;
        }
        codecs.insert(vector.snapshot.codec());
        for (const auto& tile : vector.snapshot.tiles()) {
            details.insert(tile.detail());
        }
    }
    expect_all(*evod::v1::Codec_descriptor(), codecs);
    expect_all(*evod::v1::Detail_descriptor(), details);
}

} // namespace
} // namespace evod::codec
