// The test vectors of docs/PROTOCOL.md: every frame of proto/vectors decodes exactly to the content of its line, and
// every mutation of mutations.txt is refused or decodes to the content with the listed checksum.
//
// The verdicts in mutations.txt are those of this decoder. EVOD_RECORD=1 unit_codec --gtest_filter='*Mutations*' writes
// the file again.

#include "proto/codec/compression.h"
#include "proto/codec/delta_codec.h"
#include "proto/codec/framing.h"
#include "proto/codec/little_endian.h"
#include "proto/codec/snapshot_decoder.h"
#include "proto/codec/tiles.h"

#include <boost/json/array.hpp>
#include <boost/json/object.hpp>
#include <boost/json/parse.hpp>
#include <boost/json/serialize.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <initializer_list>
#include <iterator>
#include <map>
#include <random>
#include <set>
#include <span>
#include <sstream>
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
    if (snapshot.organisms.has_headings()) {
        entities["organisms"].as_object()["heading"] = numbers(snapshot.organisms.heading);
    }
    if (snapshot.organisms.has_species()) {
        entities["organisms"].as_object()["species"] = numbers(snapshot.organisms.species);
    }
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

// ---- mutations ---------------------------------------------------------------------------------------------------

/// One line of mutations.txt: a change of one frame, and what the decoder makes of it.
struct Mutation {
    std::size_t line = 0; // of snapshots.jsonl, from 1
    int tile = -1;        // position in SnapshotFrame.tiles; -1: the body of the frame itself
    std::string change;   // "byte", "word", "cut", "add" or "count"
    std::uint32_t where = 0, value = 0;
    std::string verdict; // "damaged", or the checksum of the content in hexadecimal digits

    std::string text() const {
        std::ostringstream out;
        out << line << ' ' << tile << ' ' << change << ' ' << where << ' ' << value << ' ' << verdict << '\n';
        return out.str();
    }
};

template <class Message>
void change_message(const Mutation& mutation, Message& message) {
    std::string& body = *message.mutable_body();
    if (mutation.change == "byte") {
        body.at(mutation.where) = static_cast<char>(mutation.value);
    } else if (mutation.change == "word") {
        for (unsigned i = 0; i < 4; ++i) {
            body.at(mutation.where + i) = static_cast<char>(mutation.value >> (8 * i));
        }
    } else if (mutation.change == "cut") {
        body.resize(mutation.where);
    } else if (mutation.change == "add") {
        body.push_back(static_cast<char>(mutation.value));
    } else {
        ASSERT_EQ(mutation.change, "count");
        Counts counts = counts_of(message);
        counts.at(mutation.where) = mutation.value;
        set_counts(counts, message);
    }
}

/// Returns the frame with the change, and with the checksum of the changed body.
evod::v1::SnapshotFrame mutated(evod::v1::SnapshotFrame frame, const Mutation& mutation) {
    if (mutation.tile < 0) {
        change_message(mutation, frame);
        frame.set_checksum(checksum_of(frame, frame.body()));
    } else {
        evod::v1::SnapshotTile& tile = *frame.mutable_tiles(mutation.tile);
        change_message(mutation, tile);
        tile.set_checksum(checksum_of(frame.tile_px(), frame.position_bytes(), tile, tile.body()));
    }
    return frame;
}

/// Returns the CRC-32 of all numbers as u32: for each kind its count, then the columns id (not of boxes), x, y, radius
/// or half width, health or half height, heading and species, as the kind has them; then the cells of each density.
std::string checksum_of_content(const ReceivedSnapshot& snapshot) {
    std::string bytes;
    const auto append = [&bytes](const auto& column) {
        for (const std::uint32_t value : column) {
            std::array<char, 4> number;
            store(value, number.data());
            bytes.append(number.data(), number.size());
        }
    };
    for (const auto part : snapshot_parts) {
        const Entities& entities = *snapshot.entities.*part;
        append(std::array{static_cast<std::uint32_t>(entities.x.size())});
        if (part != &QuantisedSnapshot::crates && part != &QuantisedSnapshot::obstacles) {
            append(entities.id);
        }
        for (const Column* column :
             {&entities.x, &entities.y, &entities.width, &entities.height, &entities.heading, &entities.species}) {
            append(*column);
        }
    }
    for (const DecodedTile& tile : snapshot.tiles) {
        append(tile.density.organisms);
        append(tile.density.food);
        append(tile.density.poison);
    }
    std::array<char, 9> digits;
    std::snprintf(digits.data(), digits.size(), "%08x", crc32(bytes));
    return digits.data();
}

std::string verdict_of(SnapshotDecoder decoder, const Mutation& mutation, const evod::v1::SnapshotFrame& frame) {
    const auto snapshot = decoder.decode(mutated(frame, mutation));
    EXPECT_EQ(decoder.needs_keyframe(), !snapshot);
    return snapshot ? checksum_of_content(*snapshot) : "damaged";
}

/// Returns whether a line can be mutated: the frame has no compressed body and is decoded.
bool can_be_mutated(const Vector& vector) {
    const auto plain = [](const auto& message) { return message.compression() != evod::v1::COMPRESSION_ZSTD; };
    return vector.codec == "CODEC_DELTA" && !vector.case_name.ends_with("_zstd") &&
           !vector.decoded.contains("refused") && plain(vector.snapshot) &&
           std::ranges::all_of(vector.snapshot.tiles(), plain);
}

