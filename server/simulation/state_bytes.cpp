#include "server/simulation/state_bytes.h"

#include "server/base/assert.h"
#include "server/base/packing.h"
#include "server/simulation/commands.h"

#include <algorithm>
#include <array>
#include <bit>
#include <string>
#include <vector>

namespace evod::simulation {
namespace {

using base::Refusal;
using base::Result;

static_assert(std::endian::native == std::endian::little, "columns are written as they are in memory");

Refusal refusal(const char* message) {
    return {.code = base::RefusalCode::DataLoss, .message = message, .violations = {}};
}

/// Calls visit(range, member) for every column, in order. `range` contains the elements; `member` is a member of
/// theirs.
template <class Island, class Visit>
void for_each_column(Island& island, Visit&& visit) {
    visit(island.life_records.lived_ticks, std::identity{});
    visit(island.life_records.cause, std::identity{});
    visit(island.life_records.food_eaten, std::identity{});
    visit(island.life_records.poison_eaten, std::identity{});
    const auto visit_bodies = [&](auto& bodies) {
        using Body = std::remove_cvref_t<decltype(bodies.front())>;
        visit(bodies, &Body::x);
        visit(bodies, &Body::y);
        visit(bodies, &Body::velocity_x);
        visit(bodies, &Body::velocity_y);
    };
    visit_bodies(island.organisms);
    visit(island.organisms, &IslandState::Organism::health);
    visit(island.headings, std::identity{});
    visit_bodies(island.crates);
    for (auto* items : {&island.food, &island.poison}) {
        visit(*items, &Items::Item::x);
        visit(*items, &Items::Item::y);
        visit(*items, &Items::Item::due_tick);
    }
}

// Counts are written as they are in memory.
static_assert(sizeof(IslandCounts) == 40);

/// The flags in the first byte of a state.
constexpr std::uint8_t over_flag = 1, placed_flag = 2, given_flag = 4;

/// The numbers of entities that were placed on an island.
struct PlacedCounts {
    std::uint32_t organisms = 0, food = 0, poison = 0;
};

bool has_placed(const PlacedCounts& counts) {
    return counts.organisms > 0 || counts.food > 0 || counts.poison > 0;
}

/// Returns the shapes of islands on which entities were placed.
std::vector<IslandShape> with_placed(std::span<const IslandShape> shapes, std::span<const PlacedCounts> placed) {
    std::vector<IslandShape> whole{shapes.begin(), shapes.end()};
    for (std::size_t i = 0; i < placed.size(); ++i) {
        whole[i].organisms += placed[i].organisms;
        whole[i].food += placed[i].food;
        whole[i].poison += placed[i].poison;
    }
    return whole;
}

/// Calls visit(number) for every number of the statistics.
template <class Statistics, class Visit>
void for_each_statistic(Statistics& statistics, const Visit& visit) {
    for_each_number(statistics, [&](const std::string&, auto& number) { visit(number); });
    for (auto& gene : statistics.genes) {
        visit(gene.mean);
        visit(gene.deviation);
        visit(gene.min);
        visit(gene.max);
    }
}

std::size_t bytes_of_statistics(std::size_t gene_count) {
    std::size_t bytes = 0;
    const GenerationStatistics statistics{.genes = std::vector<GeneStatistics>(gene_count)};
    for_each_statistic(statistics, [&](const auto&) { bytes += 8; });
    return bytes;
}

/// The size in bytes of the numbers of placed entities, and of the genes and ticks of placed organisms.
std::size_t bytes_of(std::span<const PlacedCounts> placed, std::span<const IslandShape> shapes) {
    std::size_t bytes = 0;
    for (std::size_t i = 0; i < placed.size(); ++i) {
        bytes += sizeof placed[i] + placed[i].organisms * (shapes[i].genes * sizeof(float) + sizeof(std::uint32_t));
    }
    return bytes;
}

/// The size of the uncompressed state in bytes, including its first byte, without bytes_of(placed).
std::size_t bytes_of(std::span<const IslandShape> shapes, bool over) {
    std::size_t bytes = 1;
    for (const IslandShape& shape : shapes) {
        bytes += sizeof(IslandCounts) + shape.organisms * std::size_t{13};
        if (shape.has_bodies) {
            bytes += shape.organisms * std::size_t{shape.has_headings ? 24u : 20u} + shape.crates * std::size_t{16} +
                     (std::size_t{shape.food} + shape.poison) * 12;
        }
        bytes += over ? bytes_of_statistics(shape.genes) : 0;
    }
    return bytes;
}

/// The sizes of the Rating of an island.
struct RatingCounts {
    std::uint32_t fitness = 0, genes = 0;
};

/// The size in bytes of the ratings, and of their counts.
std::size_t bytes_of(std::span<const RatingCounts> ratings) {
    std::size_t bytes = ratings.size_bytes();
    for (const RatingCounts& counts : ratings) {
        bytes += counts.fitness * sizeof(double) + counts.genes * sizeof(float);
    }
    return bytes;
}

void resize(IslandState& island, const IslandShape& shape) {
    island.life_records.begin_generation(shape.organisms);
    if (!shape.has_bodies) {
        return;
    }
    island.organisms.resize(shape.organisms);
    island.headings.resize(shape.has_headings ? shape.organisms : 0);
    island.crates.resize(shape.crates);
    island.food.resize(shape.food);
    island.poison.resize(shape.poison);
}

/// The number of genes of each organism, if the state contains genes or their statistics.
std::uint32_t gene_count_of(const WorldState& state) {
    if (!state.ended.empty()) {
        return static_cast<std::uint32_t>(state.ended.front().genes.size());
    }
    for (const IslandState& island : state.islands) {
        if (!island.placed.empty()) {
            return static_cast<std::uint32_t>(island.placed.front().genes.size());
        }
    }
    return 0;
}

/// What determines the sizes of the parts of a state.
struct Layout {
    bool over = false;
    std::vector<IslandShape> shapes;  // with the placed entities
    std::vector<PlacedCounts> placed; // empty if nothing was placed
    std::vector<RatingCounts> ratings;

