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
Refusal wrong_size() {
    return refusal("its size differs from that of a state of this world");
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
    // The rest is empty unless the island is one of a colony.
    visit(island.life_records.children, std::identity{});
    visit(island.hunts_from, std::identity{});
    for (auto& chromosomes : island.latest_born) {
        visit(chromosomes, std::identity{});
    }
}

// Counts are written as they are in memory.
static_assert(sizeof(IslandCounts) == 40);
static_assert(sizeof(IslandState::colony) == 96);

/// The flags in the first byte of a state.
constexpr std::uint8_t over_flag = 1, placed_flag = 2, given_flag = 4;

/// The numbers of entities that were placed on an island.
struct PlacedCounts {
    std::uint32_t organisms = 0, food = 0, poison = 0;
};

/// What else determines the size of an island's state in a colony.
struct ColonyParts {
    std::array<std::uint32_t, 2> latest_born{}; // numbers of genes
    std::uint32_t ended_predators = 0;          // whether the statistics of the ended generation contain predators
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

/// Calls visit(number) for every number of the statistics, then for those of the predators.
template <class Statistics, class Visit>
void for_each_statistic(Statistics& statistics, const Visit& visit) {
    for_each_number(statistics, [&](const std::string&, auto& number) { visit(number); });
    for (auto& gene : statistics.genes) {
        visit(gene.mean);
        visit(gene.deviation);
        visit(gene.min);
        visit(gene.max);
    }
    if (statistics.colony) {
        for_each_colony_number(*statistics.colony, [&](const std::string&, auto& number) { visit(number); });
    }
    for (auto& predators : statistics.predators) {
        for_each_statistic(predators, visit);
    }
}

/// Statistics with the parts that those of an island of this shape have.
GenerationStatistics empty_statistics(const IslandShape& shape, bool with_predators) {
    GenerationStatistics statistics{.genes = std::vector<GeneStatistics>(shape.genes)};
    if (shape.is_colony) {
        statistics.colony.emplace();
    }
    if (with_predators) {
        statistics.predators = {empty_statistics(shape, false)};
    }
    return statistics;
}

std::size_t bytes_of_statistics(const IslandShape& shape, bool with_predators) {
    std::size_t bytes = 0;
    const GenerationStatistics statistics = empty_statistics(shape, with_predators);
    for_each_statistic(statistics, [&](const auto&) { bytes += 8; });
    return bytes;
}

/// The size in bytes of the numbers of placed entities, and of the genes, ticks and parents of placed organisms.
std::size_t bytes_of(std::span<const PlacedCounts> placed, std::span<const IslandShape> shapes) {
    std::size_t bytes = 0;
    for (std::size_t i = 0; i < placed.size(); ++i) {
        const std::size_t of_organism = shapes[i].genes * sizeof(float) + sizeof(std::uint32_t) +
                                        (shapes[i].is_colony ? sizeof(evolution::Parents) : 0);
        bytes += sizeof placed[i] + placed[i].organisms * of_organism;
    }
    return bytes;
}

/// The size of the uncompressed state in bytes, including its first byte, without bytes_of(placed).
///
/// colony  one per island in a colony; otherwise empty.
std::size_t bytes_of(std::span<const IslandShape> shapes, std::span<const ColonyParts> colony, bool over) {
    std::size_t bytes = 1 + colony.size_bytes();
    for (const ColonyParts& parts : colony) {
        bytes +=
            sizeof(IslandState::colony) + (std::size_t{parts.latest_born[0]} + parts.latest_born[1]) * sizeof(float);
    }
    for (std::size_t i = 0; i < shapes.size(); ++i) {
        const IslandShape& shape = shapes[i];
        bytes += sizeof(IslandCounts) + shape.organisms * std::size_t{shape.is_colony ? 21u : 13u};
        if (shape.has_bodies) {
            bytes += shape.organisms * std::size_t{shape.has_headings ? 24u : 20u} + shape.crates * std::size_t{16} +
                     (std::size_t{shape.food} + shape.poison) * 12;
        }
        bytes += over ? bytes_of_statistics(shape, !colony.empty() && colony[i].ended_predators > 0) : 0;
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
    island.life_records.children.assign(shape.is_colony ? shape.organisms : 0, 0);
    island.hunts_from.assign(shape.is_colony ? shape.organisms : 0, 0);
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
    std::vector<ColonyParts> colony; // empty unless the world is a colony

    std::size_t bytes() const { return bytes_of(shapes, colony, over) + bytes_of(placed, shapes) + bytes_of(ratings); }
};

Layout layout_of(const WorldState& state) {
    Layout layout;
    layout.over = !state.ended.empty();
    const std::uint32_t gene_count = gene_count_of(state);
    const bool colony = is_colony(state.parameters.active);
    for (std::size_t i = 0; i < state.islands.size(); ++i) {
        const IslandState& island = state.islands[i];
        if (colony) {
            const auto genes = [&](std::size_t species) {
                return static_cast<std::uint32_t>(island.latest_born[species].size());
            };
            const bool has_predators = layout.over && !state.ended[i].predators.empty();
            layout.colony.push_back({{genes(0), genes(1)}, has_predators});
        }
        layout.shapes.push_back({.genes = gene_count,
                                 .organisms = static_cast<std::uint32_t>(island.life_records.cause.size()),
                                 .has_bodies = colony || !island.organisms.empty(), // it may have no organisms
                                 .has_headings = !island.headings.empty(),
                                 .is_colony = colony,
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
    bytes.add(std::span{layout.colony});
    bytes.add(std::span{layout.placed});
    for (const IslandState& island : state.islands) {
        for (const IslandState::Placed& organism : island.placed) {
            bytes.add(std::span{organism.genes});
            bytes.add(organism.tick);
            if (!layout.colony.empty()) {
                bytes.add(organism.parents);
            }
        }
    }
    bytes.add(std::span{layout.ratings});
    for (const Rating& rating : state.ratings) {
        write_column(rating.fitness, std::identity{});
        write_column(rating.genes, std::identity{});
    }
    for (const IslandState& island : state.islands) {
        bytes.add(island.counts);
        if (!layout.colony.empty()) {
            bytes.add(island.colony);
        }
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

namespace {

/// The most organisms that can come to an island within a generation.
std::uint32_t arrivals_max(const IslandShape& shape) {
    return placed_max + (shape.is_colony ? born_max : 0);
}

bool are_of_colony(std::span<const IslandShape> shapes) {
    return !shapes.empty() && shapes.front().is_colony;
}

} // namespace

Result<void> check_state_size(std::size_t bytes, std::span<const IslandShape> shapes) {
    std::vector<PlacedCounts> most_placed;
    std::vector<RatingCounts> most_given;
    std::vector<ColonyParts> least_colony, most_colony;
    for (const IslandShape& shape : shapes) {
        most_placed.push_back({arrivals_max(shape), placed_max, placed_max});
        const std::uint32_t organisms = shape.organisms + placed_max;
        most_given.push_back({organisms * objectives_max, organisms * shape.genes});
        if (shape.is_colony) {
            least_colony.emplace_back();
            most_colony.push_back({{latest_genes_max, latest_genes_max}, 1});
        }
    }
    if (bytes < bytes_of(shapes, least_colony, false) ||
        bytes > bytes_of(with_placed(shapes, most_placed), most_colony, true) + bytes_of(most_placed, shapes) +
                    bytes_of(most_given)) {
        return wrong_size();
    }
    return {};
}

namespace {

/// Reads the numbers that determine the sizes of all other parts. Refused unless these are the sizes of the bytes.
Result<Layout> read_layout(std::string_view bytes, std::span<const IslandShape> shapes) {
    if (bytes.empty() || static_cast<std::uint8_t>(bytes.front()) > (over_flag | placed_flag | given_flag)) {
        return refusal("its first byte is not 0 to 7");
    }
    const auto flags = static_cast<std::uint8_t>(bytes.front());
    Layout layout;
    layout.over = (flags & over_flag) != 0;
    layout.placed.resize((flags & placed_flag) != 0 ? shapes.size() : 0);
    layout.ratings.resize((flags & given_flag) != 0 ? shapes.size() : 0);
    layout.colony.resize(are_of_colony(shapes) ? shapes.size() : 0);
    const std::size_t colony_bytes = std::span{layout.colony}.size_bytes();
    if (bytes.size() < 1 + colony_bytes + std::span{layout.placed}.size_bytes()) {
        return wrong_size();
    }
    base::Unpacker counts{bytes.substr(1)};
    counts.read(std::span{layout.colony});
    for (const ColonyParts& parts : layout.colony) {
        if (std::ranges::max(parts.latest_born) > latest_genes_max || parts.ended_predators > layout.over) {
            return refusal("it has more genes of latest births, or other statistics, than a world can have");
        }
    }
    for (std::size_t i = 0; i < layout.placed.size(); ++i) {
        PlacedCounts& placed = layout.placed[i];
        counts.read(placed);
        if (placed.organisms > arrivals_max(shapes[i]) || placed.food > placed_max || placed.poison > placed_max) {
            return refusal("it has more placed items or organisms than a world can have");
        }
    }
    layout.shapes = with_placed(shapes, layout.placed);
    const std::size_t before_ratings = 1 + colony_bytes + bytes_of(layout.placed, shapes);
    if (bytes.size() < before_ratings + std::span{layout.ratings}.size_bytes()) {
        return wrong_size();
    }
    counts = base::Unpacker{bytes.substr(before_ratings)};
    for (std::size_t i = 0; i < layout.ratings.size(); ++i) {
        RatingCounts& rating = layout.ratings[i];
        counts.read(rating);
        const std::size_t organisms = layout.shapes[i].organisms;
        if (rating.fitness > organisms * objectives_max || rating.genes > organisms * layout.shapes[i].genes) {
            return refusal("it has fitness for more organisms than its world has");
        }
    }
    if (bytes.size() != layout.bytes()) {
        return wrong_size();
    }
    return layout;
}

} // namespace

Result<void> read_state(std::string_view bytes, std::span<const IslandShape> shapes, WorldState& state) {
    const Result<Layout> layout = read_layout(bytes, shapes);
    if (!layout) {
        return layout.error();
    }
    base::Unpacker columns{
        bytes.substr(1 + std::span{layout->colony}.size_bytes() + std::span{layout->placed}.size_bytes())};
    state.islands.assign(shapes.size(), {});
    state.ratings.assign(layout->ratings.size(), {});
    state.ended.clear();
    for (std::size_t i = 0; i < layout->placed.size(); ++i) {
        const PlacedCounts& placed = layout->placed[i];
        state.islands[i].placed_food = placed.food;
        state.islands[i].placed_poison = placed.poison;
        state.islands[i].placed.resize(placed.organisms);
        for (IslandState::Placed& organism : state.islands[i].placed) {
            organism.genes.resize(shapes[i].genes);
            columns.read(std::span{organism.genes});
            columns.read(organism.tick);
            if (shapes[i].is_colony) {
                columns.read(organism.parents);
            }
        }
    }
    std::vector<RatingCounts> ratings(layout->ratings.size());
    columns.read(std::span{ratings});
    for (std::size_t i = 0; i < ratings.size(); ++i) {
        state.ratings[i].fitness.resize(ratings[i].fitness);
        columns.read(std::span{state.ratings[i].fitness});
        state.ratings[i].genes.resize(ratings[i].genes);
        columns.read(std::span{state.ratings[i].genes});
    }
    for (std::size_t i = 0; i < shapes.size(); ++i) {
        IslandState& island = state.islands[i];
        resize(island, layout->shapes[i]);
        columns.read(island.counts);
        if (shapes[i].is_colony) {
            columns.read(island.colony);
            for (std::size_t species = 0; species < island.latest_born.size(); ++species) {
                island.latest_born[species].resize(layout->colony[i].latest_born[species]);
            }
        }
        for_each_column(island, [&](auto& range, auto&& part) {
            for (auto& element : range) {
                columns.read(std::invoke(part, element));
            }
        });
    }
    for (std::size_t i = 0; layout->over && i < shapes.size(); ++i) {
        const bool has_predators = shapes[i].is_colony && layout->colony[i].ended_predators > 0;
        for_each_statistic(state.ended.emplace_back(empty_statistics(shapes[i], has_predators)),
                           [&]<class T>(T& number) {
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

namespace {

/// The first numbers of an opening's bytes. They determine the sizes of the other parts.
struct OpeningHead {
    std::uint32_t predator_count, next_number, organisms, has_headings, crates, food, poison;

    IslandShape shape() const {
        return {.genes = 0, // nothing has been placed
                .organisms = organisms,
                .has_headings = has_headings != 0,
                .is_colony = true,
                .crates = crates,
                .food = food,
                .poison = poison};
    }
};

} // namespace

std::string bytes_of_opening(const IslandOpening& opening) {
    const IslandState& island = opening.state;
    EVOD_ASSERT(island.placed.empty() && island.placed_food == 0 && island.placed_poison == 0);
    base::Packer bytes;
    bytes.add(OpeningHead{.predator_count = opening.predator_count,
                          .next_number = opening.next_number,
                          .organisms = static_cast<std::uint32_t>(island.life_records.cause.size()),
                          .has_headings = !island.headings.empty(),
                          .crates = static_cast<std::uint32_t>(island.crates.size()),
                          .food = static_cast<std::uint32_t>(island.food.size()),
                          .poison = static_cast<std::uint32_t>(island.poison.size())});
    bytes.add(std::span{opening.numbers});
    bytes.add(std::span{opening.age_ticks});
    std::string all = bytes.take();
    WorldState state;
    state.parameters.active.reproduction = parameters::Reproduction::Births; // has the parts of colonies
    state.islands = {island};
    write_state(state, [&](std::string_view piece) { all += piece; });
    return all;
}

Result<IslandOpening> read_opening(std::string_view bytes) {
    OpeningHead head{};
    if (bytes.size() < sizeof head) {
        return wrong_size();
    }
    base::Unpacker numbers{bytes};
    numbers.read(head);
    constexpr std::size_t of_organism = 2 * sizeof(std::uint32_t);
    if (head.predator_count > head.organisms || (bytes.size() - sizeof head) / of_organism < head.organisms) {
        return wrong_size();
    }
    IslandOpening opening{.predator_count = head.predator_count,
                          .next_number = head.next_number,
                          .numbers = std::vector<std::uint32_t>(head.organisms),
                          .age_ticks = std::vector<std::uint32_t>(head.organisms),
                          .state = {}};
    numbers.read(std::span{opening.numbers});
    numbers.read(std::span{opening.age_ticks});
    WorldState state;
    const IslandShape shape = head.shape();
    const std::string_view rest = bytes.substr(sizeof head + head.organisms * of_organism);
    if (auto read = read_state(rest, {&shape, 1}, state); !read) {
        return read.error();
    }
    opening.state = std::move(state.islands.front());
    if (!state.ended.empty() || !state.ratings.empty() || !opening.state.placed.empty() ||
        opening.state.placed_food > 0 || opening.state.placed_poison > 0) {
        return refusal("it is not the beginning of an interval");
    }
    return opening;
}

} // namespace evod::simulation