/// Calls what(line, decoder) for each line that can be mutated, with a decoder that has decoded the frames before it.
template <class Do>
void each_line(const Do& what) {
    std::map<std::pair<std::string, std::uint32_t>, SnapshotDecoder> decoders;
    for (std::size_t i = 0; i < vectors().size(); ++i) {
        const Vector& vector = vectors()[i];
        SnapshotDecoder& decoder = decoders[{vector.case_name, vector.snapshot.island()}];
        if (can_be_mutated(vector)) {
            what(i + 1, decoder);
        }
        (void)decoder.decode(vector.snapshot);
    }
}

/// Makes random mutations. Most of them concern numbers near the limits of what a body allows.
class MutationSource {
  public:
    Mutation next(std::size_t line) {
        const evod::v1::SnapshotFrame& frame = vectors()[line - 1].snapshot;
        Mutation mutation;
        mutation.line = line;
        if (frame.tiles_size() > 0) {
            mutation.tile = static_cast<int>(below(static_cast<std::uint32_t>(frame.tiles_size())));
        }
        const std::string& body = mutation.tile < 0 ? frame.body() : frame.tiles(mutation.tile).body();
        const auto size = static_cast<std::uint32_t>(body.size());
        const std::uint32_t kind = below(20);
        if (kind == 0) {
            mutation.change = "count";
            mutation.where = below(5);
            const Counts counts = mutation.tile < 0 ? counts_of(frame) : counts_of(frame.tiles(mutation.tile));
            mutation.value = below(4) == 0 ? one_of(words) : counts[mutation.where] + below(3) - 1;
        } else if (kind == 1) {
            mutation.change = "add";
            mutation.value = below(256);
        } else if (kind == 2 && size > 0) {
            mutation.change = "cut";
            mutation.where = below(size);
        } else if (kind < 6 && size >= 4) {
            mutation.change = "word";
            mutation.where = below(size - 3);
            mutation.value = one_of(words);
        } else if (size > 0) {
            mutation.change = "byte";
            mutation.where = below(4) == 0 ? below(std::min(size, 16U)) : below(size);
            const auto now = static_cast<unsigned char>(body[mutation.where]);
            const std::uint32_t how = below(3);
            mutation.value = how == 0 ? below(256) : how == 1 ? now ^ (1U << below(8)) : one_of(bytes);
        } else {
            mutation.change = "add";
        }
        return mutation;
    }

    std::uint32_t below(std::uint32_t end) { return static_cast<std::uint32_t>(random_() % end); }

  private:
    static constexpr std::array<std::uint32_t, 10> words{0,    1,       2,          3,          0x7f,
                                                         0xff, 0x10000, 0x7fffffff, 0x80000000, 0xffffffff};
    static constexpr std::array<std::uint32_t, 16> bytes{0, 1, 2, 3, 4, 5, 6, 7, 8, 16, 127, 128, 129, 130, 132, 255};
    template <std::size_t size>
    std::uint32_t one_of(const std::array<std::uint32_t, size>& of) {
        return of[below(size)];
    }
    std::mt19937 random_{20240229};
};

constexpr std::size_t mutation_count = 1000;

void record_mutations() {
    std::vector<std::size_t> lines;
    each_line([&](std::size_t line, const SnapshotDecoder&) { lines.push_back(line); });
    MutationSource source;
    std::map<std::size_t, std::vector<Mutation>> mutations; // by line
    for (std::size_t i = 0; i < mutation_count; ++i) {
        const std::size_t line = lines[i % lines.size()];
        mutations[line].push_back(source.next(line));
    }
    std::ofstream out{EVOD_SOURCE_FOLDER + std::string{"/proto/vectors/mutations.txt"}, std::ios::binary};
    each_line([&](std::size_t line, const SnapshotDecoder& decoder) {
        for (Mutation& mutation : mutations[line]) {
            mutation.verdict = verdict_of(decoder, mutation, vectors()[line - 1].snapshot);
            out << mutation.text();
        }
    });
}

TEST(Vectors, MutationsHaveTheListedVerdicts) {
    if (std::getenv("EVOD_RECORD") != nullptr) {
        record_mutations();
    }
    std::istringstream in{content_of("mutations.txt")};
    std::map<std::size_t, std::vector<Mutation>> mutations; // by line
    std::size_t count = 0, sound = 0;
    for (Mutation one; in >> one.line >> one.tile >> one.change >> one.where >> one.value >> one.verdict; ++count) {
        sound += one.verdict != "damaged";
        mutations[one.line].push_back(one);
    }
    EXPECT_EQ(count, mutation_count);
    EXPECT_GT(sound, mutation_count / 10);
    EXPECT_LT(sound, mutation_count * 9 / 10);
    each_line([&](std::size_t line, const SnapshotDecoder& decoder) {
        for (const Mutation& mutation : mutations[line]) {
            EXPECT_EQ(verdict_of(decoder, mutation, vectors()[line - 1].snapshot), mutation.verdict) << mutation.text();
        }
        mutations.erase(line);
    });
    EXPECT_TRUE(mutations.empty()) << "a mutation names a line that cannot be mutated";
}

} // namespace
} // namespace evod::codec