    std::size_t bytes() const { return bytes_of(shapes, over) + bytes_of(placed, shapes) + bytes_of(ratings); }
};

Layout layout_of(const WorldState& state) {
    Layout layout;
    layout.over = !state.ended.empty();
    const std::uint32_t gene_count = gene_count_of(state);
    for (const IslandState& island : state.islands) {
        layout.shapes.push_back({.genes = gene_count,
                                 .organisms = static_cast<std::uint32_t>(island.life_records.cause.size()),
                                 .has_bodies = !island.organisms.empty(),
                                 .has_headings = !island.headings.empty(),
                                 .crates = static_cast<std::uint32_t>(island.crates.size()),
                                 .food = static_cast<std::uint32_t>(island.food.size()),
                                 .poison = static_cast<std::uint32_t>(island.poison.size())});
        layout.placed.push_back({.organisms = static_cast<std::uint32_t>(island.placed.size()),
                                 .food = island.placed_food,
                                 .poison = island.placed_poison});
    }
    if (std::ranges::none_of(layout.placed, has_placed)) {
        layout.placed.clear();
    }
    for (const Rating& rating : state.ratings) {
        layout.ratings.push_back({.fitness = static_cast<std::uint32_t>(rating.fitness.size()),
                                  .genes = static_cast<std::uint32_t>(rating.genes.size())});
    }
    return layout;
}

} // namespace

std::size_t bytes_of_state(const WorldState& state) {
    return layout_of(state).bytes();
}

void write_state(const WorldState& state, const std::function<void(std::string_view)>& write) {
    const Layout layout = layout_of(state);
    base::Packer bytes;
    const auto write_column = [&](const auto& range, auto&& part) {
        using T = std::remove_cvref_t<decltype(std::invoke(part, range.front()))>;
        std::array<T, 4096> values;
        for (std::size_t begin = 0; begin < range.size(); begin += values.size()) {
            const std::size_t count = std::min(values.size(), range.size() - begin);
            for (std::size_t i = 0; i < count; ++i) {
                values[i] = std::invoke(part, range[begin + i]);
            }
            bytes.add(std::span<const T>{values}.first(count));
            write(bytes.take());
        }
    };
    bytes.add(static_cast<std::uint8_t>((layout.over ? over_flag : 0) | (layout.placed.empty() ? 0 : placed_flag) |
                                        (layout.ratings.empty() ? 0 : given_flag)));
    bytes.add(std::span{layout.placed});
    for (const IslandState& island : state.islands) {
        for (const IslandState::Placed& organism : island.placed) {
            bytes.add(std::span{organism.genes});
            bytes.add(organism.tick);
        }
    }
    bytes.add(std::span{layout.ratings});
    for (const Rating& rating : state.ratings) {
        write_column(rating.fitness, std::identity{});
        write_column(rating.genes, std::identity{});
    }
    for (const IslandState& island : state.islands) {
        bytes.add(island.counts);
        for_each_column(island, write_column);
    }
    for (const GenerationStatistics& statistics : state.ended) {
        for_each_statistic(statistics, [&]<class T>(const T& number) {
            if constexpr (std::is_floating_point_v<T>) {
                bytes.add(double{number});
            } else {
                bytes.add(static_cast<std::uint64_t>(number));
            }
        });
    }
    write(bytes.take());
}

Result<void> check_state_size(std::size_t bytes, std::span<const IslandShape> shapes) {
    const PlacedCounts most{placed_max, placed_max, placed_max};
    const std::vector<PlacedCounts> most_placed(shapes.size(), most);
    std::vector<RatingCounts> most_given;
    for (const IslandShape& shape : with_placed(shapes, most_placed)) {
        most_given.push_back({shape.organisms * objectives_max, shape.organisms * shape.genes});
    }
    if (bytes < bytes_of(shapes, false) || bytes > bytes_of(with_placed(shapes, most_placed), true) +
                                                       bytes_of(most_placed, shapes) + bytes_of(most_given)) {
        return refusal("its size differs from that of a state of this world");
    }
    return {};
}

Result<void> read_state(std::string_view bytes, std::span<const IslandShape> shapes, WorldState& state) {
    if (bytes.empty() || static_cast<std::uint8_t>(bytes.front()) > (over_flag | placed_flag | given_flag)) {
        return refusal("its first byte is not 0 to 7");
    }
    const bool over = (static_cast<std::uint8_t>(bytes.front()) & over_flag) != 0;
    const bool has_counts = (static_cast<std::uint8_t>(bytes.front()) & placed_flag) != 0;
    std::vector<PlacedCounts> placed(has_counts ? shapes.size() : 0);
    base::Unpacker columns{bytes.substr(1)};
    if (bytes.size() < 1 + placed.size() * sizeof(PlacedCounts)) {
        return refusal("its size differs from that of a state of this world");
    }
    for (PlacedCounts& counts : placed) {
        columns.read(counts);
        if (counts.organisms > placed_max || counts.food > placed_max || counts.poison > placed_max) {
            return refusal("it has more placed items or organisms than a world can have");
        }
    }
    const std::vector<IslandShape> whole = with_placed(shapes, placed);
    const bool has_given = (static_cast<std::uint8_t>(bytes.front()) & given_flag) != 0;
    std::vector<RatingCounts> ratings(has_given ? shapes.size() : 0);
    const std::size_t placed_bytes = bytes_of(placed, shapes);
    if (bytes.size() < 1 + placed_bytes + ratings.size() * sizeof(RatingCounts)) {
        return refusal("its size differs from that of a state of this world");
    }
    base::Unpacker counts{bytes.substr(1 + placed_bytes)};
    for (std::size_t i = 0; i < ratings.size(); ++i) {
        counts.read(ratings[i]);
        const std::size_t organisms = whole[i].organisms;
        if (ratings[i].fitness > organisms * objectives_max || ratings[i].genes > organisms * whole[i].genes) {
            return refusal("it has fitness for more organisms than its world has");
        }
    }
    if (bytes.size() != bytes_of(whole, over) + placed_bytes + bytes_of(ratings)) {
        return refusal("its size differs from that of a state of this world");
    }
    state.islands.assign(shapes.size(), {});
    state.ratings.assign(ratings.size(), {});
    state.ended.assign(over ? shapes.size() : 0, {});
    for (std::size_t i = 0; i < placed.size(); ++i) {
        state.islands[i].placed_food = placed[i].food;
        state.islands[i].placed_poison = placed[i].poison;
        state.islands[i].placed.resize(placed[i].organisms);
        for (IslandState::Placed& organism : state.islands[i].placed) {
            organism.genes.resize(shapes[i].genes);
            columns.read(std::span{organism.genes});
            columns.read(organism.tick);
        }
    }
    columns.read(std::span{ratings});
    for (std::size_t i = 0; i < ratings.size(); ++i) {
        state.ratings[i].fitness.resize(ratings[i].fitness);
        columns.read(std::span{state.ratings[i].fitness});
        state.ratings[i].genes.resize(ratings[i].genes);
        columns.read(std::span{state.ratings[i].genes});
    }
    for (std::size_t i = 0; i < shapes.size(); ++i) {
        IslandState& island = state.islands[i];
        resize(island, whole[i]);
        columns.read(island.counts);
        for_each_column(island, [&](auto& range, auto&& part) {
            for (auto& element : range) {
                columns.read(std::invoke(part, element));
            }
        });
    }
    for (std::size_t i = 0; i < state.ended.size(); ++i) {
        state.ended[i].genes.resize(shapes[i].genes);
        for_each_statistic(state.ended[i], [&]<class T>(T& number) {
            if constexpr (std::is_floating_point_v<T>) {
                columns.read(number);
            } else {
                std::uint64_t whole = 0;
                columns.read(whole);
                number = static_cast<T>(whole);
            }
        });
    }
    EVOD_ASSERT(columns.empty());
    return {};
}

} // namespace evod::simulation
